// SPDX-License-Identifier: Apache-2.0
import { element } from "./element";
import { type Acupoint } from "./picture/marks";
import { type Scene } from "./picture/scene";
import { type Words } from "./shown";
import { say } from "./words";

const stepM = 0.002;
const ways: Record<string, [number, number]> =
  { ArrowRight: [stepM, 0], ArrowLeft: [-stepM, 0], ArrowUp: [0, stepM], ArrowDown: [0, -stepM] };

/** A button whose arrow keys move an acupoint over the back that is shown, for hands that do not drag. Enter, or
 * whatever takes the focus away, keeps the new place; a press that has moved nothing has the keys told. */
export function moveKeys(point: Acupoint, scene: Scene, disabled: boolean, tell: (words: Words) => void): HTMLElement {
  let moved: [number, number, number] | undefined;
  const keep = (): boolean => {
    const at = moved;
    moved = undefined;
    if (at) scene.onMoved(point.name, at);
    return !!at;
  };
  const button = element("button", { id: `move_${point.name}`, "aria-label": `${say("move_here")} ${point.name}. ${say("move_keys")}`,
    title: say("move_keys"), disabled, onblur: () => void keep(), onclick: () => { if (!keep()) tell(() => say("move_keys")); } }, say("move_here"));
  button.onkeydown = (event) => {
    const way = ways[event.key];
    if (!way) return;
    event.preventDefault();
    moved = scene.nudge(point.name, ...way) ?? moved;
  };
  return button;
}
