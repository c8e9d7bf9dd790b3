// SPDX-License-Identifier: Apache-2.0
import "./page.css";
import { element, pills, table } from "./element";
import { circleAround } from "./circle";
import { Forces, shownS } from "./forces";
import { type Happening, stiffnessShare, wordsOf } from "./happening";
import { Link, type Live, type Reply, type State } from "./link";
import { moveKeys } from "./move_keys";
import { Player } from "./player";
import { type Plan, Recording } from "./recording";
import { type Acupoint, armColours, type Edit, Scene, techniqueColours, zoneColours } from "./scene";
import { applyLanguage, changeLanguage, say, sayOr, sayPath } from "./words";

interface Choices { people: string[]; positions: string[]; programmes: { name: string; description: string }[]; questions: { key: string }[]; zones: { name: string; cap_n: number }[]; max_seed: number }
interface Listed { session: string; person: string; programme: string; duration_s: number; performed: number; paths: number; stops: number }
type View = "choose" | "health" | "scan" | "review" | "massage" | "report" | "play";

const order: Record<string, string | number> =
  { person: "phantom:medium", position: "sitting", programme: "relax", intensity: 3, seed: 1, answered_by: "" };
const answers: Record<string, string> = {};
let choices: Choices, state: State | undefined, live: Live | undefined, plan: Plan | undefined, points: Acupoint[] = [], happened: Happening[] = [];
let view: View = "choose", chosen: "choose" | "health" = "choose", left = "", steered = false, zonesShown = false, operateMs = 0;
let seen = { session: "", cloud: 0, backs: 0, plans: 0, events: 0, phase: "" };
let wanted: { no_go: { name: string; corners: [number, number, number][] }[]; fixed: { name: string; at: [number, number, number] }[] } = { no_go: [], fixed: [] };
let kept = wanted;
let editing: Edit = "turn", reviewsBefore = -1;
let recording: Recording | undefined, player: Player | undefined;
let forces: Forces[] = [], slots: Record<string, HTMLElement> = {};
const main = document.getElementById("main")!;
const scene = new Scene(say("view_label"), say("no_picture"));
const read = async <T>(path: string): Promise<T> => (await fetch(path)).json() as Promise<T>;
const bytes = async (path: string): Promise<ArrayBuffer> => (await fetch(path)).arrayBuffer();
const speak = (words: string): void => { document.getElementById("spoken")!.textContent = words; };

const link = new Link({
  state: (now) => void heard(now),
  live: (now) => { live = now; showLive(); },
  reply: answered,
  lost: (lost) => {
    const banner = document.getElementById("lost")!;
    banner.hidden = !lost;
    banner.textContent = lost ? say("lost") : "";
    if (lost) seen = { ...seen, phase: "" };
  },
});

function viewOf(now: State): View {
  // A session that runs is what everybody sees: who looks back is called to it.
  if (recording && ["idle", "ended"].includes(now.phase)) return "play";
  switch (now.phase) {
    case "scan": case "map": case "plan": return "scan";
    case "review": return "review";
    case "massage": case "report": return "massage";
    case "ended": return now.session === left ? chosen : "report";
    default: return chosen;
  }
}

async function heard(now: State): Promise<void> {
  const before = state;
  state = now;
  // After a lost connection; once a second is enough.
  if (steered && !now.operated && performance.now() - operateMs > 1000) {
    operateMs = performance.now();
    link.ask("operate");
  }
  if (now.operator) steered = true;
  if (recording && !["idle", "ended"].includes(now.phase)) forgetRecording();
  if (now.session !== seen.session) {
    seen = { session: now.session, cloud: 0, backs: 0, plans: 0, events: 0, phase: seen.phase };
    scene.clear();
    plan = live = undefined;
    points = [];
    happened = [];
    wanted = { no_go: [], fixed: [] };
    editing = "turn";
    reviewsBefore = -1;
    forces = [];
  }
  const next = viewOf(now);
  if (next !== view || seen.phase === "") { view = next; render(); }
  if (now.phase !== seen.phase) {
    seen.phase = now.phase;
    speak(now.phase === "ended" ? say(`ended_${now.outcome}`) : say(`step_${next}`));
    render();
  }
  if (before?.operator !== now.operator || before?.operated !== now.operated) { showTop(); if (view !== "choose" && view !== "health") render(); }
  if (before?.paused !== now.paused) { render(); if (view === "massage") speak(say(now.paused ? "paused_title" : "massage_title")); }
  showProgress();
  if (view === "review") {
    if (before?.reviews !== now.reviews && now.reviews > reviewsBefore && now.words) {
      // What could not be done is taken back, so that the next change does not ask for it again.
      wanted = structuredClone(kept);
      scene.showRuledOut(wanted.no_go.map((area) => area.corners));
      scene.showAcupoints(points);
    } else if (now.reviews > reviewsBefore) kept = structuredClone(wanted);
    showPlanning();
  }
  await fetchNew(now);
}

