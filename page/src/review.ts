// SPDX-License-Identifier: Apache-2.0
import { circleAround } from "./circle";
import { element, table } from "./element";
import { moveKeys } from "./move_keys";
import { zoneColours } from "./picture/back_shape";
import { type Place } from "./picture/marks";
import { type Edit } from "./picture/scene";
import { type ByHand, maySteer, page, scene, speak, steer, tell, toldPlace, whyNot } from "./shown";
import { dot, stage } from "./stage";
import { techniqueColours } from "./techniques";
import { say, sayLines, sayPath, saySentence } from "./words";

/** Number of the review whose plan the view shows; -1 while it shows none that waits. */
let drawn = -1;
/** Runs while the button that arms is held. */
let timer = 0;
const holdMs = 2100, hearMs = 50;

/** Nobody arms or changes a plan that the view does not show: another one is being made, or is on its way. */
const mayAnswer = (): boolean => maySteer() && drawn === page.state!.reviews && drawn !== page.reviewsBefore &&
  drawn === page.seen.reviews && page.seen.plans === page.state!.plans;

const mayUndo = (): boolean => mayAnswer() && page.wanted.no_go.length + page.wanted.fixed.length > 0;

/** Outlines and acupoints as the plan that stands has them. */
export function showByHand(): void {
  scene.showRuledOut(page.wanted.no_go.map((area) => area.corners));
  scene.showAcupoints(page.points);
}

/** Asks for another plan, with what is ruled out and what was moved. */
function change(wanted: ByHand): void {
  letGo();
  if (!mayAnswer()) {
    speak(() => (maySteer() ? say("planning_anew") : whyNot()));
    return showByHand();
  }
  steer();
  page.told = () => "";
  page.reviewsBefore = drawn;
  page.wanted = wanted;
  scene.showRuledOut(wanted.no_go.map((area) => area.corners));
  page.link.ask("change", { order: wanted, review: drawn });
  showPlanning();
}

const ruleOut = (name: string, corners: Place[]): void =>
  change({ ...page.wanted, no_go: [...page.wanted.no_go, { name, corners }] });
scene.onMoved = (name, at) =>
  change({ ...page.wanted, fixed: [...page.wanted.fixed.filter((one) => one.name !== name), { name, at }] });
scene.onRuledOut = (corners) => ruleOut(`area ${page.wanted.no_go.length + 1}`, corners);

function showHeld(): void {
  const button = document.getElementById("arm");
  button?.classList.toggle("down", timer !== 0);
  button?.firstElementChild!.replaceChildren(say(timer ? "arming" : "arm"));
}

/** Nothing is armed by a button that was let go, wherever that was, nor after a change. */
function letGo(): void {
  clearTimeout(timer);
  timer = 0;
  showHeld();
}
for (const end of ["pointerup", "pointercancel", "keyup"]) addEventListener(end, letGo, true);
addEventListener("blur", letGo);  // of the window alone

function hold(): void {
  if (timer || !mayAnswer()) return;
  const held = drawn;
  steer();
  page.link.ask("hold", { review: held });
  const arm = (): void => {
    const button = document.getElementById("arm") as HTMLButtonElement | null;
    const may = button && !button.disabled && mayAnswer() && drawn === held;
    letGo();
    if (may) page.link.ask("arm", { review: held });
  };
  // Where a long drawing has kept both waiting, the release is heard before the second timer ends.
  timer = window.setTimeout(() => { timer = window.setTimeout(arm, hearMs); }, holdMs);
  showHeld();
}

/** While another plan is made nothing can be armed; what could not be done is said. */
export function showPlanning(): void {
  const planning = page.state!.reviews === page.reviewsBefore, place = document.getElementById("refusal");
  if (!mayAnswer()) letGo();
  for (const [id, may] of [["arm", mayAnswer()], ["undo", mayUndo()]] as const) {
    const button = document.getElementById(id) as HTMLButtonElement | null;
    if (button) button.disabled = !may;
  }
  if (!place || page.view !== "review") return;
  place.textContent = planning ? say("planning_anew") : page.told() || (page.state!.said.length ? `${say("refused")} ${sayLines(page.state!.said)}` : "");
}

