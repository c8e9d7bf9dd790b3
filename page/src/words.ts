// SPDX-License-Identifier: Apache-2.0
import en from "../messages/en.json";
import zh from "../messages/zh-Hant.json";

export type Word = keyof typeof en;
const languages = { en, "zh-Hant": zh } as const;
let language: keyof typeof languages =
  (localStorage.getItem("language") ?? navigator.language).startsWith("zh") ? "zh-Hant" : "en";

/** The word in the language that was chosen; what has no translation stands as it is. */
export function say(word: string): string {
  const words: Record<string, string> = languages[language];
  return words[word] ?? word;
}

/** The words of a key that only some languages need; the others have them from elsewhere. */
export function sayOr(word: string, otherwise: string): string {
  const words: Record<string, string> = languages[language];
  return words[word] ?? otherwise;
}

/** A path's name in the language chosen: its technique, then places. */
export function sayPath(name: string): string {
  const [technique, ...places] = name.split(" ");
  return [say(technique!), ...places].join(" ");
}

export function applyLanguage(): void {
  document.documentElement.lang = language;
}

export function changeLanguage(): void {
  language = language === "en" ? "zh-Hant" : "en";
  localStorage.setItem("language", language);
  applyLanguage();
}
