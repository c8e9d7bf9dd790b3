// SPDX-License-Identifier: Apache-2.0
import * as three from "three";

/** An arm as capsules between its joints, and the ball that it massages with. */
export class ArmShape {
  readonly group = new three.Group();
  private readonly balls: three.Mesh[] = [];
  private readonly tubes: three.Mesh[] = [];
  private readonly shell = new three.MeshLambertMaterial({ color: "#c9ced6", transparent: true, opacity: 0.5 });
  private readonly tip: three.Material;

  constructor(colour: string) {
    this.tip = new three.MeshLambertMaterial({ color: colour });
    const ball = new three.SphereGeometry(1, 16, 12), tube = new three.CylinderGeometry(1, 1, 1, 16, 1, true);
    for (let i = 0; i < 8; ++i) {
      this.balls.push(new three.Mesh(ball, this.shell));
      this.tubes.push(new three.Mesh(tube, this.shell));
    }
    this.group.add(...this.balls, ...this.tubes);
    this.group.visible = false;
  }

  /** Joints from shoulder to tool: place, and radius of the link that begins there; m. */
  move(links: [number, number, number, number][]): void {
    this.group.visible = links.length > 0;
    this.balls.forEach((ball, i) => {
      const link = links[i];
      ball.visible = !!link;
      if (!link) return;
      ball.position.set(link[0], link[1], link[2]);
      ball.scale.setScalar(link[3]);
      ball.material = i === links.length - 1 ? this.tip : this.shell;
    });
    this.tubes.forEach((tube, i) => {
      const from = links[i], to = links[i + 1];
      tube.visible = !!from && !!to;
      if (!from || !to) return;
      const begin = new three.Vector3(from[0], from[1], from[2]), along = new three.Vector3(to[0], to[1], to[2]).sub(begin);
      const length = along.length();
      tube.visible = length > 1e-4;
      tube.position.copy(begin).addScaledVector(along, 0.5);
      tube.scale.set(from[3], length, from[3]);
      tube.quaternion.setFromUnitVectors(new three.Vector3(0, 1, 0), along.normalize());
      tube.material = i === links.length - 2 ? this.tip : this.shell;
    });
  }
}