async function fetchNew(now: State): Promise<void> {
  if (now.phase === "scan" && now.cloud_points > seen.cloud) {
    seen.cloud = now.cloud_points;
    scene.showCloud(new Float32Array(await bytes("/api/cloud")));
  }
  if (now.backs > seen.backs) {
    seen.backs = now.backs;
    scene.showBack(await bytes("/api/back"));
    points = (await read<{ acupoints: Acupoint[] }>("/api/map")).acupoints;
    scene.showAcupoints(points);
    render();
  }
  if (now.plans > seen.plans) {
    seen.plans = now.plans;
    plan = await read<Plan>("/api/plan");
    scene.showPaths(plan.paths);
    render();
  }
  if (now.events > seen.events) {
    seen.events = now.events;
    happened = await read<Happening[]>("/api/events");
    showHappened();
  }
}

function answered(reply: Reply): void {
  if (reply.address) { say("invited"); prompt(say("invited"), reply.address); }
  else if (reply.outcome !== "done" && reply.ask !== "operate") tell(`${say("refused")} ${reply.outcome}`);
}

/** Says something where it was asked for, aloud too. */
function tell(words: string): void {
  speak(words);
  const place = document.getElementById("refusal");
  if (place) place.textContent = words;
}

/** Opens a finished session; why it cannot be opened is said where it was asked for. */
async function lookBack(session: string): Promise<void> {
  const place = document.getElementById("refusal");
  if (place) place.textContent = say("reading");
  try {
    recording = await Recording.open(session);
  } catch (fault) {
    return tell(`${say("refused")} ${(fault as Error).message}`);
  }
  if (!state!.ordered) left = state!.session;
  scene.clear();
  forces = [];
  ({ plan, map: { acupoints: points } } = recording.told);
  scene.showBack(recording.back);
  scene.showAcupoints(points);
  scene.showPaths(plan.paths);
  view = viewOf(state!);
  render();
  main.focus();
}

function forgetRecording(): void {
  recording = player = live = plan = undefined;
  points = [];
  happened = [];
  forces = [];
  scene.clear();
}

/** The moment of the recording that is looked at. */
function showMoment(): void {
  if (!recording || !player) return;
  live = recording.live();
  const before = happened.length;
  happened = recording.happened();
  if (happened.length !== before) showHappened();
  showLive();
  const rows = recording.forces(shownS);
  forces.forEach((plot, i) => plot.show(rows.map((row) => row[0]!), rows.map((row) => row[1 + 2 * i]!), rows.map((row) => row[2 + 2 * i]!)));
  player.show();
}

const momentEveryMs = 40;
let momentMs = 0;
function play(nowMs: number): void {
  requestAnimationFrame(play);
  const passedMs = nowMs - momentMs;
  if (passedMs < momentEveryMs) return;
  momentMs = nowMs;
  if (!recording?.plays) return;
  // A page that was hidden goes on where it was.
  recording.pass(Math.min(passedMs, 250) / 1000);
  showMoment();
}
requestAnimationFrame(play);

const ask = (what: string) => () => link.ask(what);
/** Whether this page steers, or may begin to by the next thing it asks. */
const maySteer = (): boolean => !!state && (state.operator || !state.operated);
function steer(): void { if (!state?.operator) link.ask("operate"); }
function stop(): void { link.ask("stop"); speak(say("stop_asked")); }

