// SPDX-License-Identifier: Apache-2.0
import * as three from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { ArmShape } from "./arm_shape";
import { element } from "./element";
import { keptPicture, makeRenderer } from "./renderer";

export interface Acupoint { name: string; at: [number, number, number]; normal: [number, number, number]; uncertainty_mm: number }
export interface Path { name: string; technique: string; arm: string; step: number; start_s: number; duration_s: number; zone: string; ordered_n: number; places: [number, number, number][] }

export const armColours = ["#d9872b", "#2f7fb8"];  // left, right
export const techniqueColours: Record<string, string> =
  { press: "#c8342c", rub: "#1868b2", stroke: "#10846a", tap: "#8b4fb0", knead: "#b0741a" };
export const zoneColours = ["#7fb59a", "#d8b45a", "#cf9a6a", "#c98b80", "#c98b80", "#c47a8e", "#b06ad0", "#d04a4a", "#777777", "#8a8f98", "#d04a4a"];
const skin = new three.Color("#d9b39b");

function toFloat(place: [number, number, number]): three.Vector3 { return new three.Vector3(...place); }

const ruledOutColour = "#d04a4a";
export type Edit = "turn" | "move" | "rule_out";
const newestPoints = 400;
const wantedFrameMs = 40, fewestPixels = 0.5;

/**
 * The back, what is planned on it, and both arms. What stands still is drawn once and kept as a picture with depth; the
 * arms are drawn into it. Where a frame takes long it has fewer pixels: without a graphics card the machine's time
 * belongs to what is asked and heard.
 */
export class Scene {
  /** The picture, or the words that stand where a browser cannot draw one. */
  readonly canvas: HTMLElement;
  private readonly renderer = makeRenderer();
  private readonly still = new three.Scene();
  private readonly moving = new three.Scene();
  private readonly kept = new three.WebGLRenderTarget(1, 1, { samples: 4, type: three.HalfFloatType, depthTexture: new three.DepthTexture(1, 1) });
  private readonly camera = new three.PerspectiveCamera(32, 1, 0.05, 10);
  private readonly controls: OrbitControls;
  private cloud?: three.Points;
  private framed = new three.Box3();
  private back?: three.Mesh;
  private marks = new three.Group();
  private paths = new three.Group();
  private arms: ArmShape[] = [];
  private felt = new three.Group();
  private ruledOut = new three.Group();
  private points: Acupoint[] = [];
  private how: Edit = "turn";
  private dragged?: Acupoint | undefined;
  private drawn?: [number, number, number][] | undefined;
  onMoved: (name: string, at: [number, number, number]) => void = () => {};
  onRuledOut: (corners: [number, number, number][]) => void = () => {};
  private zones?: Uint8Array;
  private showsZones = false;
  /** The still part has changed, or only the arms have. */
  private due = true;
  private moved = true;
  private drawing: { sync: WebGLSync; began: number; whole: boolean } | undefined;
  private restUntilMs = 0;
  private drawnFrames = 0;
  /** Pixels of the picture for one of the screen, along one side. */
  private ratio = Math.min(devicePixelRatio, 2);

  constructor(label: string, noPicture: string) {
    this.canvas = this.renderer?.domElement ?? element("p", { class: "no-picture" }, noPicture);
    this.canvas.tabIndex = 0;
    this.canvas.setAttribute("role", "img");
    this.canvas.setAttribute("aria-label", label);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.addEventListener("change", () => (this.due = true));
    for (const scene of [this.still, this.moving]) {
      const key = new three.DirectionalLight("#fff6ea", 2.1);
      key.position.set(0.7, 1.6, 1.6);
      const rim = new three.DirectionalLight("#cfe0ff", 0.8);
      rim.position.set(-1.6, 0.9, 0.4);
      scene.add(new three.HemisphereLight("#ffffff", "#8d7f78", 0.9), key, rim);
    }
    this.still.add(this.marks, this.paths, this.felt, this.ruledOut);
    this.arms = armColours.map((colour) => new ArmShape(colour));
    this.moving.add(keptPicture(this.kept), ...this.arms.map((arm) => arm.group));
    this.frame(new three.Box3(new three.Vector3(-0.25, -0.1, 0.1), new three.Vector3(0.25, 0.1, 0.7)), new three.Vector3(0, 1, 0.1));
    this.canvas.addEventListener("pointerdown", (event) => this.down(event));
    this.canvas.addEventListener("pointermove", (event) => this.drag(event));
    for (const end of ["pointerup", "pointercancel"]) this.canvas.addEventListener(end, () => this.up());
    if (this.renderer) this.draw(this.renderer);
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
    renderer.setSize(width, height);
    this.kept.setSize(drawn.width, drawn.height);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    return true;
  }

