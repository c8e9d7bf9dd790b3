// SPDX-License-Identifier: Apache-2.0
import { element } from "./element";
import { lookBack } from "./look_back";
import { page, toldPlace } from "./shown";
import { stage } from "./stage";
import { reportOf, say, sayLines } from "./words";

export function scan(): HTMLElement {
  page.slots["title"] = element("h1", {});
  page.slots["points"] = element("span", { class: "note" });
  page.slots["bar"] = element("i", {});
  return element("div", { class: "tooled" }, page.slots["title"], element("div", { class: "bar" }, page.slots["bar"]), stage(page.slots["points"]));
}

export function report(): HTMLElement {
  const made = page.state!.recorded;
  const at = reportOf(page.state!.session);
  return element("div", { class: "narrow" }, element("h1", {}, say(`ended_${page.state!.outcome}`)),
    element("div", { class: "row" }, page.state!.ordered ? "" : element("button", { class: "go", id: "another", onclick: () => { page.left = page.state!.session; page.chosen = page.view = "choose"; page.render(); } }, say("another")),
      made ? element("button", { id: "look_back", onclick: () => void lookBack(page.state!.session) }, say("look_back")) : "",
      made ? element("a", { class: "button", href: at, target: "_blank" }, say("open_report")) : ""), toldPlace(),
    made ? element("iframe", { src: at, title: say("report"), sandbox: "" }) : "",
    element("details", made ? {} : { open: "" }, element("summary", {}, say("details")), element("pre", { id: "said" }, sayLines(page.state!.said))));
}

export function showProgress(): void {
  if (!page.state) return;
  if (page.slots["bar"]) page.slots["bar"].style.width = `${100 * (page.view === "scan" && page.state.phase !== "scan" ? 1 : page.state.progress)}%`;
  if (page.slots["points"]) page.slots["points"].textContent = `${page.state.cloud_points.toLocaleString()} ${say("points")}`;
  if (page.slots["title"]) page.slots["title"].textContent = say(page.state.phase === "map" ? "mapping" : page.state.phase === "plan" ? "planning" : "scan_title");
}