/** Asks for another plan, with what is ruled out and what was moved. */
function change(): void {
  steer();
  reviewsBefore = state!.reviews;
  scene.showRuledOut(wanted.no_go.map((area) => area.corners));
  link.ask("change", wanted);
  showPlanning();
}
scene.onMoved = (name, at) => { wanted.fixed = [...wanted.fixed.filter((one) => one.name !== name), { name, at }]; change(); };
scene.onRuledOut = (corners) => { wanted.no_go.push({ name: `area ${wanted.no_go.length + 1}`, corners }); change(); };

/** The place around an acupoint, for hands that do not draw. */
function ruleOutAround(point: Acupoint): void {
  wanted.no_go.push({ name: point.name, corners: circleAround(point, 0.03) });
  change();
}

/** While another plan is made nothing can be armed; what could not be done is said. */
function showPlanning(): void {
  const planning = state!.reviews === reviewsBefore;
  const arm = document.getElementById("arm") as HTMLButtonElement | null, place = document.getElementById("refusal");
  if (arm) arm.disabled = planning || !maySteer();
  if (place && view === "review") place.textContent = planning ? say("planning_anew") : state!.words ? `${say("refused")} ${state!.words}` : "";
}

function showTop(): void {
  const steps: View[] = ["choose", "health", "scan", "review", "massage", "report"];
  const who = state?.operator ? "you_operate" : state?.operated ? "somebody_operates" : "nobody_operates";
  document.getElementById("top")!.replaceChildren(
    element("div", { class: "name" }, element("img", { src: "/icon.svg", alt: "" }), "tuina"),
    element("ol", { class: "steps" }, ...steps.map((step) =>
      element("li", step === (view === "play" ? "report" : view) ? { "aria-current": "step" } : {}, say(`step_${step}`)))),
    element("div", { class: "tools" }, element("span", {}, say(who)),
      state?.operator ? element("button", { onclick: () => { steered = false; link.ask("hand_over"); } }, say("hand_over"))
        : element("button", { onclick: ask("operate"), disabled: state?.operated }, say("take")),
      element("button", { onclick: ask("invite") }, say("invite")),
      state?.password ? element("button", { id: "leave_server", onclick: leaveServer }, say("log_out")) : "",
      element("button", { id: "language", onclick: () => { changeLanguage(); showTop(); render(); } }, say("language")),
      element("button", { onclick: changeTheme, "aria-label": say("theme"), title: say("theme") }, "◐")));
  document.getElementById("foot")!.textContent = state?.audit_fails ? say("unsafe_log") : `${say("simulated")} ${paceWords()}`;
}

function leaveServer(): void {
  void fetch("/logout", { method: "POST" }).finally(() => location.assign("/"));
}

function paceWords(): string {
  if (!state || state.pace === 1) return "";
  return state.pace === null ? say("pace_max") : `${say("pace")} ${state.pace} ×`;
}

function changeTheme(): void {
  const dark = document.documentElement.dataset["theme"] === "dark" ||
    (!document.documentElement.dataset["theme"] && matchMedia("(prefers-color-scheme: dark)").matches);
  document.documentElement.dataset["theme"] = dark ? "light" : "dark";
  localStorage.setItem("theme", dark ? "light" : "dark");
}

// A button that is replaced between touch and click would never hear of it; on a busy machine the click of a finger comes
// long after its release, and of a drag none comes.
let pressing = false, drawsLater = false, released = 0;
const drawNow = (): void => { pressing = false; if (drawsLater) render(); };
const drawIn = (ms: number): void => { clearTimeout(released); released = window.setTimeout(drawNow, ms); };
addEventListener("pointerdown", () => { clearTimeout(released); pressing = true; }, true);
addEventListener("pointerup", () => drawIn(400), true);
for (const end of ["click", "pointercancel"]) addEventListener(end, () => drawIn(0), true);

