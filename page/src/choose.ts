// SPDX-License-Identifier: Apache-2.0
import { element, pills, table } from "./element";
import { lookBack } from "./look_back";
import { ofWhom, remembered, remembersAll } from "./remembered";
import { type Devices, main, maySteer, page, read, steer, toldPlace, whyNot } from "./shown";
import { reportOf, say, sayOr } from "./words";

interface Listed { session: string; person: string; programme: string; duration_s: number; performed: number; paths: number; stops: number }

const order: Record<string, string | number> =
  { person: "phantom:medium", position: "sitting", programme: "relax", intensity: 3, seed: 1, answered_by: "" };
let answers: Record<string, string> = {};

/** Nobody's answers stand for somebody else, or for another day. */
export function forgetAnswers(): void {
  answers = {};
  order["answered_by"] = "";
}

/** Which arms are driven, and before whom. */
function driven(devices: Devices): HTMLElement {
  return element("div", { class: "wide", id: "devices" }, element("span", { class: "over" }, say("devices")), element("b", {}, devices.named),
    element("p", { class: "note" }, devices.person === null ? say("own_scanner")
      : `${say("before_whom")} ${say(devices.person)} · ${say(devices.position)} · ${say("seed")} ${devices.seed}`));
}

export function choose(): HTMLElement {
  const devices = page.choices.devices;
  const pick = (key: string) => (value: string) => {
    order[key] = key === "intensity" ? Number(value) : value;
    if (key === "person" || key === "position") forgetAnswers();
    if (key === "position") page.render();
  };
  const seed = element("input", { id: "seed", type: "number", min: "1", max: String(page.choices.max_seed), value: String(order["seed"]), "aria-describedby": "seed_help" });
  seed.oninput = () => { order["seed"] = Math.min(page.choices.max_seed, Math.max(1, Math.round(Number(seed.value)) || 1)); };
  const sessions = element("div", { class: "sessions" }, say("no_sessions"));
  void read<Listed[]>("/api/sessions").then((all) => {
    if (all?.length) sessions.replaceChildren(table(all.map((one) => [one.session, `${one.person && say(one.person) + " · "}${say(one.programme)}`,
      `${Math.round(one.duration_s)} s · ${one.performed}/${one.paths} ${say("paths_short")}${one.stops ? ` · ${say("ended_stopped")}` : ""}`,
      element("div", { class: "row" },
        element("button", { id: `play_${one.session}`, "aria-label": `${say("look_back")} ${one.session}`, onclick: () => void lookBack(one.session) }, say("look_back")),
        element("a", { class: "button", href: reportOf(one.session), target: "_blank" }, say("report")))])));
  });
  return element("div", { class: "narrow" }, element("div", { class: "card" }, element("h1", {}, say("choose_title")),
    element("div", { class: "fields" },
      ...(devices ? [driven(devices)] : [pills("person", page.choices.people, String(order["person"]), pick("person")),
        pills("position", page.choices.positions, String(order["position"]), pick("position"))]),
      pills("programme", page.choices.programmes.map((one) => one.name), String(order["programme"]), pick("programme"),
        (name) => [element("b", {}, say(name)), element("small", {}, sayOr(`about_${name}`, page.choices.programmes.find((one) => one.name === name)!.description))]),
      pills("intensity", ["1", "2", "3", "4", "5"], String(order["intensity"]), pick("intensity"), (value) => [`${value} · ${say(`intensity_${value}`)}`]),
      devices ? "" : element("div", {}, element("label", { class: "over", for: "seed" }, say("seed")), seed, element("p", { class: "note", id: "seed_help" }, say("seed_help"))),
      remembered(devices?.position ?? String(order["position"]), forgetAnswers)),
    element("button", { class: "go", id: "next", disabled: !remembersAll(), onclick: () => { page.chosen = page.view = "health"; page.render(); main.focus({ preventScroll: true }); } }, say("on"))),
    element("h2", {}, say("sessions")), toldPlace(), element("div", { class: "card scroll-x" }, sessions));
}

/** Without what the devices decide. */
function ordered(): object {
  const { person, position, seed, ...asked } = order;
  return page.choices.devices ? asked : { person, position, seed, ...asked };
}

export function health(): HTMLElement {
  const go = element("button", { class: "go", id: "scan", onclick: () => { steer(); page.link.ask("start", { order: { ...ordered(), ...ofWhom(), answers } }); } }, say("scan_now"));
  const whole = (): void => { go.disabled = !maySteer() || !order["answered_by"] || page.choices.questions.some((one) => !answers[one.key]); };
  const name = element("input", { id: "answered_by", maxlength: "40", autocomplete: "off", value: String(order["answered_by"]) });
  name.oninput = () => { order["answered_by"] = name.value; whole(); };
  whole();
  return element("div", { class: "card narrow" }, element("h1", {}, say("health_title")), element("p", { class: "note" }, say("health_help")),
    ...page.choices.questions.map((one) => element("div", { class: "ask" }, element("span", { id: `q_${one.key}` }, say(`q_${one.key}`)),
      pills(`a_${one.key}`, ["no", "yes", "unknown"], answers[one.key] ?? "", (value) => { answers[one.key] = value; whole(); }, undefined, say(`q_${one.key}`)))),
    element("div", { class: "row" }, element("label", { for: "answered_by" }, say("answered_by")), name),
    element("div", { class: "row" }, element("button", { onclick: () => { page.chosen = page.view = "choose"; page.render(); } }, say("back")), go,
      maySteer() ? "" : element("span", { class: "note" }, whyNot())), toldPlace());
}
