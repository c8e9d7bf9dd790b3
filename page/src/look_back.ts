// SPDX-License-Identifier: Apache-2.0
import { element } from "./element";
import { shownS } from "./forces";
import { showHappened, showLive } from "./massage";
import { Player } from "./player";
import { Recording } from "./recording";
import { main, page, scene, tell, viewOf } from "./shown";
import { armCards, dot, stage } from "./stage";
import { reportOf, say, sayInstead } from "./words";

/** Opens a finished session; why it cannot be opened is said where it was asked for. */
export async function lookBack(session: string): Promise<void> {
  tell(() => say("reading"));
  try {
    page.recording = await Recording.open(session);
  } catch (fault) {
    return tell(() => `${say("refused")} ${sayInstead((fault as Error).message, "record_unreadable")}`);
  }
  if (!page.state!.ordered) page.left = page.state!.session;
  scene.clear();
  page.forces = [];
  ({ plan: page.plan, map: { acupoints: page.points } } = page.recording.told);
  scene.showBack(page.recording.back);
  scene.showAcupoints(page.points);
  scene.showPaths(page.plan.paths);
  page.view = viewOf(page.state!);
  page.render();
  main.focus({ preventScroll: true });
}

export function forgetRecording(): void {
  page.recording = page.player = page.live = page.plan = undefined;
  page.points = [];
  page.happened = [];
  page.forces = [];
  scene.clear();
}

/** The moment of the recording that is looked at. */
export function showMoment(): void {
  if (!page.recording || !page.player) return;
  page.live = page.recording.live();
  const before = page.happened.length;
  page.happened = page.recording.happened();
  if (page.happened.length !== before) showHappened();
  showLive();
  const rows = page.recording.forces(shownS);
  page.forces.forEach((plot, i) => plot.show(rows.map((row) => row[0]!), rows.map((row) => row[1 + 2 * i]!), rows.map((row) => row[2 + 2 * i]!)));
  page.player.show();
}

const momentEveryMs = 40;
let momentMs = 0;

export function play(nowMs: number): void {
  requestAnimationFrame(play);
  const passedMs = nowMs - momentMs;
  if (passedMs < momentEveryMs) return;
  momentMs = nowMs;
  if (!page.recording?.plays) return;
  // A page that was hidden goes on where it was.
  page.recording.pass(Math.min(passedMs, 250) / 1000);
  showMoment();
}

/** A finished session, at a moment of it. */
export function lookedBack(): HTMLElement {
  const { session, told } = page.recording!;
  page.player = new Player(page.recording!, showMoment);
  page.slots["happened"] = element("div", { class: "scroll log", tabindex: "0" });
  page.slots["softest"] = element("div", { class: "legend" }, dot("#2f9e8f", say("soft")), dot("#8b1e5b", say("stiff")));
  const picture = stage();
  // Above the picture, since on a phone they would cover the neck.
  const head = element("div", { class: "row head" }, element("h1", {}, `${say("session")} ${session} · ${say(told.programme)}`),
    element("button", { id: "leave", onclick: () => { forgetRecording(); page.chosen = "choose"; page.view = viewOf(page.state!); page.render(); main.focus({ preventScroll: true }); } }, say(page.state!.ordered ? "back" : "all_sessions")),
      element("a", { class: "button", href: reportOf(session), target: "_blank" }, say("report")));
  picture.append(page.slots["softest"]);
  return element("div", { class: "split" },
    element("div", { class: "played" }, head, picture, page.player.controls),
    element("div", { class: "side" },
      told.lost.length ? element("div", { class: "card" }, element("h2", {}, say("damaged")), ...told.lost.map((one) => element("p", { class: "note" }, sayInstead(one, "record_gap")))) : "",
      ...armCards(), element("div", { class: "card" }, element("h2", {}, say("performed")), element("p", { class: "note" }, say("given_ordered")), page.player.performed),
      element("div", { class: "card" }, element("h2", {}, say("happened")), page.slots["happened"])));
}