function render(): void {
  if (!choices || !state) return;
  drawsLater = pressing;
  if (pressing) return;
  showTop();
  const makers: Record<View, () => HTMLElement> =
    { choose: choose, health: health, scan: scan, review: review, massage: massage, report: report, play: lookedBack };
  slots = {};
  const keep = document.activeElement?.id;
  main.replaceChildren(makers[view]());
  const runs = !["idle", "ended"].includes(state.phase);
  document.getElementById("stop-bar")!.replaceChildren(...(runs
    ? [element("span", {}, say(state.phase === "massage" && state.paused ? "paused_title" : `step_${view}`)),
      element("button", { class: "stop", id: "stop", onpointerdown: stop, onclick: stop }, say("stop"), element("small", {}, say("stop_help")))] : []));
  if (keep) document.getElementById(keep)?.focus();
  showProgress();
  showLive();
  showHappened();
  showMoment();
}

function choose(): HTMLElement {
  const pick = (key: string) => (value: string) => { order[key] = key === "intensity" ? Number(value) : value; };
  const seed = element("input", { id: "seed", type: "number", min: "1", max: String(choices.max_seed), value: String(order["seed"]), "aria-describedby": "seed_help" });
  seed.oninput = () => { order["seed"] = Math.min(choices.max_seed, Math.max(1, Math.round(Number(seed.value)) || 1)); };
  const sessions = element("div", { class: "sessions" }, say("no_sessions"));
  void read<Listed[]>("/api/sessions").then((all) => {
    if (all.length) sessions.replaceChildren(table(all.map((one) => [one.session, say(one.person), say(one.programme),
      `${Math.round(one.duration_s)} s`, `${one.performed}/${one.paths} ${say("paths_short")}${one.stops ? `, ${one.stops} ${say("stops_short")}` : ""}`,
      element("div", { class: "row" },
        element("button", { id: `play_${one.session}`, "aria-label": `${say("look_back")} ${one.session}`, onclick: () => void lookBack(one.session) }, say("look_back")),
        element("a", { class: "button", href: `/sessions/${one.session}/report.html`, target: "_blank" }, say("report")))])));
  });
  return element("div", { class: "narrow" }, element("div", { class: "card" }, element("h1", {}, say("choose_title")),
    element("div", { class: "fields" },
      pills("person", choices.people, String(order["person"]), pick("person")),
      pills("position", choices.positions, String(order["position"]), pick("position")),
      pills("programme", choices.programmes.map((one) => one.name), String(order["programme"]), pick("programme"),
        (name) => [element("b", {}, say(name)), element("small", {}, sayOr(`about_${name}`, choices.programmes.find((one) => one.name === name)!.description))]),
      pills("intensity", ["1", "2", "3", "4", "5"], String(order["intensity"]), pick("intensity"), (value) => [`${value} · ${say(`intensity_${value}`)}`]),
      element("div", {}, element("label", { class: "over", for: "seed" }, say("seed")), seed, element("p", { class: "note", id: "seed_help" }, say("seed_help")))),
    element("button", { class: "go", id: "next", onclick: () => { chosen = view = "health"; render(); main.focus(); } }, say("on"))),
    element("h2", {}, say("sessions")), element("p", { id: "refusal", class: "note", role: "alert" }), element("div", { class: "card scroll-x" }, sessions));
}

function health(): HTMLElement {
  const go = element("button", { class: "go", id: "scan", onclick: () => { steer(); link.ask("start", { ...order, answers }); } }, say("scan_now"));
  const whole = (): void => { go.disabled = !maySteer() || !order["answered_by"] || choices.questions.some((one) => !answers[one.key]); };
  const name = element("input", { id: "answered_by", maxlength: "40", autocomplete: "off", value: String(order["answered_by"]) });
  name.oninput = () => { order["answered_by"] = name.value; whole(); };
  whole();
  return element("div", { class: "card narrow" }, element("h1", {}, say("health_title")), element("p", { class: "note" }, say("health_help")),
    ...choices.questions.map((one) => element("div", { class: "ask" }, element("span", { id: `q_${one.key}` }, say(`q_${one.key}`)),
      pills(`a_${one.key}`, ["no", "yes", "unknown"], answers[one.key] ?? "", (value) => { answers[one.key] = value; whole(); }, undefined, say(`q_${one.key}`)))),
    element("div", { class: "row" }, element("label", { for: "answered_by" }, say("answered_by")), name),
    element("div", { class: "row" }, element("button", { onclick: () => { chosen = view = "choose"; render(); } }, say("back")), go,
      maySteer() ? "" : element("span", { class: "note" }, say("not_you"))), element("p", { id: "refusal", class: "note", role: "alert" }));
}

