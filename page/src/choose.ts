// SPDX-License-Identifier: Apache-2.0
import { element, pills, table } from "./element";
import { lookBack } from "./look_back";
import { ofWhom, remembered, remembersAll } from "./remembered";
import { type Devices, main, maySteer, page, read, steer, toldPlace, whyNot } from "./shown";
import { dayAndTime, reportOf, say, sayOr, sayWith } from "./words";

interface Listed { session: string; ended: string; who?: string; person: string; programme: string; duration_s: number; performed: number; paths: number; stops: number }

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
  const next = element("button", { class: "go", id: "next", onclick: () => { page.chosen = page.view = "health"; page.render(); main.focus({ preventScroll: true }); } }, say("on"));
  const seed = element("input", { id: "seed", type: "number", min: "1", max: String(page.choices.max_seed), required: true, value: String(order["seed"]), "aria-describedby": "seed_help" });
  const seedHelp = element("p", { class: "note", id: "seed_help", role: "status" });
  seed.oninput = () => { if (seed.validity.valid) order["seed"] = Number(seed.value); whole(); };
  const whole = (): void => {
    const fault = !devices && !seed.validity.valid;
    seed.setAttribute("aria-invalid", String(fault));
    seedHelp.textContent = fault ? sayWith("seed_wrong", page.choices.max_seed) : say("seed_help");
    next.disabled = fault || !remembersAll();
  };
  whole();
  const sessions = element("div", { class: "sessions" }, say("no_sessions"));
  void read<{ sessions: Listed[]; count: number }>("/api/sessions").then((all) => {
    if (!all?.sessions.length) return;
    const rest = all.count > all.sessions.length
      ? [element("p", { class: "note", id: "shown_of" }, sayWith("shown_of", all.sessions.length, all.count))] : [];
    sessions.replaceChildren(...rest, table(all.sessions.map((one) => [element("span", {}, one.session, element("small", {}, dayAndTime(one.ended))),
      [one.who, one.person && say(one.person), say(one.programme)].filter(Boolean).join(" · "),
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
      devices ? "" : element("div", {}, element("label", { class: "over", for: "seed" }, say("seed")), seed, seedHelp),
      remembered(devices?.position ?? String(order["position"]), forgetAnswers)),
    next),
    element("h2", {}, say("sessions")), toldPlace(), element("div", { class: "card scroll-x" }, sessions));
}

/** Without what the devices decide. */
function ordered(): object {
  const { person, position, seed, ...asked } = order;
  return page.choices.devices ? asked : { person, position, seed, ...asked };
}

export function health(): HTMLElement {
  const go = element("button", { class: "go", id: "scan", onclick: () => { steer(); page.link.ask("start", { order: { ...ordered(), ...ofWhom(), answers } }); } }, say("scan_now"));
  const name = element("input", { id: "answered_by", autocomplete: "off", value: String(order["answered_by"]), "aria-describedby": "why_no_scan" });
  const why = element("span", { class: "note", id: "why_no_scan", role: "status" });
  name.oninput = () => { order["answered_by"] = name.value.trim(); whole(); };
  const whole = (): void => {
    const all = page.choices.questions.map((one) => answers[one.key]), against = all.some((one) => one === "yes" || one === "unknown");
    const long = [...String(order["answered_by"])].length > page.choices.max_name_letters;
    why.textContent = against ? say("no_massage") : long ? sayWith("name_long", page.choices.max_name_letters) : "";
    name.setAttribute("aria-invalid", String(long));
    go.disabled = !maySteer() || !order["answered_by"] || long || all.some((one) => one !== "no");
  };
  whole();
  return element("div", { class: "card narrow" }, element("h1", {}, say("health_title")), element("p", { class: "note" }, say("health_help")),
    ...page.choices.questions.map((one) => element("div", { class: "ask" }, element("span", { id: `q_${one.key}` }, say(`q_${one.key}`)),
      pills(`a_${one.key}`, ["no", "yes", "unknown"], answers[one.key] ?? "", (value) => { answers[one.key] = value; whole(); }, undefined, say(`q_${one.key}`)))),
    element("div", { class: "row" }, element("label", { for: "answered_by" }, say("answered_by")), name),
    element("div", { class: "row" }, element("button", { onclick: () => { page.chosen = page.view = "choose"; page.render(); } }, say("back")), go,
      why, maySteer() ? "" : element("span", { class: "note" }, whyNot())), toldPlace());
}
