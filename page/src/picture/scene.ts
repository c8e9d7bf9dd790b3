// SPDX-License-Identifier: Apache-2.0
import * as three from "three";
import { ArmShape } from "./arm_shape";
import { BackShape } from "./back_shape";
import { Drawing } from "./drawing";
import { type Acupoint, acupointMark, cloudShape, feltRing, outline, type Path, pathShape, type Place, vector } from "./marks";

export const armColours = ["#d9872b", "#2f7fb8"];  // left, right
export type Edit = "turn" | "move" | "rule_out";

/** The back, what is planned on it, and both arms; and what a pointer does on the picture. */
export class Scene {
  readonly canvas: HTMLElement;
  onMoved: (name: string, at: Place) => void = () => {};
  onRuledOut: (corners: Place[]) => void = () => {};
  private readonly drawing: Drawing;
  private cloud?: three.Points | undefined;
  private framed = new three.Box3();
  private back?: BackShape | undefined;
  private readonly marks = new three.Group();
  private readonly paths = new three.Group();
  private readonly felt = new three.Group();
  private readonly ruledOut = new three.Group();
  private readonly arms = armColours.map((colour) => new ArmShape(colour));
  private points: Acupoint[] = [];
  private showsZones = false;
  private how: Edit = "turn";
  private dragged?: Acupoint | undefined;
  private drawn?: Place[] | undefined;

  constructor(label: string, noPicture: string) {
    this.drawing = new Drawing(label, noPicture);
    this.canvas = this.drawing.canvas;
    this.drawing.still.add(this.marks, this.paths, this.felt, this.ruledOut);
    this.drawing.moving.add(...this.arms.map((arm) => arm.group));
    this.drawing.frame(new three.Box3(new three.Vector3(-0.25, -0.1, 0.1), new three.Vector3(0.25, 0.1, 0.7)), new three.Vector3(0, 1, 0.1));
    this.canvas.addEventListener("pointerdown", (event) => this.down(event));
    this.canvas.addEventListener("pointermove", (event) => this.drag(event));
    for (const end of ["pointerup", "pointercancel"]) this.canvas.addEventListener(end, () => this.up());
  }

  clear(): void {
    this.forgetSurface();
    this.framed.makeEmpty();
    for (const group of [this.marks, this.paths, this.felt, this.ruledOut]) group.clear();
    this.edit("turn");
    for (const arm of this.arms) arm.group.visible = false;
    this.drawing.due = true;
  }

  private forgetSurface(): void {
    if (this.cloud) this.drawing.still.remove(this.cloud);
    if (this.back) this.drawing.still.remove(this.back.mesh);
    this.cloud = this.back = undefined;
  }

  showCloud(places: Float32Array): void {
    if (this.cloud) this.drawing.still.remove(this.cloud);
    this.cloud = cloudShape(places);
    this.drawing.still.add(this.cloud);
    const box = this.cloud.geometry.boundingBox!;
    if (places.length > 300 && !this.framed.containsBox(box)) {
      // A little ahead of the laser, so that the picture does not move with every line.
      const { y, z } = this.framed.copy(box).expandByVector(new three.Vector3(0.08, 0.02, 0.02)).getSize(new three.Vector3());
      this.drawing.frame(this.framed, z < y ? new three.Vector3(0, 0, 1) : new three.Vector3(0, 1, 0.15));
    }
    this.drawing.due = true;
  }

  showBack(bytes: ArrayBuffer): void {
    this.forgetSurface();
    this.back = new BackShape(bytes);
    this.drawing.still.add(this.back.mesh);
    this.colour(this.showsZones);
    this.drawing.frame(this.back.box, this.back.out.clone());
  }

  colour(zones: boolean): void {
    this.showsZones = zones;
    this.back?.colour(zones);
    this.drawing.due = true;
  }

  private show(group: three.Group, shapes: three.Object3D[]): void {
    group.clear();
    if (shapes.length) group.add(...shapes);
    this.drawing.due = true;
  }

  showAcupoints(points: Acupoint[]): void {
    this.points = points.map((point) => ({ ...point }));
    this.show(this.marks, points.flatMap(acupointMark));
  }

  showPaths(paths: Path[]): void { this.show(this.paths, paths.map(pathShape)); }

  /** A ring for each place that was felt, from soft (0) to stiff (1). */
  showFelt(places: { at: Place; stiffness: number }[]): void {
    this.show(this.felt, places.map((place) => feltRing(vector(place.at), this.normalNear(vector(place.at)), place.stiffness)));
  }

  /** Outlines of areas that are ruled out, closed. */
  showRuledOut(areas: Place[][]): void {
    this.show(this.ruledOut, areas.map((area) => outline(this.aboveSkin(area), true)));
  }

  moveArm(arm: number, links: [number, number, number, number][]): void {
    this.arms[arm]!.move(links);
    this.drawing.moved = true;
  }

  /** What a pointer on the picture does: turns it, moves an acupoint, or draws around an area. */
  edit(how: Edit): void {
    this.how = how;
    this.drawing.controls.enabled = how === "turn";
    this.canvas.style.cursor = how === "turn" ? "" : how === "move" ? "grab" : "crosshair";
  }

  /** Moves an acupoint over the back by so many metres to the right and up as it is seen, and says where it is then. */
  nudge(name: string, right: number, up: number): Place | undefined {
    const point = this.points.find((one) => one.name === name), { camera } = this.drawing;
    if (!point || !this.back) return undefined;
    const axis = (column: number): three.Vector3 => new three.Vector3().setFromMatrixColumn(camera.matrixWorld, column);
    const at = vector(point.at).addScaledVector(axis(0), right).addScaledVector(axis(1), up);
    const hit = new three.Raycaster(camera.position, at.sub(camera.position).normalize()).intersectObject(this.back.mesh)[0];
    if (!hit) return undefined;
    point.at = hit.point.toArray();
    this.showAcupoints(this.points);
    return point.at;
  }

  private normalNear(place: three.Vector3): three.Vector3 { return this.back?.normalNear(place) ?? new three.Vector3(0, 1, 0); }

  private aboveSkin(places: Place[]): three.Vector3[] {
    return places.map((place) => { const at = vector(place); return at.addScaledVector(this.normalNear(at), 0.003); });
  }

  private place(event: PointerEvent): three.Vector3 | undefined {
    return this.back && this.drawing.ray(event.clientX, event.clientY).intersectObject(this.back.mesh)[0]?.point;
  }

  private down(event: PointerEvent): void {
    const at = this.how === "turn" ? undefined : this.place(event);
    if (!at) return;
    this.canvas.setPointerCapture(event.pointerId);
    if (this.how === "rule_out") this.drawn = [at.toArray()];
    else {
      const near = this.points.map((point) => ({ point, far: vector(point.at).distanceTo(at) })).sort((a, b) => a.far - b.far)[0];
      if (near && near.far < 0.03) this.dragged = near.point;
    }
  }

  private drag(event: PointerEvent): void {
    const at = this.dragged || this.drawn ? this.place(event) : undefined;
    if (!at) return;
    if (this.dragged) {
      this.dragged.at = at.toArray();
      this.showAcupoints(this.points);
    } else if (this.drawn && at.distanceTo(vector(this.drawn.at(-1)!)) > 0.008 && this.drawn.length < 80) {
      this.drawn.push(at.toArray());
      if (this.drawn.length > 2) {
        this.marks.remove(this.marks.getObjectByName("drawn")!);
        const line = outline(this.aboveSkin(this.drawn), false);
        line.name = "drawn";
        this.marks.add(line);
        this.drawing.due = true;
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
}