function stage(...over: (HTMLElement | string)[]): HTMLElement {
  return element("div", { class: "view" }, scene.canvas, element("div", { class: "over-view" }, ...over));
}

function scan(): HTMLElement {
  slots["title"] = element("h1", {});
  slots["points"] = element("span", { class: "note" });
  slots["bar"] = element("i", {});
  return element("div", {}, slots["title"], element("div", { class: "bar" }, slots["bar"]), stage(slots["points"]));
}

function review(): HTMLElement {
  const hold = element("button", { class: "go hold", id: "arm", disabled: !maySteer() }, element("span", {}, say("arm")));
  let timer = 0;
  const down = (): void => {
    if (timer || hold.disabled) return;
    steer();
    link.ask("hold");
    hold.classList.add("down");
    hold.firstElementChild!.textContent = say("arming");
    timer = window.setTimeout(() => link.ask("arm"), 2150);
  };
  const up = (): void => { clearTimeout(timer); timer = 0; hold.classList.remove("down"); hold.firstElementChild!.textContent = say("arm"); };
  hold.onpointerdown = down;
  hold.onpointerup = hold.onpointerleave = hold.onpointercancel = hold.onblur = up;
  hold.onkeydown = (event) => { if (event.key === " " || event.key === "Enter") { event.preventDefault(); event.stopPropagation(); down(); } };
  hold.onkeyup = up;
  const zones = element("button", { "aria-pressed": String(zonesShown), onclick: () => { zonesShown = !zonesShown; scene.colour(zonesShown); render(); } }, say("zones"));
  const tool = (how: Edit): HTMLElement => element("button", { id: how, "aria-pressed": String(editing === how), disabled: !maySteer(),
    onclick: () => { editing = editing === how ? "turn" : how; scene.edit(editing); render(); } }, say(how));
  const undo = element("button", { id: "undo", disabled: !maySteer() || wanted.no_go.length + wanted.fixed.length === 0,
    onclick: () => { wanted = { no_go: [], fixed: [] }; change(); } }, say("undo"));
  const picture = stage();
  picture.append(element("div", { class: "legend" }, ...(zonesShown
    ? choices.zones.map((zone, i) => dot(zoneColours[i]!, `${say(zone.name)} ${zone.cap_n} N`))
    : Object.entries(techniqueColours).filter(([name]) => plan?.paths.some((path) => path.technique === name)).map(([name, colour]) => dot(colour, say(name))))));
  // Beside the picture, since on a phone they would cover the neck.
  const tools = element("div", { class: "row" }, zones, tool("move"), tool("rule_out"), undo);
  return element("div", { class: "split" }, element("div", { class: "tooled" }, tools, picture), element("div", { class: "side" }, element("h1", {}, say("review_title")), hold,
    maySteer() ? "" : element("p", { class: "note" }, say("not_you")), element("p", { id: "refusal", class: "note", role: "alert" }),
    element("div", { class: "card" }, element("h2", {}, say("acupoints")), element("div", { class: "scroll", tabindex: "0" },
      table(points.map((point) => [point.name, `${say("uncertainty")} ${point.uncertainty_mm.toFixed(0)} mm`,
        element("div", { class: "row" }, moveKeys(point, scene, !maySteer(), tell),
          element("button", { "aria-label": `${say("rule_out_here")} ${point.name}`, disabled: !maySteer(), onclick: () => ruleOutAround(point) }, say("rule_out_here")))])))),
    element("div", { class: "card" }, element("h2", {}, `${say("paths")} · ${Math.round(plan?.duration_s ?? 0)} s`), element("div", { class: "scroll", tabindex: "0" },
      table((plan?.paths ?? []).map((path) => [sayPath(path.name), say(path.arm), say(path.zone), `${path.ordered_n.toFixed(0)} N`])))),
    element("div", { class: "card" }, element("h2", {}, say("notes")), ...(plan?.notes ?? []).map((note) => element("p", { class: "note" }, note)))));
}

function dot(colour: string, words: string): HTMLElement {
  const mark = element("i", {});
  mark.style.background = colour;
  return element("span", {}, mark, words);
}

