// SPDX-License-Identifier: Apache-2.0
import { element } from "./element";
import { page } from "./shown";
import { say } from "./words";

const dialog = element("dialog", { class: "card", "aria-labelledby": "invite_title" });

/** Asks what the guest may do; the address comes as the server's answer. */
export function openInvitation(): void {
  const as = (ask: string): HTMLElement => element("button", { id: ask, onclick: () => page.link.ask(ask) }, say(ask));
  dialog.replaceChildren(element("h2", { id: "invite_title" }, say("invite_title")), element("p", { class: "note" }, say("invite_help")),
    element("div", { class: "row" }, as("invite"), as("invite_operator")), element("div", { id: "invited", role: "status" }),
    element("div", { class: "row" }, element("button", { id: "close_invitation", onclick: () => dialog.close() }, say("close"))));
  document.body.append(dialog);
  dialog.show();  // beside STOP, never before it
}

/** The address, to be copied or read aloud. */
export function showInvitation(address: string): void {
  const field = element("input", { id: "invited_address", readonly: true, value: address, "aria-label": say("invited") });
  field.onfocus = () => field.select();
  const copy = element("button", { id: "copy_invitation", onclick: () => void navigator.clipboard.writeText(address).then(() => { copy.textContent = say("copied"); }) }, say("copy"));
  document.getElementById("invited")?.replaceChildren(element("div", { class: "row address" }, field, copy));
}
