// SPDX-License-Identifier: Apache-2.0
import { element } from "./element";
import { type Done, type Recording } from "./recording";
import { armColours } from "./picture/scene";
import { say, sayPath, saySentence } from "./words";

const speeds = [1, 2, 3, 5, 10];
/** What an arrow key or a button goes by. */
const stepS = 5;
const columns = 500;

/** Whole seconds are rounded, as in the report. */
export function clock(timeS: number): string {
  const whole = Math.round(Math.max(0, timeS));
  return `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, "0")}`;
}

function drawn(name: string, given: Record<string, string | number>): SVGElement {
  const made = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(given)) made.setAttribute(key, String(value));
  return made;
}

/** Both forces over the whole session, the left arm upwards and the right one downwards, and what happened. */
function overview(recording: Recording): SVGElement {
  const made = drawn("svg", { viewBox: `0 -50 ${columns} 100`, preserveAspectRatio: "none", role: "img", "aria-label": say("overview") });
  const column = (timeS: number): number => Math.min(columns - 1, Math.floor((columns * timeS) / Math.max(recording.durationS, 0.1)));
  const felt = [0, 1].map(() => new Array<number>(columns).fill(0));
  for (const row of recording.told.forces)
    felt.forEach((most, arm) => { const at = column(row[0]!); most[at] = Math.max(most[at]!, row[2 + 2 * arm]!); });
  const highest = Math.max(10, ...felt.flat());
  felt.forEach((most, arm) => {
    const side = arm === 0 ? -1 : 1;
    const places = most.map((force, at) => `${at},${((side * 46 * force) / highest).toFixed(1)}`).join(" ");
    made.append(drawn("polygon", { points: `0,0 ${places} ${columns},0`, fill: armColours[arm]!, opacity: 0.75 }));
  });
  for (const one of recording.told.events.filter((event) => event.what === "stop" || event.what === "command"))
    made.append(drawn("line", { x1: column(one.time_s), x2: column(one.time_s), y1: -50, y2: 50, class: one.what, "vector-effect": "non-scaling-stroke" }));
  return made;
}

/** The picture's slider and buttons, and the list of what was performed; `moved` is told when another moment is wanted. */
export class Player {
  readonly controls: HTMLElement;
  readonly performed: HTMLElement;
  private readonly slider: HTMLInputElement;
  private readonly button: HTMLButtonElement;
  private readonly time = element("b", { class: "time" });
  private readonly cursor = element("i", {});
  private readonly rows: HTMLElement[];

  constructor(private readonly recording: Recording, private readonly moved: () => void) {
    this.slider = element("input", { id: "when", type: "range", min: "0", max: recording.durationS.toFixed(1), step: "0.1", "aria-label": say("time") });
    this.slider.oninput = () => this.seek(Number(this.slider.value));
    this.button = element("button", { class: "go", id: "play", onclick: () => this.toggle() });
    const speed = element("select", { id: "speed", "aria-label": say("speed") }, ...speeds.map((one) => element("option", { value: String(one) }, `${one} ×`)));
    speed.value = String(recording.speed);
    speed.onchange = () => { recording.speed = Number(speed.value); };
    const by = (id: string, seconds: number): HTMLElement => element("button", { id, title: say(id), onclick: () => this.seek(recording.nowS + seconds) }, `${seconds < 0 ? "−" : "+"}${stepS} s`);
    this.controls = element("div", { class: "player" },
      element("div", { class: "strip" }, overview(recording) as unknown as HTMLElement, this.cursor), this.slider,
      element("div", { class: "row" }, this.button, by("earlier", -stepS), by("later", stepS), speed, this.time), element("p", { class: "note" }, say("play_keys")));
    this.rows = recording.told.performed.map((done) => this.row(done));
    this.performed = element("div", { class: "scroll performed", tabindex: "0" },
      this.rows.length ? element("table", {}, element("tbody", {}, ...this.rows)) : element("p", { class: "note" }, say("nothing_yet")));
    this.show();
  }

  private row(done: Done): HTMLElement {
    const name = sayPath(this.recording.told.plan.paths[done.path]!.name);
    const why = [done.lowered_by ? `${say("lowered")} (${done.programme_n!.toFixed(0)} N): ${saySentence(done.lowered_by)}` : "", saySentence(done.why)].filter(Boolean);
    const whole = this.recording.told.events.some((one) => one.what === "ended" && one.path === done.path && one.time_s === done.end_s && one.whole);
    return element("tr", {}, element("td", {}, element("button", { "aria-label": `${say("go_to")} ${name}, ${clock(done.begin_s)}`, onclick: () => this.seek(done.begin_s) }, clock(done.begin_s))),
      element("td", {}, element("b", {}, name), ` · ${say(done.arm)}${whole ? "" : ` · ${say("cut_short")}`}`, ...why.map((one) => element("small", {}, one))),
      element("td", {}, `${done.given_n.toFixed(1)} / ${done.ordered_n.toFixed(1)} N`));
  }

  seek(timeS: number): void {
    this.recording.seek(timeS);
    this.moved();
  }

  toggle(): void {
    const { recording } = this;
    recording.plays = !recording.plays;
    if (recording.plays && recording.nowS === recording.durationS) recording.seek(0);
    this.moved();
  }

  /** The keys of who looks back; false where another key was pressed. */
  key(key: string): boolean {
    const { nowS, durationS } = this.recording;
    const places: Record<string, number> = { ArrowLeft: nowS - stepS, ArrowRight: nowS + stepS, Home: 0, End: durationS };
    if (key === " ") this.toggle();
    else if (key in places) this.seek(places[key]!);
    else return false;
    return true;
  }

  /** The moment of the recording. */
  show(): void {
    const { nowS, durationS, plays, told } = this.recording, words = `${clock(nowS)} / ${clock(durationS)}`;
    this.slider.value = String(nowS);
    this.slider.setAttribute("aria-valuetext", words);
    if (this.time.textContent !== words) this.time.textContent = words;
    this.cursor.style.left = `${(100 * nowS) / Math.max(durationS, 0.1)}%`;
    const label = say(plays ? "play_pause" : "play_on");
    if (this.button.textContent !== label) this.button.textContent = label;
    told.performed.forEach((done, i) => this.rows[i]!.classList.toggle("now", done.begin_s <= nowS && nowS <= done.end_s));
  }
}