/** What each arm does, and its force asked for and felt. */
function armCards(): HTMLElement[] {
  const arms = [0, 1].map((arm) => {
    const now = (slots[`force${arm}`] = element("b", {}, "0.0 N")), what = (slots[`what${arm}`] = element("span", {}));
    const place = (slots[`plot${arm}`] ??= element("div", { role: "img", "aria-label": say("force_label") }));
    return element("div", { class: "card" }, element("div", { class: "force" }, dot(armColours[arm]!, say(arm ? "right" : "left")), what, now), place);
  });
  forces = [0, 1].map((arm) => { const kept = forces[arm]; const plot = new Forces(slots[`plot${arm}`]!, arm); if (kept) plot.take(kept); return plot; });
  return arms;
}

function massage(): HTMLElement {
  const paused = state!.paused, steers = state!.operator;
  slots["when"] = element("span", { class: "note" });
  slots["next"] = element("div", {});
  slots["happened"] = element("div", { class: "scroll log", tabindex: "0" });
  slots["softest"] = element("div", { class: "legend" }, dot("#2f9e8f", say("soft")), dot("#8b1e5b", say("stiff")));
  slots["bar"] = element("i", {});
  const arms = armCards();
  const key = (what: string): HTMLElement => element("button", { id: what, onclick: ask(what), disabled: !steers }, say(what));
  const title = state!.phase === "report" ? "writing" : paused ? "paused_title" : "massage_title";
  const picture = stage(element("h1", {}, say(title)), slots["when"]);
  picture.append(slots["softest"]);
  return element("div", { class: "split" }, picture,
    element("div", { class: "side" }, element("div", { class: "bar" }, slots["bar"]),
      element("div", { class: "keys" }, ...[paused ? "resume" : "pause", "softer", "firmer", "skip", "repeat"].map(key)),
      element("p", { class: "note" }, steers ? say("keys") : say("not_you")), element("p", { id: "refusal", class: "note", role: "alert" }),
      ...arms, element("div", { class: "card" }, element("h2", {}, say("next")), slots["next"]),
      element("div", { class: "card" }, element("h2", {}, say("happened")), slots["happened"])));
}

/** A finished session, at a moment of it. */
function lookedBack(): HTMLElement {
  const { session, told } = recording!;
  player = new Player(recording!, showMoment);
  slots["happened"] = element("div", { class: "scroll log", tabindex: "0" });
  slots["softest"] = element("div", { class: "legend" }, dot("#2f9e8f", say("soft")), dot("#8b1e5b", say("stiff")));
  const picture = stage();
  // Above the picture, since on a phone they would cover the neck.
  const head = element("div", { class: "row head" }, element("h1", {}, `${say("session")} ${session} · ${say(told.programme)}`),
    element("button", { id: "leave", onclick: () => { forgetRecording(); chosen = "choose"; view = viewOf(state!); render(); main.focus(); } }, say(state!.ordered ? "back" : "all_sessions")),
      element("a", { class: "button", href: `/sessions/${session}/report.html`, target: "_blank" }, say("report")));
  picture.append(slots["softest"]);
  return element("div", { class: "split" },
    element("div", { class: "played" }, head, picture, player.controls),
    element("div", { class: "side" },
      told.lost.length ? element("div", { class: "card" }, element("h2", {}, say("damaged")), ...told.lost.map((one) => element("p", { class: "note" }, one))) : "",
      ...armCards(), element("div", { class: "card" }, element("h2", {}, say("performed")), element("p", { class: "note" }, say("given_ordered")), player.performed),
      element("div", { class: "card" }, element("h2", {}, say("happened")), slots["happened"])));
}

function report(): HTMLElement {
  const made = state!.recorded;
  const at = `/sessions/${state!.session}/report.html`;
  return element("div", { class: "narrow" }, element("h1", {}, say(`ended_${state!.outcome}`)),
    element("div", { class: "row" }, state!.ordered ? "" : element("button", { class: "go", id: "another", onclick: () => { left = state!.session; chosen = view = "choose"; render(); } }, say("another")),
      made ? element("button", { id: "look_back", onclick: () => void lookBack(state!.session) }, say("look_back")) : "",
      made ? element("a", { class: "button", href: at, target: "_blank" }, say("open_report")) : ""), element("p", { id: "refusal", class: "note", role: "alert" }),
    made ? element("iframe", { src: at, title: say("report"), sandbox: "" }) : "",
    element("details", made ? {} : { open: "" }, element("summary", {}, say("details")), element("pre", {}, state!.words)));
}

