// SPDX-License-Identifier: Apache-2.0
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import { armColours } from "./picture/scene";
import { say } from "./words";

export const shownS = 30;

/** Force asked for and force felt of one arm, over the last half minute. */
export class Forces {
  private readonly plot: uPlot;
  private rows: [number[], number[], number[]] = [[], [], []];

  constructor(private readonly place: HTMLElement, arm: number) {
    // Asked for with every drawing, since the page may become dark meanwhile.
    const colour = (name: string) => () => getComputedStyle(document.documentElement).getPropertyValue(name);
    const axis = { stroke: colour("--soft"), grid: { stroke: colour("--line"), width: 1 }, ticks: { show: false }, font: "12px system-ui" };
    this.plot = new uPlot({
      width: 300, height: 140, cursor: { show: false }, legend: { show: false },
      scales: { x: { time: false }, y: { range: (_, low, high) => [Math.min(0, low), Math.max(10, high * 1.1)] } },
      axes: [{ ...axis, size: 26, values: (_, ticks) => ticks.map((tick) => `${tick} s`) }, { ...axis, size: 44, values: (_, ticks) => ticks.map((tick) => `${tick} N`) }],
      // What is asked for lies on what is felt, which mostly covers it.
      series: [{}, { label: say("felt"), stroke: armColours[arm]!, width: 2 },
        { label: say("target"), stroke: colour("--ink"), width: 1.5, dash: [5, 4] }],
    }, this.rows, place);
    new ResizeObserver(() => this.plot.setSize({ width: Math.max(place.clientWidth, 120), height: 140 })).observe(place);
  }

  /** Goes on with what another plot has shown. */
  take(other: Forces): void {
    this.rows = other.rows;
    this.plot.setData(this.rows);
  }

  /** These rows and no others. */
  show(times: number[], targets: number[], felts: number[]): void {
    this.rows = [times, felts, targets];
    if (this.place.isConnected) this.plot.setData(this.rows);
  }

  add(times: number[], targets: number[], felts: number[]): void {
    const all = [times, felts, targets];
    const first = (times.at(-1) ?? 0) - shownS;
    const from = this.rows[0].findIndex((time) => time >= first);
    this.rows = this.rows.map((row, i) => [...(from < 0 ? [] : row.slice(from)), ...all[i]!]) as typeof this.rows;
    if (this.place.isConnected) this.plot.setData(this.rows);
  }
}
