// SPDX-License-Identifier: Apache-2.0
import en from "../messages/en.json";
import zh from "../messages/zh-Hant.json";
import { techniqueColours } from "./techniques";

export type Word = keyof typeof en;
const languages = { en, "zh-Hant": zh } as const;
let language: keyof typeof languages =
  (localStorage.getItem("language") ?? navigator.language).startsWith("zh") ? "zh-Hant" : "en";

const inEnglish = (): boolean => language === "en";

/** The report of a session. English is what the session leaves; another language is asked of the server. */
export const reportOf = (session: string): string => `/sessions/${session}/report.html${inEnglish() ? "" : `?language=${language}`}`;

/** A moment of UTC, where and as the reader lives. */
export const dayAndTime = (utc: string): string => new Date(utc).toLocaleString(language, { dateStyle: "medium", timeStyle: "short" });

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

/** A sentence of the server: whole in English, and its key with what stands in it. */
export interface Said { words: string; key: string; values: string[] }

/** In the language that was chosen. */
export function saySentence(said: Said): string {
  const words: Record<string, string> = languages[language];
  return words[said.key]?.replace(/\{(\d)\}/g, (_, i: string) => sayPath(said.values[Number(i)] ?? "")) ?? said.words;
}

/** The words of a key, with what stands in them. */
export const sayWith = (key: Word, ...values: (string | number)[]): string => saySentence({ words: "", key, values: values.map(String) });

export const sayLines = (lines: Said[][]): string => lines.map((line) => line.map(saySentence).join("")).join("\n");

/** What is said in English alone, or in another language what this key says in its place. */
export const sayInstead = (english: string, key: Word): string => (inEnglish() ? english : say(key));

/** A name in the language chosen; of a path its technique, then places. */
export function sayPath(name: string): string {
  if (say(name) !== name) return say(name);
  const [technique, ...places] = name.split(" ");
  if (!Object.hasOwn(techniqueColours, technique!)) return name;
  return [say(technique!), ...places.map((place) => (place === "to" ? say(place) : place))].join(" ");
}

export function applyLanguage(): void {
  document.documentElement.lang = language;
}

export function changeLanguage(): void {
  language = language === "en" ? "zh-Hant" : "en";
  localStorage.setItem("language", language);
  applyLanguage();
}
