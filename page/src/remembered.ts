// SPDX-License-Identifier: Apache-2.0
import { element, pills } from "./element";
import { page } from "./shown";
import { type Said, say, saySentence } from "./words";

/** Somebody as their history knows them: what is remembered is used only where somebody says so. */
interface Found { sessions: number; items: { kind: string; said: Said }[]; changes: Said[] }

let people: string[] | undefined, reads = false, who = "", asked = "", found: Found | undefined, fault = "";
let use: Record<string, boolean> = {};

/** Once, by who may order a session; a viewer hears of nobody. */
async function readPeople(): Promise<void> {
  if (reads || !page.choices.keeps_people || page.state!.viewer) return;
  reads = true;
  const reply = await fetch("/api/people");
  if (!reply.ok) return;
  people = (await reply.json()) as string[];
  page.render();
}

async function find(position: string): Promise<void> {
  const now = `${position}/${who}`;
  if (now === asked) return;
  asked = now;
  found = undefined;
  use = {};
  fault = "";
  if (!who) return;
  const reply = await fetch(`/api/remembered/${position}/${encodeURIComponent(who)}`);
  if (asked !== now) return;
  if (reply.ok) found = (await reply.json()) as Found;
  else fault = say("who_refused");
  page.render();
}

/** Whether nobody is named, or everything that is remembered of them was answered. */
export const remembersAll = (): boolean => !who || (!!found && found.items.every((one) => one.kind in use));

/** The next session is of somebody else, until somebody says who it is. */
export function forgetWhom(): void {
  who = asked = fault = "";
  found = undefined;
  use = {};
  reads = false;
}

/** What of it goes with an order; before the next one it is looked up anew. */
export function ofWhom(): object {
  asked = "";
  return who ? { who, remember: use } : {};
}

/** A pseudonym, and below it what is remembered, each to be used or left; `changed` is told when it is another one. */
export function remembered(position: string, changed: () => void): HTMLElement | string {
  void readPeople();
  if (!people) return "";
  void find(position);
  const name = element("input", { id: "who", list: "people", maxlength: "40", autocomplete: "off", spellcheck: "false", value: who, "aria-describedby": "who_help" });
  name.onchange = () => { who = name.value.trim(); changed(); page.render(); };
  const told = found?.sessions ? `${say("who_known")} ${found.sessions}` : found ? say("who_new") : fault || say("who_help");
  return element("div", { class: "wide" }, element("label", { class: "over", for: "who" }, say("who")), name,
    element("datalist", { id: "people" }, ...people.map((one) => element("option", { value: one }))),
    element("p", { class: "note", id: "who_help", role: "status" }, told),
    ...(found?.changes ?? []).map((one) => element("p", { class: "note" }, saySentence(one))),
    ...(found?.items ?? []).map((one) => element("div", { class: "ask" }, element("span", {}, saySentence(one.said)),
      pills(`use_${one.kind}`, ["use_it", "leave_it"], one.kind in use ? (use[one.kind] ? "use_it" : "leave_it") : "",
        (value) => { use[one.kind] = value === "use_it"; page.render(); }, undefined, saySentence(one.said)))));
}
