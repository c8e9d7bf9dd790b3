// SPDX-License-Identifier: Apache-2.0
import * as three from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";

export interface Acupoint { name: string; at: [number, number, number]; normal: [number, number, number]; uncertainty_mm: number }
export interface Path { name: string; technique: string; arm: string; step: number; start_s: number; duration_s: number; zone: string; ordered_n: number; places: [number, number, number][] }

export const armColours = ["#d9872b", "#2f7fb8"];  // left, right
export const techniqueColours: Record<string, string> =
  { press: "#c8342c", rub: "#1868b2", stroke: "#10846a", tap: "#8b4fb0", knead: "#b0741a" };
export const zoneColours = ["#7fb59a", "#d8b45a", "#cf9a6a", "#c98b80", "#c98b80", "#c47a8e", "#b06ad0", "#d04a4a", "#777777", "#8a8f98", "#d04a4a"];
const skin = new three.Color("#d9b39b");

function toFloat(place: [number, number, number]): three.Vector3 { return new three.Vector3(...place); }

/** The back, what is planned on it, and the two tools. It draws only when something has changed. */
export class Scene {
  readonly canvas: HTMLCanvasElement;
  private readonly renderer: three.WebGLRenderer;
  private readonly scene = new three.Scene();
  private readonly camera = new three.PerspectiveCamera(32, 1, 0.05, 10);
  private readonly controls: OrbitControls;
  private cloud?: three.Points;
  private back?: three.Mesh;
  private marks = new three.Group();
  private paths = new three.Group();
  private tools: three.Group[] = [];
  private zones?: Uint8Array;
  private showsZones = false;
  private due = true;
  private restUntilMs = 0;

  constructor(label: string) {
    this.renderer = new three.WebGLRenderer({ antialias: true, alpha: true });
    this.canvas = this.renderer.domElement;
    this.canvas.tabIndex = 0;
    this.canvas.setAttribute("role", "img");
    this.canvas.setAttribute("aria-label", label);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.addEventListener("change", () => (this.due = true));
    const key = new three.DirectionalLight("#fff6ea", 2.1);
    key.position.set(0.7, 1.6, 1.6);
    const rim = new three.DirectionalLight("#cfe0ff", 0.8);
    rim.position.set(-1.6, 0.9, 0.4);
    this.scene.add(new three.HemisphereLight("#ffffff", "#8d7f78", 0.9), key, rim, this.marks, this.paths);
    for (const colour of armColours) this.tools.push(this.tool(colour));
    this.frame(new three.Box3(new three.Vector3(-0.25, -0.1, 0.1), new three.Vector3(0.25, 0.1, 0.7)), new three.Vector3(0, 1, 0.1));
    const draw = (): void => {
      requestAnimationFrame(draw);
      this.controls.update();
      const began = performance.now();
      if (began < this.restUntilMs || !(this.fit() || this.due)) return;
      this.due = false;
      this.renderer.render(this.scene, this.camera);
      // Reading one pixel waits until the picture is drawn, so that the time tells what it took.
      const gl = this.renderer.getContext();
      gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
      // A slow machine has half of its time for what is asked and heard.
      this.restUntilMs = 2 * performance.now() - began;
    };
    draw();
  }

  private tool(colour: string): three.Group {
    const tool = new three.Group();
    const material = new three.MeshLambertMaterial({ color: colour });
    const ball = new three.Mesh(new three.SphereGeometry(0.014, 24, 16), material);
    ball.position.y = 0.014;
    const shaft = new three.Mesh(new three.CylinderGeometry(0.008, 0.011, 0.11, 20), material);
    shaft.position.y = 0.08;
    tool.add(ball, shaft);
    tool.visible = false;
    this.scene.add(tool);
    return tool;
  }

  private fit(): boolean {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement ?? this.canvas;
    const ratio = Math.min(devicePixelRatio, 2);
    if (width === 0 || (this.canvas.width === Math.floor(width * ratio) && this.canvas.height === Math.floor(height * ratio))) return false;
    this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(width, height);
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
    for (const part of [this.cloud, this.back]) if (part) this.scene.remove(part);
    this.cloud = this.back = undefined;
    this.marks.clear();
    this.paths.clear();
    for (const tool of this.tools) tool.visible = false;
    this.due = true;
  }

  showCloud(places: Float32Array): void {
    if (this.cloud) this.scene.remove(this.cloud);
    const geometry = new three.BufferGeometry();
    geometry.setAttribute("position", new three.BufferAttribute(places, 3));
    this.cloud = new three.Points(geometry, new three.PointsMaterial({ color: "#d8493f", size: 0.0035 }));
    this.scene.add(this.cloud);
    if (places.length > 300) {
      geometry.computeBoundingBox();
      this.frame(geometry.boundingBox!, new three.Vector3(0, 1, 0.15));
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
    if (this.cloud) this.scene.remove(this.cloud);
    if (this.back) this.scene.remove(this.back);
    this.back = new three.Mesh(geometry, new three.MeshLambertMaterial({ vertexColors: true, side: three.DoubleSide }));
    this.scene.add(this.back);
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
    this.marks.clear();
    for (const point of points) {
      const normal = toFloat(point.normal), at = toFloat(point.at).addScaledVector(normal, 0.004);
      const dot = new three.Mesh(new three.SphereGeometry(0.0045, 16, 12), new three.MeshBasicMaterial({ color: "#7a1712" }));
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
      const places = path.places.map(toFloat);
      if (places.length < 2 || places[0]!.distanceTo(places[places.length >> 1]!) < 0.002) continue;
      const line = new three.Mesh(new three.TubeGeometry(new three.CatmullRomCurve3(places), 80, 0.002, 6),
        new three.MeshBasicMaterial({ color: techniqueColours[path.technique] ?? "#333333", depthTest: false }));
      line.renderOrder = 1;
      this.paths.add(line);
    }
    this.due = true;
  }

  moveTool(arm: number, place: [number, number, number]): void {
    const tool = this.tools[arm]!;
    tool.visible = true;
    tool.position.set(...place);
    const up = this.normalNear(tool.position);
    tool.quaternion.setFromUnitVectors(new three.Vector3(0, 1, 0), up);
    this.due = true;
  }

  // The tool stands along the skin's normal below it.
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
