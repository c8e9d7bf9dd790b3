// SPDX-License-Identifier: Apache-2.0
import { element, table } from "./element";
import { placeOf, stiffnessShare, wordsOf } from "./happening";
import { type Live } from "./link";
import { type Path } from "./picture/marks";
import { clock } from "./player";
import { type Plan } from "./recording";
import { ask, page, scene, toldPlace, whyNot } from "./shown";
import { armCards, dot, stage } from "./stage";
import { say, sayPath, type Word } from "./words";

export function massage(): HTMLElement {
  const paused = page.state!.paused, steers = page.state!.operator;
  page.slots["doing"] = element("h1", {});
  page.slots["when"] = element("span", { class: "note" });
  page.slots["next"] = element("div", {});
  page.slots["happened"] = element("div", { class: "scroll log", tabindex: "0" });
  page.slots["softest"] = element("div", { class: "legend" }, dot("#2f9e8f", say("soft")), dot("#8b1e5b", say("stiff")));
  page.slots["bar"] = element("i", {});
  const arms = armCards();
  const key = (what: string): HTMLElement => element("button", { id: what, onclick: ask(what), disabled: !steers }, say(what));
  const picture = stage(page.slots["doing"], page.slots["when"]);
  picture.append(page.slots["softest"]);
  return element("div", { class: "split" }, picture,
    element("div", { class: "side" }, element("div", { class: "bar" }, page.slots["bar"]),
      element("div", { class: "keys" }, ...[paused ? "resume" : "pause", "softer", "firmer", "skip", "repeat"].map(key)),
      element("p", { class: steers ? "note keyboard" : "note" }, steers ? say("keys") : whyNot()), toldPlace(),
      ...arms, element("div", { class: "card" }, element("h2", {}, say("next")), page.slots["next"]),
      element("div", { class: "card" }, element("h2", {}, say("happened")), page.slots["happened"])));
}

/** The step of the arm that is less far in the plan, and for how long nobody has paused it; of each arm the step that it
 * serves or served last. */
let reached: { plan?: Plan; step: number; forS: number; seenS: number; arms: number[] } = { step: -1, forS: 0, seenS: 0, arms: [] };

/** What the massage does now. An arm that is paused on its way touches nobody. */
export function doing(): Word {
  if (page.state?.phase === "report") return "writing";
  if (!page.state?.paused) return "massage_title";
  return page.live?.arms.some((arm) => arm.phase === "contact") ? "paused_title" : "paused";
}

/** Seconds that are ahead by the plan's own times: those of the robot count what was before this plan, too. */
function restOf(plan: Plan, live: Live): number {
  const steps = live.arms.flatMap((arm) => plan.paths[arm.path]?.step ?? []), seenS = live.time_s;
  // Between two paths an arm serves none.
  const step = steps.length ? Math.min(...steps) : plan === reached.plan ? reached.step : -1;
  if (plan !== reached.plan || step !== reached.step) reached = { plan, step, forS: 0, seenS, arms: plan === reached.plan ? reached.arms : [] };
  if (!page.state?.paused) reached.forS += seenS - reached.seenS;
  reached.seenS = seenS;
  const endS = (last: number): number =>
    Math.max(0, ...plan.paths.filter((path) => path.step <= last).map((path) => path.start_s + path.duration_s));
  // What takes longer than planned keeps what comes after it waiting.
  return plan.duration_s - Math.min(endS(reached.step), endS(reached.step - 1) + reached.forS);
}

/** The steps after those that both arms serve or have served. A page that was opened since knows by what has ended. */
function ahead(plan: Plan, live: Live): Path[] {
  const ended = page.happened.findLast((one) => one.what === "ended" && plan.paths[one.path]?.name === one.name);
  live.arms.forEach((arm, i) => { reached.arms[i] = plan.paths[arm.path]?.step ?? reached.arms[i] ?? -1; });
  const step = Math.max(...reached.arms);
  const served = step >= 0 || !ended ? step : plan.paths[ended.path]!.step;
  return plan.paths.filter((path) => path.step > served).slice(0, 4);
}

/** What a path is to be given by the wish of now. */
const wishedN = (path: Path, live: Live): number => Math.min(path.ordered_n * (live.intensity ?? 1), path.cap_n ?? Infinity);

/** What is done now, above the picture and beside STOP; of a connection that is lost nobody knows. */
export function showDoing(): void {
  if (page.slots["doing"]) page.slots["doing"].textContent = say(doing());
  const bar = document.getElementById("doing");
  if (bar) bar.textContent = say(page.troubles.length ? "not_connected" : page.view === "massage" ? doing() : `step_${page.view}`);
}

export function showLive(): void {
  showDoing();
  if (!page.live) return;
  page.live.arms.forEach((arm, i) => {
    scene.moveArm(i, arm.links);
    const path = page.plan?.paths[arm.path];
    if (page.slots[`force${i}`]) page.slots[`force${i}`]!.textContent = `${Math.max(0, arm.felt_n).toFixed(1)} N`;
    if (page.slots[`what${i}`]) page.slots[`what${i}`]!.textContent = `${path ? `${sayPath(path.name)} · ` : ""}${say(arm.phase === "stopped" ? "stopped_arm" : arm.phase)}`;
    if (page.live!.forces.length) page.forces[i]?.add(page.live!.forces.map((row) => row[0]!), page.live!.forces.map((row) => row[1 + 2 * i]!), page.live!.forces.map((row) => row[2 + 2 * i]!));
  });
  page.live.forces = [];
  if (!page.plan) return;
  const rest = restOf(page.plan, page.live);
  const { live } = page, next = ahead(page.plan, live);
  page.slots["next"]?.replaceChildren(table(next.map((path) => [sayPath(path.name), say(path.arm), `${wishedN(path, live).toFixed(0)} N`])));
  const done = `${page.live.performed}/${page.plan.paths.length} ${say("done_paths")}`;
  page.slots["when"]?.replaceChildren(`${done} · ${say("remaining")} ${clock(rest)} ${say("remaining_end")}`);
}

export function showHappened(): void {
  const paths = page.plan?.paths ?? [];
  scene.showFelt(page.happened.flatMap((one) => {
    const at = one.stiffness_n_per_mm && placeOf(one, paths);
    return at ? [{ at, stiffness: stiffnessShare(one.stiffness_n_per_mm!) }] : [];
  }));
  const list = page.happened.slice(-40).reverse().map((one) => [`${one.time_s.toFixed(0)} s`, wordsOf(one, paths)]);
  page.slots["happened"]?.replaceChildren(list.length ? table(list) : element("p", { class: "note" }, say("nothing_yet")));
  if (page.slots["softest"]) page.slots["softest"].hidden = !page.happened.some((one) => one.stiffness_n_per_mm);
}
