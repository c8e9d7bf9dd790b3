// SPDX-License-Identifier: Apache-2.0
import { circleAround } from "./circle";
import { element, table } from "./element";
import { moveKeys } from "./move_keys";
import { zoneColours } from "./picture/back_shape";
import { type Acupoint } from "./picture/marks";
import { type Edit } from "./picture/scene";
import { maySteer, page, scene, steer, tell, toldPlace, whyNot } from "./shown";
import { dot, stage } from "./stage";
import { techniqueColours } from "./techniques";
import { say, sayLines, sayPath, saySentence } from "./words";

/** Asks for another plan, with what is ruled out and what was moved. */
function change(): void {
  steer();
  page.told = "";
  page.reviewsBefore = page.state!.reviews;
  scene.showRuledOut(page.wanted.no_go.map((area) => area.corners));
  page.link.ask("change", { order: page.wanted });
  showPlanning();
}

scene.onMoved = (name, at) => { page.wanted.fixed = [...page.wanted.fixed.filter((one) => one.name !== name), { name, at }]; change(); };
scene.onRuledOut = (corners) => { page.wanted.no_go.push({ name: `area ${page.wanted.no_go.length + 1}`, corners }); change(); };

/** The place around an acupoint, for hands that do not draw. */
function ruleOutAround(point: Acupoint): void {
  page.wanted.no_go.push({ name: point.name, corners: circleAround(point, 0.03) });
  change();
}

/** Nobody arms a plan that the page does not show: another one is being made, or is on its way. */
const mayArm = (): boolean => maySteer() && page.state!.reviews !== page.reviewsBefore &&
  page.seen.reviews === page.state!.reviews && page.seen.plans === page.state!.plans;

/** While another plan is made nothing can be armed; what could not be done is said. */
export function showPlanning(): void {
  const planning = page.state!.reviews === page.reviewsBefore;
  const arm = document.getElementById("arm") as HTMLButtonElement | null, place = document.getElementById("refusal");
  if (arm) arm.disabled = !mayArm();
  if (!place || page.view !== "review") return;
  place.textContent = planning ? say("planning_anew") : page.told || (page.state!.said.length ? `${say("refused")} ${sayLines(page.state!.said)}` : "");
}

export function review(): HTMLElement {
  const hold = element("button", { class: "go hold", id: "arm", disabled: !mayArm() }, element("span", {}, say("arm")));
  let timer = 0;
  const down = (): void => {
    if (timer || hold.disabled) return;
    steer();
    page.link.ask("hold");
    hold.classList.add("down");
    hold.firstElementChild!.textContent = say("arming");
    timer = window.setTimeout(() => page.link.ask("arm"), 2150);
  };
  const up = (): void => { clearTimeout(timer); timer = 0; hold.classList.remove("down"); hold.firstElementChild!.textContent = say("arm"); };
  hold.onpointerdown = down;
  hold.onpointerup = hold.onpointerleave = hold.onpointercancel = hold.onblur = up;
  hold.onkeydown = (event) => { if (event.key === " " || event.key === "Enter") { event.preventDefault(); event.stopPropagation(); down(); } };
  hold.onkeyup = up;
  const zones = element("button", { "aria-pressed": String(page.zonesShown), onclick: () => { page.zonesShown = !page.zonesShown; scene.colour(page.zonesShown); page.render(); } }, say("zones"));
  const tool = (how: Edit): HTMLElement => element("button", { id: how, "aria-pressed": String(page.editing === how), disabled: !maySteer(),
    onclick: () => { page.editing = page.editing === how ? "turn" : how; scene.edit(page.editing); page.render(); } }, say(how));
  const undo = element("button", { id: "undo", disabled: !maySteer() || page.wanted.no_go.length + page.wanted.fixed.length === 0,
    onclick: () => { page.wanted = { no_go: [], fixed: [] }; change(); } }, say("undo"));
  const picture = stage();
  picture.append(element("div", { class: "legend" }, ...(page.zonesShown
    ? page.choices.zones.map((zone, i) => dot(zoneColours[i]!, `${say(zone.name)} ${zone.cap_n} N`))
    : Object.entries(techniqueColours).filter(([name]) => page.plan?.paths.some((path) => path.technique === name)).map(([name, colour]) => dot(colour, say(name))))));
  const notes = page.plan?.notes ?? [], alerts = notes.filter((note) => ["note_said_dropped", "note_somebody_else"].includes(note.key));
  // Beside the picture, since on a phone they would cover the neck.
  const tools = element("div", { class: "row" }, zones, tool("move"), tool("rule_out"), undo);
  return element("div", { class: "split" }, element("div", { class: "tooled" }, tools, picture), element("div", { class: "side" }, element("h1", {}, say("review_title")), hold,
    maySteer() ? "" : element("p", { class: "note" }, whyNot()), toldPlace(),
    // What was ruled out once and is not now, or a mistaken person, is seen before anybody begins.
    ...alerts.map((note) => element("p", { class: "dropped", role: "alert" }, saySentence(note))),
    element("div", { class: "card" }, element("h2", {}, `${say("acupoints")} · ${say("uncertainty")}`), element("div", { class: "scroll", tabindex: "0" },
      table(page.points.map((point) => [point.name, `${point.uncertainty_mm.toFixed(0)} mm`,
        element("div", { class: "row" }, moveKeys(point, scene, !maySteer(), tell),
          element("button", { "aria-label": `${say("rule_out_here")} ${point.name}`, disabled: !maySteer(), onclick: () => ruleOutAround(point) }, say("rule_out_here")))])))),
    element("div", { class: "card" }, element("h2", {}, `${say("paths")} · ${Math.round(page.plan?.duration_s ?? 0)} s`), element("div", { class: "scroll", tabindex: "0" },
      table((page.plan?.paths ?? []).map((path) => [sayPath(path.name), say(path.arm), say(path.zone), `${path.ordered_n.toFixed(0)} N`])))),
    element("div", { class: "card" }, element("h2", {}, say("notes")), ...notes.filter((note) => !alerts.includes(note)).map((note) => element("p", { class: "note" }, saySentence(note))))));
}
