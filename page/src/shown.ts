// SPDX-License-Identifier: Apache-2.0
import { element } from "./element";
import { Forces } from "./forces";
import { type Happening } from "./happening";
import { type Link, type Live, type State, type Trouble } from "./link";
import { type Player } from "./player";
import { type Plan, type Recording } from "./recording";
import { type Acupoint } from "./picture/marks";
import { type Edit, Scene } from "./picture/scene";
import { say } from "./words";

export interface Choices { people: string[]; positions: string[]; programmes: { name: string; description: string }[]; techniques: { name: string; colour: string }[]; questions: { key: string }[]; zones: { name: string; cap_n: number }[]; max_seed: number; max_name_letters: number; keeps_people: boolean; devices: Devices | null }
/** Arms that the server drives, and who is before them; nothing of it is chosen here. */
export interface Devices { named: string; person: string | null; position: string; seed: number }
export type View = "choose" | "health" | "scan" | "review" | "massage" | "report" | "play";
/** What is ruled out and what was moved by hand. */
export interface ByHand { no_go: { name: string; corners: [number, number, number][] }[]; fixed: { name: string; at: [number, number, number] }[] }

/** Words that are said anew when another language is chosen. */
export type Words = () => string;

/** What has come from the server, by the numbers of the state that it was asked for. */
interface Seen {
  session: string; cloud: number; backs: number; plans: number; events: number; reviews: number; phase: string;
}
/** Another object each time: what is on its way for the one before is not taken. */
export const nothingSeen = (session: string): Seen =>
  ({ session, cloud: 0, backs: 0, plans: 0, events: 0, reviews: -1, phase: "" });

interface Shown {
  link: Link; render(): void; choices: Choices; state?: State; live?: Live | undefined; plan?: Plan | undefined;
  points: Acupoint[]; happened: Happening[]; view: View; chosen: "choose" | "health";
  /** The session whose report was left; whether this page has been in control; what has been fetched. */
  left: string; steered: boolean; zonesShown: boolean; seen: Seen;
  /** What the plan that stands was made with, and what was asked for since. */
  wanted: ByHand; editing: Edit; reviewsBefore: number;
  recording?: Recording | undefined; player?: Player | undefined;
  /** What was said last where it was asked for, in this view. */
  told: Words;
  /** What keeps the page from its server; nothing while it hears and is heard. */
  troubles: Trouble[];
  /** What is drawn anew within a view, by its name. */
  forces: Forces[]; slots: Record<string, HTMLElement>;
}

/** What the page knows and shows; every view is made of it. `main` gives it its connection and its way to draw. */
export const page = {
  points: [], happened: [], view: "choose", chosen: "choose", left: "", steered: false, zonesShown: false,
  seen: nothingSeen(""), wanted: { no_go: [], fixed: [] },
  editing: "turn", reviewsBefore: -1, told: () => "", troubles: [], forces: [], slots: {},
} as unknown as Shown;

export const main = document.getElementById("main")!;
export const scene = new Scene(say("view_label"), say("no_picture"));
const hangsMs = 10_000;
/** Nothing where it cannot be had now. */
export async function bytes(path: string): Promise<ArrayBuffer | undefined> {
  try {
    const reply = await fetch(path, { signal: AbortSignal.timeout(hangsMs) });
    return reply.ok ? await reply.arrayBuffer() : undefined;
  } catch {
    return undefined;
  }
}
export async function read<T>(path: string): Promise<T | undefined> {
  const text = await bytes(path);
  return text && (JSON.parse(new TextDecoder().decode(text)) as T);
}
let spoken: Words = () => "";
/** To who does not see the page. */
export function speak(words: Words): void {
  spoken = words;
  document.getElementById("spoken")!.textContent = words();
}
export const speakAgain = (): void => speak(spoken);

/** Says something where it was asked for, aloud too. */
export function tell(words: Words): void {
  speak(words);
  tellSilently(words);
}
export function tellSilently(words: Words): void {
  page.told = words;
  const place = document.getElementById("refusal");
  if (place) place.textContent = words();
}
/** Where that stands. It stays when the view is drawn anew, which anybody's doing may cause, until the next view. */
export const toldPlace = (): HTMLElement => element("p", { id: "refusal", class: "note", role: "alert" }, page.told());

export const ask = (what: string) => () => page.link.ask(what);
/** Whether this page steers, or may begin to by the next thing it asks. */
export const maySteer = (): boolean => !!page.state && !page.state.viewer && (page.state.operator || !page.state.operated);
/** Why it may not. */
export const whyNot = (): string =>
  say(page.state?.viewer ? "watch_only" : page.state?.operated ? "not_you" : "nobody_operates");
export function steer(): void { if (!page.state?.operator) page.link.ask("operate"); }
/** Its button asks twice, by touch and by click, which does no harm: where one of both is lost, STOP is not. */
export const stop = (): void => page.link.stop();

export function viewOf(now: State): View {
  // A session that runs is what everybody sees: who looks back is called to it.
  if (page.recording && ["idle", "ended"].includes(now.phase)) return "play";
  switch (now.phase) {
    case "scan": case "map": case "plan": return "scan";
    case "review": return "review";
    case "massage": case "report": return "massage";
    case "ended": return now.session === page.left ? page.chosen : "report";
    default: return page.chosen;
  }
}
