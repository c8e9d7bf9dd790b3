// SPDX-License-Identifier: Apache-2.0
import * as three from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { element } from "../element";
import { keptPicture, makeRenderer } from "./renderer";

const wantedFrameMs = 40, fewestPixels = 0.5;

/**
 * What draws. What stands still is drawn once and kept as a picture with depth; what moves is drawn into it. Where a
 * frame takes long it has fewer pixels: without a graphics card the machine's time belongs to what is asked and heard.
 */
export class Drawing {
  /** The picture, or the words that stand where a browser cannot draw one. */
  readonly canvas: HTMLElement;
  readonly still = new three.Scene();
  readonly moving = new three.Scene();
  readonly camera = new three.PerspectiveCamera(32, 1, 0.05, 10);
  readonly controls: OrbitControls;
  /** The still part has changed, or only what moves has. */
  due = true;
  moved = true;
  private readonly renderer = makeRenderer();
  private readonly kept = new three.WebGLRenderTarget(1, 1, { samples: 4, type: three.HalfFloatType, depthTexture: new three.DepthTexture(1, 1) });
  private drawing: { sync: WebGLSync; began: number; whole: boolean } | undefined;
  private restUntilMs = 0;
  private drawnFrames = 0;
  /** Pixels of the picture for one of the screen, along one side. */
  private ratio = Math.min(devicePixelRatio, 2);
  /** What fills the picture, seen from where; nothing once somebody has turned it. */
  private framed: { box: three.Box3; from: three.Vector3 } | undefined;

  constructor(label: string, noPicture: string) {
    this.canvas = this.renderer?.domElement ?? element("p", { class: "no-picture" }, noPicture);
    this.canvas.tabIndex = 0;
    this.canvas.setAttribute("role", "img");
    this.canvas.setAttribute("aria-label", label);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.addEventListener("change", () => (this.due = true));
    this.controls.addEventListener("start", () => (this.framed = undefined));
    for (const scene of [this.still, this.moving]) {
      const key = new three.DirectionalLight("#fff6ea", 2.1);
      key.position.set(0.7, 1.6, 1.6);
      const rim = new three.DirectionalLight("#cfe0ff", 0.8);
      rim.position.set(-1.6, 0.9, 0.4);
      scene.add(new three.HemisphereLight("#ffffff", "#8d7f78", 0.9), key, rim);
    }
    this.moving.add(keptPicture(this.kept));
    if (this.renderer) this.draw(this.renderer);
  }

  /** Turns to a box, as seen from a direction, which fills the picture until somebody turns it. */
  frame(box: three.Box3, from: three.Vector3): void {
    this.framed = { box: box.clone(), from: from.clone().normalize() };
    this.fill();
  }

  private fill(): void {
    if (!this.framed) return;
    const { box, from } = this.framed, { camera } = this, margin = 1.18;
    const centre = box.getCenter(new three.Vector3()), half = box.getSize(new three.Vector3()).multiplyScalar(0.5);
    // Looking straight down, the head end of the couch is up.
    camera.up.set(0, Math.abs(from.z) > 0.9 ? 1 : 0, Math.abs(from.z) > 0.9 ? 0 : 1);
    camera.position.copy(centre).add(from);
    camera.lookAt(centre);
    const [wide, high, deep] = [0, 1, 2].map((column) => {
      const axis = new three.Vector3().setFromMatrixColumn(camera.matrix.compose(camera.position, camera.quaternion, camera.scale), column);
      return Math.abs(axis.x) * half.x + Math.abs(axis.y) * half.y + Math.abs(axis.z) * half.z;
    }) as [number, number, number];
    const slope = Math.tan((camera.fov * Math.PI) / 360);
    camera.position.copy(centre).addScaledVector(from, deep + (margin * Math.max(high, wide / camera.aspect)) / slope);
    this.controls.target.copy(centre);
    this.controls.update();
    this.due = true;
  }

  /** What is seen at a place of the screen. */
  ray(x: number, y: number): three.Raycaster {
    const box = this.canvas.getBoundingClientRect();
    const ray = new three.Raycaster();
    ray.setFromCamera(new three.Vector2((2 * (x - box.left)) / box.width - 1, 1 - (2 * (y - box.top)) / box.height), this.camera);
    return ray;
  }

  private draw(renderer: three.WebGLRenderer): void {
    requestAnimationFrame(() => this.draw(renderer));
    this.controls.update();
    const began = performance.now(), gl = renderer.getContext() as WebGL2RenderingContext;
    if (!this.settled(gl, began) || began < this.restUntilMs) return;
    if (this.fit(renderer)) this.due = true;
    if (!this.due && !this.moved) return;
    const whole = this.due;
    if (whole) {
      renderer.setRenderTarget(this.kept);
      renderer.render(this.still, this.camera);
      renderer.setRenderTarget(null);
    }
    renderer.render(this.moving, this.camera);
    this.due = this.moved = false;
    // Looked after later: whoever waits here keeps a finger on STOP waiting, too.
    const sync = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    gl.flush();
    this.drawing = sync ? { sync, began, whole } : undefined;
  }

  /** Whether the picture that was asked for last is drawn; how long it took says what the next may cost. */
  private settled(gl: WebGL2RenderingContext, nowMs: number): boolean {
    if (!this.drawing) return true;
    const { sync, began, whole } = this.drawing;
    if (gl.getSyncParameter(sync, gl.SYNC_STATUS) !== gl.SIGNALED) return gl.isContextLost();
    gl.deleteSync(sync);
    this.drawing = undefined;
    this.canvas.dataset["drawn"] = String(++this.drawnFrames);  // for who measures
    const took = nowMs - began;
    this.restUntilMs = began + 2 * took;
    if (!whole && took > 2 * wantedFrameMs) this.ratio = Math.max(fewestPixels, this.ratio / 1.4);
    return true;
  }

  private fit(renderer: three.WebGLRenderer): boolean {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement ?? this.canvas;
    const drawn = renderer.domElement;
    if (width === 0 || (drawn.width === Math.floor(width * this.ratio) && drawn.height === Math.floor(height * this.ratio))) return false;
    renderer.setPixelRatio(this.ratio);
    renderer.setSize(width, height, false);  // the style sheet says how large it is shown
    this.kept.setSize(drawn.width, drawn.height);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.fill();
    return true;
  }
}