  private frame(box: three.Box3, from: three.Vector3): void {
    const centre = box.getCenter(new three.Vector3()), radius = box.getSize(new three.Vector3()).length() / 2;
    this.controls.target.copy(centre);
    this.camera.position.copy(centre).addScaledVector(from.normalize(), radius / Math.sin((this.camera.fov * Math.PI) / 360) * 1.02);
    // Looking straight down, the head end of the couch is up.
    this.camera.up.set(0, Math.abs(from.z) > 0.9 ? 1 : 0, Math.abs(from.z) > 0.9 ? 0 : 1);
    this.controls.update();
    this.due = true;
  }

  clear(): void {
    for (const part of [this.cloud, this.back]) if (part) this.still.remove(part);
    this.cloud = this.back = undefined;
    this.framed.makeEmpty();
    for (const group of [this.marks, this.paths, this.felt, this.ruledOut]) group.clear();
    this.edit("turn");
    for (const arm of this.arms) arm.group.visible = false;
    this.due = true;
  }

  showCloud(places: Float32Array): void {
    if (this.cloud) this.still.remove(this.cloud);
    const geometry = new three.BufferGeometry();
    geometry.setAttribute("position", new three.BufferAttribute(places, 3));
    // The newest lines are where the laser is.
    const colours = new Float32Array(places.length), line = new three.Color("#ff2418"), seen = new three.Color("#a8704f");
    for (let i = 0; i < places.length; i += 3) (i < places.length - 3 * newestPoints ? seen : line).toArray(colours, i);
    geometry.setAttribute("color", new three.BufferAttribute(colours, 3));
    this.cloud = new three.Points(geometry, new three.PointsMaterial({ vertexColors: true, size: 0.007 }));
    this.still.add(this.cloud);
    geometry.computeBoundingBox();
    if (places.length > 300 && !this.framed.containsBox(geometry.boundingBox!)) {
      // A little ahead of the laser, so that the picture does not move with every line.
      const { y, z } = this.framed.union(geometry.boundingBox!).expandByScalar(0.05).getSize(new three.Vector3());
      this.frame(this.framed, z < y ? new three.Vector3(0, 0, 1) : new three.Vector3(0, 1, 0.15));
    }
    this.due = true;
  }

  showBack(bytes: ArrayBuffer): void {
    const [count, triangles] = new Uint32Array(bytes, 0, 2) as unknown as [number, number];
    const places = new Float32Array(bytes, 8, 3 * count);
    const normals = new Float32Array(bytes, 8 + 12 * count, 3 * count);
    const corners = new Uint32Array(bytes, 8 + 24 * count, 3 * triangles);
    this.zones = new Uint8Array(bytes, 8 + 24 * count + 12 * triangles, count);
    const geometry = new three.BufferGeometry();
    geometry.setAttribute("position", new three.BufferAttribute(places, 3));
    geometry.setAttribute("normal", new three.BufferAttribute(normals, 3));
    geometry.setAttribute("color", new three.BufferAttribute(new Float32Array(3 * count), 3));
    geometry.setIndex(new three.BufferAttribute(corners, 1));
    if (this.cloud) this.still.remove(this.cloud);
    if (this.back) this.still.remove(this.back);
    this.back = new three.Mesh(geometry, new three.MeshLambertMaterial({ vertexColors: true, side: three.DoubleSide }));
    this.still.add(this.back);
    this.colour(this.showsZones);
    geometry.computeBoundingBox();
    const mean = new three.Vector3();
    for (let i = 0; i < normals.length; i += 3) mean.add(new three.Vector3(normals[i], normals[i + 1], normals[i + 2]));
    this.frame(geometry.boundingBox!, mean.normalize());
  }

