// SPDX-License-Identifier: Apache-2.0
import { type Happening } from "./happening";
import { type ArmNow, type Live } from "./link";
import { type Acupoint, type Path } from "./picture/marks";
import { type Said } from "./words";

export interface Plan { duration_s: number; notes: Said[]; paths: Path[] }
/** A path as it was performed; `why` it was given otherwise than ordered, and what bears less than the programme wants. */
export interface Done { path: number; arm: string; begin_s: number; end_s: number; ordered_n: number; given_n: number; why: Said; programme_n?: number; lowered_by?: Said }
interface Told {
  duration_s: number; programme: string; lost: string[]; map: { acupoints: Acupoint[] }; plan: Plan; performed: Done[];
  events: Happening[]; forces: number[][]; frames: Live[];
}

const askAgainMs = 500, askAgain = 40;

function firstAfter(times: number[], timeS: number): number {
  let low = 0, high = times.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle]! <= timeS) low = middle + 1; else high = middle;
  }
  return low;
}

function between(from: ArmNow, to: ArmNow, share: number): ArmNow {
  if (from.links.length !== to.links.length) return from;
  const links = from.links.map((link, i) => link.map((value, k) => value + share * (to.links[i]![k]! - value)) as typeof link);
  return { ...from, links, felt_n: from.felt_n + share * (to.felt_n - from.felt_n) };
}

/** A finished session as the server reads it from its record, and the moment of it that is shown. */
export class Recording {
  nowS = 0;
  plays = false;
  speed = 1;
  readonly durationS: number;
  private readonly frameTimes: number[];
  private readonly forceTimes: number[];

  private constructor(readonly session: string, readonly back: ArrayBuffer, readonly told: Told) {
    this.frameTimes = told.frames.map((frame) => frame.time_s);
    this.forceTimes = told.forces.map((row) => row[0]!);
    this.durationS = Math.max(told.duration_s, this.frameTimes.at(-1) ?? 0);
  }

  /** Throws what the server says against it, in one line. */
  static async open(session: string): Promise<Recording> {
    for (let asked = 0; ; ++asked) {
      const reply = await fetch(`/sessions/${session}/play`);
      if (reply.ok) {
        const bytes = await reply.arrayBuffer(), size = new Uint32Array(bytes, 0, 1)[0]!;
        const told = JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 4 + size))) as Told;
        return new Recording(session, bytes.slice(4, 4 + size), told);
      }
      // The server reads one record at a time.
      if (reply.status !== 503 || asked === askAgain) throw new Error((await reply.text()).trim());
      await new Promise((resolve) => setTimeout(resolve, askAgainMs));
    }
  }

  seek(timeS: number): void {
    this.nowS = Math.min(this.durationS, Math.max(0, timeS));
  }

  /** So much time of the clock has passed; at the end it rests. */
  pass(clockS: number): void {
    this.seek(this.nowS + clockS * this.speed);
    if (this.nowS === this.durationS) this.plays = false;
  }

  /** Nothing before the first frame of the record. */
  live(): Live | undefined {
    const after = firstAfter(this.frameTimes, this.nowS), { frames } = this.told;
    const from = frames[Math.max(0, after - 1)], to = frames[after];
    if (!from) return undefined;
    const share = to && after > 0 ? (this.nowS - from.time_s) / (to.time_s - from.time_s) : 0;
    const arms = from.arms.map((arm, i) => (to && share > 0 ? between(arm, to.arms[i]!, share) : arm)) as [ArmNow, ArmNow];
    return { ...from, time_s: this.nowS, arms, forces: [] };
  }

  /** Rows of the last so many seconds. */
  forces(lastS: number): number[][] {
    return this.told.forces.slice(firstAfter(this.forceTimes, this.nowS - lastS), firstAfter(this.forceTimes, this.nowS));
  }

  happened(): Happening[] {
    return this.told.events.filter((one) => one.time_s <= this.nowS);
  }
}