export function review(): HTMLElement {
  drawn = page.seen.plans === page.state!.plans ? page.seen.reviews : -1;
  const button = element("button", { class: timer ? "go hold down" : "go hold", id: "arm", disabled: !mayAnswer() },
    element("span", {}, say(timer ? "arming" : "arm")));
  button.onpointerdown = (event) => { if (event.button === 0) hold(); };
  button.onpointerleave = letGo;
  button.oncontextmenu = (event) => event.preventDefault();  // a menu would hear the release in our place
  button.onkeydown = (event) => {
    if (event.key !== " " && event.key !== "Enter") return;
    event.preventDefault();
    event.stopPropagation();
    if (!event.repeat) hold();
  };
  const zones = element("button", { "aria-pressed": String(page.zonesShown), onclick: () => { page.zonesShown = !page.zonesShown; scene.colour(page.zonesShown); page.render(); } }, say("zones"));
  const tool = (how: Edit): HTMLElement => element("button", { id: how, "aria-pressed": String(page.editing === how), disabled: !maySteer(),
    onclick: () => { page.editing = page.editing === how ? "turn" : how; scene.edit(page.editing); page.render(); } }, say(how));
  const takeBack = (): void => change({ no_go: [], fixed: [] });
  const undo = element("button", { id: "undo", disabled: !mayUndo(), onclick: takeBack }, say("undo"));
  const picture = stage();
  picture.append(element("div", { class: "legend" }, ...(page.zonesShown
    ? page.choices.zones.map((zone, i) => dot(zoneColours[i]!, `${say(zone.name)} ${zone.cap_n} N`))
    : Object.entries(techniqueColours).filter(([name]) => page.plan?.paths.some((path) => path.technique === name)).map(([name, colour]) => dot(colour, say(name))))));
  const notes = page.plan?.notes ?? [], alerts = notes.filter((note) => ["note_said_dropped", "note_somebody_else"].includes(note.key));
  // Beside the picture, since on a phone they would cover the neck.
  const tools = element("div", { class: "row" }, zones, tool("move"), tool("rule_out"), undo);
  return element("div", { class: "split" }, element("div", { class: "tooled" }, tools, picture), element("div", { class: "side" }, element("h1", {}, say("review_title")), button,
    maySteer() ? "" : element("p", { class: "note" }, whyNot()), toldPlace(),
    // What was ruled out once and is not now, or a mistaken person, is seen before anybody begins.
    ...alerts.map((note) => element("p", { class: "dropped", role: "alert" }, saySentence(note))),
    element("div", { class: "card" }, element("h2", {}, `${say("acupoints")} · ${say("uncertainty")}`), element("div", { class: "scroll", tabindex: "0" },
      table(page.points.map((point) => [point.name, `${point.uncertainty_mm.toFixed(0)} mm`,
        element("div", { class: "row" }, moveKeys(point, scene, !maySteer(), tell),
          element("button", { "aria-label": `${say("rule_out_here")} ${point.name}`, disabled: !maySteer(), onclick: () => ruleOut(point.name, circleAround(point, 0.03)) }, say("rule_out_here")))])))),
    element("div", { class: "card" }, element("h2", {}, `${say("paths")} · ${Math.round(page.plan?.duration_s ?? 0)} s`), element("div", { class: "scroll", tabindex: "0" },
      table((page.plan?.paths ?? []).map((path) => [sayPath(path.name), say(path.arm), say(path.zone), `${path.ordered_n.toFixed(0)} N`])))),
    element("div", { class: "card" }, element("h2", {}, say("notes")), ...notes.filter((note) => !alerts.includes(note)).map((note) => element("p", { class: "note" }, saySentence(note))))));
}