  colour(zones: boolean): void {
    this.showsZones = zones;
    const colours = this.back?.geometry.getAttribute("color");
    if (!colours || !this.zones) return;
    const byZone = zoneColours.map((colour) => new three.Color(colour).lerp(skin, 0.25));
    for (let i = 0; i < colours.count; ++i) {
      const colour = zones ? byZone[this.zones[i]!] ?? skin : skin;
      colours.setXYZ(i, colour.r, colour.g, colour.b);
    }
    colours.needsUpdate = true;
    this.due = true;
  }

  showAcupoints(points: Acupoint[]): void {
    this.points = points.map((point) => ({ ...point }));
    this.marks.clear();
    for (const point of points) {
      const normal = toFloat(point.normal), at = toFloat(point.at).addScaledVector(normal, 0.004);
      const dot = new three.Mesh(new three.SphereGeometry(0.0045, 10, 8), new three.MeshBasicMaterial({ color: "#7a1712" }));
      dot.position.copy(at);
      const radius = point.uncertainty_mm / 1000;
      const ring = new three.Mesh(new three.RingGeometry(radius - 0.0012, radius, 48),
        new three.MeshBasicMaterial({ color: "#7a1712", side: three.DoubleSide, transparent: true, opacity: 0.75 }));
      ring.position.copy(at).addScaledVector(normal, 0.004);
      ring.quaternion.setFromUnitVectors(new three.Vector3(0, 0, 1), normal);
      this.marks.add(dot, ring);
    }
    this.due = true;
  }

  showPaths(paths: Path[]): void {
    this.paths.clear();
    for (const path of paths) {
      const colour = techniqueColours[path.technique] ?? "#333333";
      const places = path.places.map(toFloat);
      const apart = places.filter((place, i) => i === 0 || place.distanceTo(places[i - 1]!) > 0.001);
      const material = new three.MeshBasicMaterial({ color: colour, depthTest: false });
      if (apart.length < 3) {
        const spot = new three.Mesh(new three.SphereGeometry(0.006, 12, 8), material);
        spot.position.copy(places[0]!);
        this.paths.add(spot);
      } else {
        this.paths.add(new three.Mesh(new three.TubeGeometry(new three.CatmullRomCurve3(apart), 60, 0.002, 5), material));
      }
    }
    for (const shape of this.paths.children) shape.renderOrder = 1;
    this.due = true;
  }

  /** A ring for each place that was felt, from soft (0) to stiff (1). */
  showFelt(places: { at: [number, number, number]; stiffness: number }[]): void {
    this.felt.clear();
    for (const place of places) {
      const colour = new three.Color("#2f9e8f").lerp(new three.Color("#8b1e5b"), place.stiffness);
      const ring = new three.Mesh(new three.TorusGeometry(0.013, 0.004, 8, 28), new three.MeshBasicMaterial({ color: colour, depthTest: false }));
      const at = toFloat(place.at);
      ring.position.copy(at);
      ring.quaternion.setFromUnitVectors(new three.Vector3(0, 0, 1), this.normalNear(at));
      ring.renderOrder = 2;
      this.felt.add(ring);
    }
    this.due = true;
  }

  /** Outlines of areas that are ruled out, closed. */
  showRuledOut(areas: [number, number, number][][]): void {
    this.ruledOut.clear();
    for (const area of areas) this.ruledOut.add(this.outline(area, true));
    this.due = true;
  }

  private outline(area: [number, number, number][], closed: boolean): three.Object3D {
    const places = area.map((place) => { const at = toFloat(place); return at.addScaledVector(this.normalNear(at), 0.003); });
    const line = new three.Mesh(new three.TubeGeometry(new three.CatmullRomCurve3(places, closed), Math.max(24, 3 * places.length), 0.003, 5, closed),
      new three.MeshBasicMaterial({ color: ruledOutColour, depthTest: false }));
    line.renderOrder = 3;
    return line;
  }

