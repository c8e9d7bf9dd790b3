// SPDX-License-Identifier: Apache-2.0
import { type Said } from "./words";

/** What the server says of itself and of the session, four times a second. */
export interface State {
  clock_s: number; you: number; viewer: boolean; operator: boolean; operated: boolean; pages: number;
  phase: "idle" | "scan" | "map" | "plan" | "review" | "massage" | "report" | "ended";
  progress: number; paused: boolean; session: string; outcome: string; said: Said[][]; recorded: boolean; reviews: number;
  cloud_points: number; backs: number; plans: number; events: number; pace: number | null; ordered: boolean; audit_fails: boolean; password: boolean;
}
export interface ArmNow {
  phase: string; path: number; probing: boolean; target_n: number; felt_n: number;
  /** Joints from shoulder to tool: place, and radius of what begins there; m. */
  links: [number, number, number, number][];
}
/** The newest millisecond, and time, target and felt force of both arms since the message before; `intensity` is the
 * share of the planned forces that is wished for now. */
export interface Live { time_s: number; performed: number; intensity?: number; arms: [ArmNow, ArmNow]; forces: number[][] }
export interface Reply { ask: string; outcome: string; said: Said; address?: string }

/** What people are told of a connection that does not work. */
export type Trouble = "lost" | "shut_out" | "stop_unheard";

interface Listener {
  state(state: State): void; live(live: Live): void; reply(reply: Reply): void;
  /** None while the connection works. */
  trouble(troubles: Trouble[]): void;
  /** There is another connection: much may have happened since the one before. */
  opened(): void;
}

const lostAfterMs = 800, beatEveryMs = 500, lookEveryMs = 100, tryAgainMs = 500, hangsMs = 5_000;
/** Looks in vain after which another connection is tried. A page that was busy itself has not looked. */
const silentLooks = 20;
/** A stop that nobody answers is asked for again by the next connection, unless it may mean another session by then. */
const keepStopMs = 10_000;
/** Clocks drift, so what states of long ago have told of them is forgotten. */
const clockStates = 20;

/** The one connection to the server; it comes back by itself, unless the server does not know this page any more. */
export class Link {
  private socket?: WebSocket;
  private sequence = 0;
  /** Server's clock less this one, by the newest states, in seconds; what came with the least delay tells it best. */
  private aheadS: number[] = [];
  private heardMs = 0;
  private looks = 0;
  /** When the stop was asked for that nobody has answered yet. */
  private stopMs: number | undefined;
  private told: Trouble[] = [];
  /** A server that began anew knows none of the pages before it, and would write each of their tries into its log. */
  private shutOut = false;

  constructor(private readonly listener: Listener) {
    this.open();
    setInterval(() => this.look(), lookEveryMs);
    setInterval(() => this.ask("beat"), beatEveryMs);
  }

  /** Whoever asks for a stop need not know the server's clock. */
  ask(ask: string, more: { order?: unknown; review?: number } = {}): void {
    if (this.socket?.readyState !== WebSocket.OPEN || (this.heardMs === 0 && ask !== "stop")) return;
    const clock_s = this.heardMs === 0 ? 0 : Math.max(...this.aheadS) + performance.now() / 1000;
    this.socket.send(JSON.stringify({ ask, sequence: ++this.sequence, clock_s, ...more }));
  }

  /** Until somebody answers it, the next connection begins with it. */
  stop(): void {
    this.stopMs = performance.now();
    this.ask("stop");
    this.tell();
  }

  private open(): void {
    if (this.shutOut) return;
    if (this.socket) {
      // Of a connection that hangs, nothing more is heard; its end may take minutes.
      this.socket.onopen = this.socket.onmessage = this.socket.onclose = null;
      this.socket.close();
    }
    const socket = new WebSocket(`${location.protocol.replace("http", "ws")}//${location.host}/live`);
    this.socket = socket;
    this.sequence = this.heardMs = this.looks = 0;
    this.aheadS = [];
    socket.onopen = () => {
      if (this.stopMs !== undefined && performance.now() - this.stopMs < keepStopMs) this.ask("stop");
      else this.stopMs = undefined;
      this.listener.opened();
    };
    socket.onmessage = (event) => this.hear(JSON.parse(event.data as string));
    socket.onclose = () => {
      if (this.heardMs === 0) void this.knock();
      setTimeout(() => { if (this.socket === socket) this.open(); }, tryAgainMs);
    };
  }

  /** A socket does not tell why it was refused. */
  private async knock(): Promise<void> {
    const reply = await fetch("/api/choices", { cache: "no-store", signal: AbortSignal.timeout(hangsMs) }).catch(() => undefined);
    if (reply?.status !== 401) return;
    this.shutOut = true;
    this.tell();
  }

  private hear(message: { channel: string } & (State | Live | Reply)): void {
    this.looks = 0;
    if (message.channel === "state") {
      const state = message as unknown as State;
      this.heardMs = performance.now();
      this.aheadS = [...this.aheadS.slice(1 - clockStates), state.clock_s - this.heardMs / 1000];
      this.tell();
      this.listener.state(state);
    } else if (message.channel === "live") {
      this.listener.live(message as unknown as Live);
    } else {
      const reply = message as unknown as Reply;
      if (reply.ask === "stop") this.stopMs = undefined;
      this.listener.reply(reply);
    }
  }

  private look(): void {
    if (++this.looks > silentLooks) this.open();
    this.tell();
  }

  private tell(): void {
    // What came while the page was busy is heard between two looks.
    const lost = performance.now() - this.heardMs > lostAfterMs && this.looks > 1;
    const unheard = this.stopMs !== undefined && (lost || this.socket?.readyState !== WebSocket.OPEN);
    const troubles: Trouble[] = [...(unheard ? ["stop_unheard" as const] : []), ...(this.shutOut ? ["shut_out" as const] : lost && !unheard ? ["lost" as const] : [])];
    if (troubles.join() === this.told.join()) return;
    this.told = troubles;
    this.listener.trouble(troubles);
  }
}
