// SPDX-License-Identifier: Apache-2.0
import { type Acupoint } from "./picture/marks";

/** Corners of a circle in the skin's plane around an acupoint; radius in m. */
export function circleAround(point: Acupoint, radius: number): [number, number, number][] {
  const [x, y, z] = point.normal, long = Math.abs(z) < 0.9 ? [0, 0, 1] : [0, 1, 0];
  const cross = (a: number[], b: number[]): number[] => [a[1]! * b[2]! - a[2]! * b[1]!, a[2]! * b[0]! - a[0]! * b[2]!, a[0]! * b[1]! - a[1]! * b[0]!];
  const unit = (a: number[]): number[] => a.map((one) => one / Math.hypot(...a));
  const right = unit(cross(long, [x, y, z])), up = cross([x, y, z], right);
  return Array.from({ length: 16 }, (_, i) => { const turn = (i * Math.PI) / 8; return point.at.map((at, axis) =>
    at + radius * (Math.cos(turn) * right[axis]! + Math.sin(turn) * up[axis]!)) as [number, number, number]; });
}