  /** What a pointer on the picture does: turns it, moves an acupoint, or draws around an area. */
  edit(how: Edit): void {
    this.how = how;
    this.controls.enabled = how === "turn";
    this.canvas.style.cursor = how === "turn" ? "" : how === "move" ? "grab" : "crosshair";
  }

  /** Moves an acupoint over the back by so many metres to the right and up as it is seen, and says where it is then. */
  nudge(name: string, right: number, up: number): [number, number, number] | undefined {
    const point = this.points.find((one) => one.name === name);
    if (!point || !this.back) return undefined;
    const axis = (column: number): three.Vector3 => new three.Vector3().setFromMatrixColumn(this.camera.matrixWorld, column);
    const at = toFloat(point.at).addScaledVector(axis(0), right).addScaledVector(axis(1), up);
    const hit = new three.Raycaster(this.camera.position, at.sub(this.camera.position).normalize()).intersectObject(this.back)[0];
    if (!hit) return undefined;
    point.at = hit.point.toArray();
    this.showAcupoints(this.points);
    return point.at;
  }

  private place(event: PointerEvent): three.Vector3 | undefined {
    if (!this.back) return undefined;
    const box = this.canvas.getBoundingClientRect();
    const at = new three.Vector2((2 * (event.clientX - box.left)) / box.width - 1, 1 - (2 * (event.clientY - box.top)) / box.height);
    const ray = new three.Raycaster();
    ray.setFromCamera(at, this.camera);
    return ray.intersectObject(this.back)[0]?.point;
  }

  private down(event: PointerEvent): void {
    const at = this.how === "turn" ? undefined : this.place(event);
    if (!at) return;
    this.canvas.setPointerCapture(event.pointerId);
    if (this.how === "rule_out") this.drawn = [at.toArray()];
    else {
      const near = this.points.map((point) => ({ point, far: toFloat(point.at).distanceTo(at) })).sort((a, b) => a.far - b.far)[0];
      if (near && near.far < 0.03) this.dragged = near.point;
    }
  }

  private drag(event: PointerEvent): void {
    const at = this.dragged || this.drawn ? this.place(event) : undefined;
    if (!at) return;
    if (this.dragged) {
      this.dragged.at = at.toArray();
      this.showAcupoints(this.points);
    } else if (this.drawn && at.distanceTo(toFloat(this.drawn.at(-1)!)) > 0.008 && this.drawn.length < 80) {
      this.drawn.push(at.toArray());
      if (this.drawn.length > 2) {
        this.marks.remove(this.marks.getObjectByName("drawn")!);
        const line = this.outline(this.drawn, false);
        line.name = "drawn";
        this.marks.add(line);
        this.due = true;
      }
    }
  }

  private up(): void {
    const { dragged, drawn } = this;
    this.dragged = this.drawn = undefined;
    if (dragged) this.onMoved(dragged.name, dragged.at);
    if (drawn) this.showAcupoints(this.points);
    if (drawn && drawn.length > 2) this.onRuledOut(drawn);
  }

  moveArm(arm: number, links: [number, number, number, number][]): void {
    this.arms[arm]!.move(links);
    this.moved = true;
  }

  private normalNear(place: three.Vector3): three.Vector3 {
    const places = this.back?.geometry.getAttribute("position"), normals = this.back?.geometry.getAttribute("normal");
    if (!places || !normals) return new three.Vector3(0, 1, 0);
    let nearest = 0, distance = Infinity;
    for (let i = 0; i < places.count; i += 3) {
      const d = (places.getX(i) - place.x) ** 2 + (places.getY(i) - place.y) ** 2 + (places.getZ(i) - place.z) ** 2;
      if (d < distance) { distance = d; nearest = i; }
    }
    return new three.Vector3(normals.getX(nearest), normals.getY(nearest), normals.getZ(nearest)).normalize();
  }
}
