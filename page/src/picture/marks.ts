// SPDX-License-Identifier: Apache-2.0
import * as three from "three";
import { techniqueColours } from "../techniques";

export type Place = [number, number, number];
export interface Acupoint { name: string; at: Place; normal: Place; uncertainty_mm: number }
export interface Path { name: string; technique: string; arm: string; step: number; start_s: number; duration_s: number; zone: string; ordered_n: number; cap_n?: number; places: Place[] }

const ruledOutColour = "#d04a4a", newestPoints = 400;

export const vector = (place: Place): three.Vector3 => new three.Vector3(...place);

/** Points of the scan; the newest lines are where the laser is. */
export function cloudShape(places: Float32Array): three.Points {
  const geometry = new three.BufferGeometry();
  geometry.setAttribute("position", new three.BufferAttribute(places, 3));
  const colours = new Float32Array(places.length), line = new three.Color("#ff2418"), seen = new three.Color("#a8704f");
  for (let i = 0; i < places.length; i += 3) (i < places.length - 3 * newestPoints ? seen : line).toArray(colours, i);
  geometry.setAttribute("color", new three.BufferAttribute(colours, 3));
  geometry.computeBoundingBox();
  return new three.Points(geometry, new three.PointsMaterial({ vertexColors: true, size: 0.007 }));
}

/** A dot, and the circle that holds the true point in 95 of 100 cases. */
export function acupointMark(point: Acupoint): three.Object3D[] {
  const normal = vector(point.normal), at = vector(point.at).addScaledVector(normal, 0.004);
  const dot = new three.Mesh(new three.SphereGeometry(0.0045, 10, 8), new three.MeshBasicMaterial({ color: "#7a1712" }));
  dot.position.copy(at);
  const radius = point.uncertainty_mm / 1000;
  const ring = new three.Mesh(new three.RingGeometry(radius - 0.0012, radius, 48),
    new three.MeshBasicMaterial({ color: "#7a1712", side: three.DoubleSide, transparent: true, opacity: 0.75 }));
  ring.position.copy(at).addScaledVector(normal, 0.004);
  ring.quaternion.setFromUnitVectors(new three.Vector3(0, 0, 1), normal);
  return [dot, ring];
}

/** A spot where a tool stays, a line where it slides. */
export function pathShape(path: Path): three.Mesh {
  const places = path.places.map(vector);
  const apart = places.filter((place, i) => i === 0 || place.distanceTo(places[i - 1]!) > 0.001);
  const material = new three.MeshBasicMaterial({ color: techniqueColours[path.technique] ?? "#333333", depthTest: false });
  const slides = apart.length >= 3;
  const shape = new three.Mesh(slides ? new three.TubeGeometry(new three.CatmullRomCurve3(apart), 60, 0.002, 5)
    : new three.SphereGeometry(0.006, 12, 8), material);
  if (!slides) shape.position.copy(places[0]!);
  shape.renderOrder = 1;
  return shape;
}

/** A ring around a place that was felt, from soft (0) to stiff (1). */
export function feltRing(at: three.Vector3, normal: three.Vector3, stiffness: number): three.Mesh {
  const colour = new three.Color("#2f9e8f").lerp(new three.Color("#8b1e5b"), stiffness);
  const ring = new three.Mesh(new three.TorusGeometry(0.013, 0.004, 8, 28), new three.MeshBasicMaterial({ color: colour, depthTest: false }));
  ring.position.copy(at);
  ring.quaternion.setFromUnitVectors(new three.Vector3(0, 0, 1), normal);
  ring.renderOrder = 2;
  return ring;
}

/** The outline of an area that is ruled out. */
export function outline(places: three.Vector3[], closed: boolean): three.Mesh {
  const line = new three.Mesh(new three.TubeGeometry(new three.CatmullRomCurve3(places, closed), Math.max(24, 3 * places.length), 0.003, 5, closed),
    new three.MeshBasicMaterial({ color: ruledOutColour, depthTest: false }));
  line.renderOrder = 3;
  return line;
}
