// SPDX-License-Identifier: Apache-2.0
import { element } from "./element";
import { Forces } from "./forces";
import { armColours } from "./picture/scene";
import { page, scene } from "./shown";
import { say } from "./words";

export function stage(...over: (HTMLElement | string)[]): HTMLElement {
  return element("div", { class: "view" }, scene.canvas, element("div", { class: "over-view" }, ...over));
}

export function dot(colour: string, words: string): HTMLElement {
  const mark = element("i", {});
  mark.style.background = colour;
  return element("span", {}, mark, words);
}

/** Which line is which. */
function lines(arm: number): HTMLElement {
  const felt = element("i", {});
  felt.style.color = armColours[arm]!;
  return element("p", { class: "note lines" }, element("i", { class: "asked" }), say("target"), felt, say("felt"));
}

/** What each arm does, and its force asked for and felt. */
export function armCards(): HTMLElement[] {
  const arms = [0, 1].map((arm) => {
    const now = (page.slots[`force${arm}`] = element("b", {}, "0.0 N")), what = (page.slots[`what${arm}`] = element("span", {}));
    const place = (page.slots[`plot${arm}`] ??= element("div", { role: "img", "aria-label": say("force_label") }));
    return element("div", { class: "card" }, element("div", { class: "force" }, dot(armColours[arm]!, say(arm ? "right" : "left")), what, now), place, lines(arm));
  });
  page.forces = [0, 1].map((arm) => { const before = page.forces[arm]; const plot = new Forces(page.slots[`plot${arm}`]!, arm); if (before) plot.take(before); return plot; });
  return arms;
}
