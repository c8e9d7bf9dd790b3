// SPDX-License-Identifier: Apache-2.0
import { element } from "./element";
import { openInvitation } from "./invite";
import { ask, page, speakAgain, type View } from "./shown";
import { changeLanguage, say } from "./words";

export function showTop(): void {
  const steps: View[] = ["choose", "health", "scan", "review", "massage", "report"];
  const cut = page.troubles.length > 0, keep = document.activeElement?.id;
  const who = cut ? "not_connected" : page.state?.viewer ? "you_watch" : page.state?.operator ? "you_operate" : page.state?.operated ? "somebody_operates" : "nobody_operates";
  document.getElementById("top")!.replaceChildren(
    element("div", { class: "name" }, element("img", { src: "/icon.svg", alt: "" }), "tuina"),
    element("ol", { class: "steps" }, ...steps.map((step) =>
      element("li", step === (page.view === "play" ? "report" : page.view) ? { "aria-current": "step" } : {}, say(`step_${step}`)))),
    element("div", { class: "tools" }, element("span", {}, say(who)),
      ...(page.state?.viewer ? [] : [page.state?.operator ? element("button", { id: "hand_over", disabled: cut, onclick: () => { page.steered = false; page.link.ask("hand_over"); } }, say("hand_over"))
        : element("button", { id: "take", onclick: ask("operate"), disabled: cut || page.state?.operated }, say("take")),
        element("button", { id: "open_invitation", disabled: cut, onclick: openInvitation }, say("open_invitation"))]),
      page.state?.password ? element("button", { id: "leave_server", disabled: cut, onclick: leaveServer }, say("log_out")) : "",
      element("button", { id: "language", onclick: () => { changeLanguage(); showTop(); speakAgain(); page.render(); } }, say("language")),
      element("button", { id: "theme", onclick: changeTheme, "aria-label": say("theme"), title: say("theme") }, "◐")));
  if (keep) document.getElementById(keep)?.focus();
  document.getElementById("foot")!.textContent = page.state?.audit_fails ? say("unsafe_log") : `${say(page.choices?.devices?.person === null ? "own_devices" : "simulated")} ${page.choices?.devices?.named ?? ""} ${paceWords()}`;
}

function leaveServer(): void {
  void fetch("/logout", { method: "POST" }).finally(() => location.assign("/"));
}

function paceWords(): string {
  if (!page.state || page.state.pace === 1) return "";
  return page.state.pace === null ? say("pace_max") : `${say("pace")} ${page.state.pace} ×`;
}

function changeTheme(): void {
  const dark = document.documentElement.dataset["theme"] === "dark" ||
    (!document.documentElement.dataset["theme"] && matchMedia("(prefers-color-scheme: dark)").matches);
  document.documentElement.dataset["theme"] = dark ? "light" : "dark";
  localStorage.setItem("theme", dark ? "light" : "dark");
}

export function applyTheme(): void {
  const theme = localStorage.getItem("theme");
  if (theme) document.documentElement.dataset["theme"] = theme;
}
