// SPDX-License-Identifier: Apache-2.0
import * as three from "three";

export const zoneColours = ["#7fb59a", "#d8b45a", "#cf9a6a", "#c98b80", "#c98b80", "#c47a8e", "#b06ad0", "#d04a4a", "#777777", "#8a8f98", "#d04a4a"];
const skin = new three.Color("#d9b39b");

/** The scanned back: its surface, and the zone of each place of it. */
export class BackShape {
  readonly mesh: three.Mesh;
  readonly box: three.Box3;
  /** Mean direction out of the back. */
  readonly out = new three.Vector3();
  private readonly zones: Uint8Array;

  /** As /api/back has it: counts, places, normals, triangles, zones. */
  constructor(bytes: ArrayBuffer) {
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
    geometry.computeBoundingBox();
    this.box = geometry.boundingBox!;
    for (let i = 0; i < normals.length; i += 3) this.out.add(new three.Vector3(normals[i], normals[i + 1], normals[i + 2]));
    this.out.normalize();
    this.mesh = new three.Mesh(geometry, new three.MeshLambertMaterial({ vertexColors: true, side: three.DoubleSide }));
  }

  /** As skin, or by its zones. */
  colour(byZone: boolean): void {
    const colours = this.mesh.geometry.getAttribute("color");
    const ofZone = zoneColours.map((colour) => new three.Color(colour).lerp(skin, 0.25));
    for (let i = 0; i < colours.count; ++i) {
      const colour = byZone ? ofZone[this.zones[i]!] ?? skin : skin;
      colours.setXYZ(i, colour.r, colour.g, colour.b);
    }
    colours.needsUpdate = true;
  }

  normalNear(place: three.Vector3): three.Vector3 {
    const places = this.mesh.geometry.getAttribute("position"), normals = this.mesh.geometry.getAttribute("normal");
    let nearest = 0, distance = Infinity;
    for (let i = 0; i < places.count; i += 3) {
      const d = (places.getX(i) - place.x) ** 2 + (places.getY(i) - place.y) ** 2 + (places.getZ(i) - place.z) ** 2;
      if (d < distance) { distance = d; nearest = i; }
    }
    return new three.Vector3(normals.getX(nearest), normals.getY(nearest), normals.getZ(nearest)).normalize();
  }
}
