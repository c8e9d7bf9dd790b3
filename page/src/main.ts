// SPDX-License-Identifier: Apache-2.0
import "./page.css";
import { choose, forgetAnswers, health } from "./choose";
import { element } from "./element";
import { type Happening } from "./happening";
import { showInvitation } from "./invite";
import { Link, type Reply, type State } from "./link";
import { forgetRecording, lookedBack, play, showMoment } from "./look_back";
import { doing, massage, showDoing, showHappened, showLive } from "./massage";
import { type Plan } from "./recording";
import { review, showByHand, showPlanning } from "./review";
import { type Acupoint } from "./picture/marks";
import { forgetWhom } from "./remembered";
import { report, scan, showProgress } from "./session";
import { type ByHand, bytes, type Choices, main, nothingSeen, page, read, scene, speak, stop, tell, tellSilently, type View, viewOf } from "./shown";
import { learnTechniques } from "./techniques";
import { applyTheme, showTop } from "./top";
import { applyLanguage, say, saySentence } from "./words";

let operateMs = 0, drawn: View | undefined;

page.link = new Link({
  state: heard,
  live: (now) => { page.live = now; showLive(); },
  reply: answered,
  trouble: (troubles) => {
    page.troubles = troubles;
    showTop();
    showTrouble();
  },
  opened: () => {
    page.seen = nothingSeen(page.seen.session);
    page.reviewsBefore = -1;
  },
});
page.render = render;

function heard(now: State): void {
  const before = page.state;
  page.state = now;
  // After a lost connection; once a second is enough.
  if (page.steered && !now.operated && performance.now() - operateMs > 1000) {
    operateMs = performance.now();
    page.link.ask("operate");
  }
  if (now.operator) page.steered = true;
  if (page.recording && !["idle", "ended"].includes(now.phase)) forgetRecording();
  if (now.session !== page.seen.session) {
    page.seen = { ...nothingSeen(now.session), phase: page.seen.phase };
    forgetAnswers();
    forgetWhom();
    scene.clear();
    page.plan = page.live = undefined;
    page.points = [];
    page.happened = [];
    page.wanted = { no_go: [], fixed: [] };
    page.editing = "turn";
    page.reviewsBefore = -1;
    page.forces = [];
  }
  const next = viewOf(now), { phase } = page.seen;
  if (next !== page.view || now.phase !== phase) {
    // Whoever still holds the button that armed sees the arms move.
    if (next !== page.view || phase === "") pressing = false;
    page.view = next;
    render();
  }
  if (now.phase !== phase) {
    page.seen.phase = now.phase;
    speak(() => say(now.phase === "ended" ? `ended_${now.outcome}` : `step_${next}`));
  }
  if (before?.operator !== now.operator || before?.operated !== now.operated) { showTop(); if (!["choose", "health", "report"].includes(page.view)) render(); }
  if (before?.paused !== now.paused && page.view === "massage") {
    render();
    speak(() => say(doing()));
  }
  showProgress();
  if (page.view === "review") showPlanning();
  void fetchNew(now);
}

let fetching: typeof page.seen | undefined;

/** One after the other; what could not be had is asked for again at the next state. */
async function fetchNew(now: State): Promise<void> {
  const seen = page.seen;
  if (fetching === seen) return;
  fetching = seen;
  try { await takeNew(now, seen); } finally { if (fetching === seen) fetching = undefined; }
}

async function takeNew(now: State, seen: typeof page.seen): Promise<void> {
  const late = (): boolean => page.seen !== seen || !!page.recording;
  if (late()) return;
  if (now.phase === "scan" && now.cloud_points > seen.cloud) {
    const cloud = await bytes("/api/cloud");
    if (!cloud || late()) return;
    seen.cloud = now.cloud_points;
    scene.showCloud(new Float32Array(cloud));
  }
  if (now.backs > seen.backs) {
    const back = await bytes("/api/back"), map = await read<{ acupoints: Acupoint[] }>("/api/map");
    if (!back || !map || late()) return;
    seen.backs = now.backs;
    scene.showBack(back);
    page.points = map.acupoints;
    scene.showAcupoints(page.points);
    if (page.view === "review") render();
  }
  if (now.plans > seen.plans) {
    const plan = await read<Plan>("/api/plan");
    if (!plan || late()) return;
    seen.plans = now.plans;
    page.plan = plan;
    scene.showPaths(plan.paths);
    if (page.view === "review") render();
  }
  if (["review", "massage"].includes(now.phase) && now.reviews !== seen.reviews) {
    // Whoever has said it, before this page was opened, too; what could not be done is not among it.
    const byHand = await read<ByHand>("/api/by_hand");
    if (!byHand || late()) return;
    seen.reviews = now.reviews;
    page.wanted = byHand;
    showByHand();
    if (page.view === "review") render();
  }
  if (now.events > seen.events) {
    const happened = await read<Happening[]>("/api/events");
    if (!happened || late()) return;
    seen.events = now.events;
    page.happened = happened;
    showHappened();
  }
}

