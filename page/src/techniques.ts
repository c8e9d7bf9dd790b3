// SPDX-License-Identifier: Apache-2.0
/** What tools do on the skin, each with its colour in every picture; the server says it. */
export const techniqueColours: Record<string, string> = {};

export function learnTechniques(all: { name: string; colour: string }[]): void {
  for (const one of all) techniqueColours[one.name] = one.colour;
}
