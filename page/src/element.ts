// SPDX-License-Identifier: Apache-2.0
import { say } from "./words";

type Given = Record<string, string | boolean | undefined | (() => void)>;
type Child = Node | string;

/** An element with attributes and children; text is never read as markup. */
export function element<Name extends keyof HTMLElementTagNameMap>(name: Name, given: Given, ...children: Child[]): HTMLElementTagNameMap[Name] {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(given)) {
    if (typeof value === "function") made.addEventListener(key.slice(2), value);
    else if (value === true) made.setAttribute(key, "");
    else if (typeof value === "string") made.setAttribute(key, value);
  }
  made.append(...children);
  return made;
}

/** One of several, as buttons in a row. */
export function pills(name: string, values: string[], value: string, pick: (value: string) => void,
  show: (value: string) => Child[] = (one) => [say(one)], legend?: string): HTMLFieldSetElement {
  const cards = name === "programme";
  return element("fieldset", cards ? { class: "wide" } : {}, element("legend", legend ? { class: "unseen" } : {}, legend ?? say(name)),
    element("div", { class: cards ? "pills programmes" : "pills" }, ...values.map((one) => {
      const input = element("input", { type: "radio", name, value: one, id: `${name}_${one}` });
      input.checked = one === value;
      input.onchange = () => pick(one);
      return element("label", {}, input, ...(cards ? [element("span", {}, ...show(one))] : show(one)));
    })));
}

export function table(rows: Child[][]): HTMLTableElement {
  return element("table", {}, element("tbody", {}, ...rows.map((row) => element("tr", {}, ...row.map((cell) => element("td", {}, cell))))));
}
