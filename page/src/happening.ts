// SPDX-License-Identifier: Apache-2.0
import { type Path, type Place } from "./picture/marks";
import { type Said, say, sayPath, saySentence } from "./words";

/** What happened in a massage, as /api/events tells it: `name` of a command, or of the path that it happened to; `at_m`
 * is where that begins. A path's index is of the plan of that moment. */
export interface Happening {
  what: "ended" | "decision" | "command" | "stop"; time_s: number; path: number; whole: boolean;
  stiffness_n_per_mm?: number; reason: Said; name?: string; at_m?: Place; from_n: number; to_n: number;
}

/** From soft (0) to stiff (1), on a scale of ratios: backs are felt from 0.3 to 5 N/mm. */
export function stiffnessShare(stiffness_n_per_mm: number): number {
  return Math.min(1, Math.max(0, Math.log(stiffness_n_per_mm / 0.3) / Math.log(5 / 0.3)));
}

/** Where something was felt; `paths` are asked where the happening itself says nothing of it. */
export const placeOf = (one: Happening, paths: Path[]): Place | undefined => one.at_m ?? paths[one.path]?.places[0];

/** One line for people. */
export function wordsOf(one: Happening, paths: Path[]): string {
  const path = sayPath(one.name ?? paths[one.path]?.name ?? "");
  switch (one.what) {
    case "ended": return `${path}: ${one.whole ? say("served") : say("cut_short")}${one.stiffness_n_per_mm ? ` · ${one.stiffness_n_per_mm.toFixed(2)} N/mm` : ""}`;
    case "decision": return `${path}: ${one.from_n.toFixed(0)} → ${one.to_n.toFixed(0)} N, ${saySentence(one.reason)}`;
    case "command": return say(one.name!);
    case "stop": return saySentence(one.reason);
  }
}