function showProgress(): void {
  if (!state) return;
  if (slots["bar"]) slots["bar"].style.width = `${100 * (view === "scan" && state.phase !== "scan" ? 1 : state.progress)}%`;
  if (slots["points"]) slots["points"].textContent = `${state.cloud_points.toLocaleString()} ${say("points")}`;
  if (slots["title"]) slots["title"].textContent = say(state.phase === "map" ? "mapping" : state.phase === "plan" ? "planning" : "scan_title");
}

function showLive(): void {
  if (!live) return;
  live.arms.forEach((arm, i) => {
    scene.moveArm(i, arm.links);
    const path = plan?.paths[arm.path];
    if (slots[`force${i}`]) slots[`force${i}`]!.textContent = `${Math.max(0, arm.felt_n).toFixed(1)} N`;
    if (slots[`what${i}`]) slots[`what${i}`]!.textContent = `${path ? `${sayPath(path.name)} · ` : ""}${say(arm.phase === "stopped" ? "stopped_arm" : arm.phase)}`;
    if (live!.forces.length) forces[i]?.add(live!.forces.map((row) => row[0]!), live!.forces.map((row) => row[1 + 2 * i]!), live!.forces.map((row) => row[2 + 2 * i]!));
  });
  live.forces = [];
  if (!plan) return;
  const step = Math.max(...live.arms.map((arm) => plan!.paths[arm.path]?.step ?? -1));
  const next = plan.paths.filter((path) => path.step > step).slice(0, 4);
  slots["next"]?.replaceChildren(table(next.map((path) => [sayPath(path.name), say(path.arm), `${path.ordered_n.toFixed(0)} N`])));
  const rest = Math.max(0, Math.round(plan.duration_s - live.time_s));
  if (slots["when"]) slots["when"].textContent = `${live.performed}/${plan.paths.length} ${say("done_paths")} · ${say("remaining")} ${Math.floor(rest / 60)}:${String(rest % 60).padStart(2, "0")} ${say("remaining_end")}`;
}

function showHappened(): void {
  scene.showFelt(happened.flatMap((one) => {
    const at = one.stiffness_n_per_mm && plan?.paths[one.path]?.places[0];
    return at ? [{ at, stiffness: stiffnessShare(one.stiffness_n_per_mm!) }] : [];
  }));
  const list = happened.slice(-40).reverse().map((one) => [`${one.time_s.toFixed(0)} s`, wordsOf(one, sayPath(plan?.paths[one.path]?.name ?? ""))]);
  slots["happened"]?.replaceChildren(list.length ? table(list) : element("p", { class: "note" }, say("nothing_yet")));
  if (slots["softest"]) slots["softest"].hidden = !happened.some((one) => one.stiffness_n_per_mm);
}

addEventListener("keydown", (event) => {
  if (event.key === "Escape") return stop();
  if (view === "play" && player && !event.ctrlKey && !event.metaKey && !event.altKey) {
    // Space presses the button that has the focus, and arrows choose in a list.
    const pressed = (event.target as Element).closest?.(event.key === " " ? "button, a, select" : "select");
    if (!pressed && player.key(event.key)) event.preventDefault();
    return;
  }
  const typing = event.target instanceof HTMLInputElement;
  if (view !== "massage" || typing || event.ctrlKey || event.metaKey || event.altKey || event.repeat) return;
  const keys: Record<string, string> = { " ": state?.paused ? "resume" : "pause", "-": "softer", "+": "firmer", n: "skip", r: "repeat" };
  const what = keys[event.key];
  if (what) { event.preventDefault(); link.ask(what); }
});

const theme = localStorage.getItem("theme");
if (theme) document.documentElement.dataset["theme"] = theme;
applyLanguage();
showTop();
void read<Choices>("/api/choices").then((all) => { choices = all; render(); });