function answered(reply: Reply): void {
  if (reply.address) return showInvitation(reply.address);
  // Nobody has asked for a beat.
  if (reply.ask === "beat") return;
  if (reply.outcome === "done") {
    tellSilently(() => "");
    if (page.view === "review") showPlanning();
    return reply.ask === "stop" ? speak(() => say("stop_asked")) : undefined;
  }
  // That somebody else was first, everybody sees.
  if (reply.ask === "operate" && reply.outcome === "taken") return;
  tell(() => `${say("refused")} ${saySentence(reply.said)}`);
  if (reply.ask !== "change") return;
  // The plan stands, and what it was made with is drawn again.
  page.reviewsBefore = page.seen.reviews = -1;
  showPlanning();
}

let focused: Element | null = null;

/** What keeps the page from its server. Until it is heard again, what was heard last is grey and nothing but STOP can be
 * pressed; what has ended stays to be read. */
function showTrouble(): void {
  const banner = document.getElementById("lost")!, words = page.troubles.map((one) => say(one === "shut_out" && page.state?.password ? "logged_out" : one)).join(" ");
  banner.hidden = !words;
  if (banner.textContent !== words) banner.textContent = words;
  const cut = !!words && !["report", "play"].includes(page.view);
  if (cut && !main.inert) focused = document.activeElement;
  if (cut !== main.inert) {
    main.inert = cut;
    if (!cut && focused?.id && document.activeElement === document.body) document.getElementById(focused.id)?.focus();
  }
  showDoing();
}

// A button that is replaced between touch and click would never hear of it; on a busy machine the click of a finger comes
// long after its release, and of a drag none comes.
let pressing = false, drawsLater = false, released = 0;
const drawNow = (): void => { pressing = false; if (drawsLater) render(); };
const drawIn = (ms: number): void => { clearTimeout(released); released = window.setTimeout(drawNow, ms); };
addEventListener("pointerdown", () => { clearTimeout(released); pressing = true; }, true);
addEventListener("pointerup", () => drawIn(400), true);
for (const end of ["click", "pointercancel", "keyup"]) addEventListener(end, () => drawIn(0), true);
// Of the window alone: a button that loses the focus ends no press of another one.
addEventListener("blur", () => drawIn(0));
// So that a key, too, can hold what is held: whoever begins by it takes control, which is drawn.
addEventListener("keydown", (event) => { if ((event.target as Element).closest?.(".hold")) { clearTimeout(released); pressing = true; } }, true);

function render(): void {
  if (!page.choices || !page.state) return;
  drawsLater = pressing;
  if (pressing) return;
  showTop();
  const makers: Record<View, () => HTMLElement> =
    { choose: choose, health: health, scan: scan, review: review, massage: massage, report: report, play: lookedBack };
  page.slots = {};
  if (drawn !== page.view) page.told = () => "";
  const keep = document.activeElement?.id;
  main.replaceChildren(makers[page.view]());
  if (drawn !== page.view) scrollTo(0, 0);
  drawn = page.view;
  const runs = !["idle", "ended"].includes(page.state.phase);
  document.getElementById("stop-bar")!.replaceChildren(...(runs
    ? [element("span", { id: "doing" }),
      element("button", { class: "stop", id: "stop", onpointerdown: stop, onclick: stop }, say("stop"), element("small", {}, say("stop_help")))] : []));
  if (keep) document.getElementById(keep)?.focus();
  showTrouble();
  if (page.view === "review") showPlanning();
  showProgress();
  showLive();
  showHappened();
  showMoment();
}

addEventListener("keydown", (event) => {
  if (event.key === "Escape") return stop();
  if (main.inert) return;
  if (page.view === "play" && page.player && !event.ctrlKey && !event.metaKey && !event.altKey) {
    // Space presses the button that has the focus, and arrows choose in a list.
    const pressed = (event.target as Element).closest?.(event.key === " " ? "button, a, select" : "select");
    if (!pressed && page.player.key(event.key)) event.preventDefault();
    return;
  }
  const typing = event.target instanceof HTMLInputElement;
  if (page.view !== "massage" || typing || event.ctrlKey || event.metaKey || event.altKey || event.repeat) return;
  const keys: Record<string, string> = { " ": page.state?.paused ? "resume" : "pause", "-": "softer", "+": "firmer", n: "skip", r: "repeat" };
  const what = keys[event.key];
  if (what) { event.preventDefault(); page.link.ask(what); }
});

requestAnimationFrame(play);
applyTheme();
applyLanguage();
showTop();

async function readChoices(): Promise<void> {
  const all = await read<Choices>("/api/choices");
  if (!all) return void setTimeout(() => void readChoices(), 500);
  page.choices = all;
  learnTechniques(all.techniques);
  render();
}
void readChoices();
