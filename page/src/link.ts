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
/** The newest millisecond, and time, target and felt force of both arms since the message before. */
export interface Live { time_s: number; performed: number; arms: [ArmNow, ArmNow]; forces: number[][] }
export interface Reply { ask: string; outcome: string; said: Said; address?: string }

interface Listener { state(state: State): void; live(live: Live): void; reply(reply: Reply): void; lost(lost: boolean): void }

const lostAfterMs = 800;
const beatEveryMs = 500;

/** The one connection to the server; it comes back by itself. */
export class Link {
  private socket?: WebSocket;
  private sequence = 0;
  /** Server's clock less this one, in seconds; what came with the least delay tells it best. */
  private aheadS = -Infinity;
  private heardMs = 0;
  private lost = false;

  constructor(private readonly listener: Listener) {
    this.open();
    setInterval(() => this.look(), 100);
    setInterval(() => this.ask("beat"), beatEveryMs);
  }

  ask(ask: string, order?: unknown): void {
    if (this.socket?.readyState !== WebSocket.OPEN || this.heardMs === 0) return;
    const clock_s = this.aheadS + performance.now() / 1000;
    this.socket.send(JSON.stringify({ ask, sequence: ++this.sequence, clock_s, ...(order ? { order } : {}) }));
  }

  private open(): void {
    const socket = new WebSocket(`${location.protocol.replace("http", "ws")}//${location.host}/live`);
    this.socket = socket;
    this.sequence = 0;
    this.heardMs = 0;
    this.aheadS = -Infinity;
    socket.onmessage = (event) => this.hear(JSON.parse(event.data as string));
    socket.onclose = () => setTimeout(() => { if (this.socket === socket) this.open(); }, 500);
  }

  private hear(message: { channel: string } & (State | Live | Reply)): void {
    if (message.channel === "state") {
      const state = message as unknown as State;
      this.heardMs = performance.now();
      this.aheadS = Math.max(this.aheadS, state.clock_s - this.heardMs / 1000);
      this.tell(false);
      this.listener.state(state);
    } else if (message.channel === "live") {
      this.listener.live(message as unknown as Live);
    } else {
      this.listener.reply(message as unknown as Reply);
    }
  }

  private look(): void {
    if (performance.now() - this.heardMs > lostAfterMs) this.tell(true);
  }

  private tell(lost: boolean): void {
    if (lost === this.lost) return;
    this.lost = lost;
    this.listener.lost(lost);
  }
}
