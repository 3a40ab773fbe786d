/** Angles over the last 20 seconds. */

import uPlot from "uplot";
import { cssColor, h, rem } from "../dom";
import { translated } from "../i18n";
import { type Panel, frame } from "../panel";
import type { AnglesState, State } from "../wire";

const WINDOW_S = 20;
const CAPACITY = 620; // 20 s at 30 Hz and a little
const EVERY_MS = 100;

type Group = "right" | "left" | "legs";

const GROUPS: Record<Group, readonly (keyof AnglesState)[]> = {
  right: ["theta1_right", "theta2_right", "theta3_right"],
  left: ["theta1_left", "theta2_left", "theta3_left"],
  legs: ["T1", "T2"],
};
const LABELS: Record<keyof AnglesState, string> = {
  theta1_right: "θ1",
  theta2_right: "θ2",
  theta3_right: "θ3",
  theta1_left: "θ1",
  theta2_left: "θ2",
  theta3_left: "θ3",
  T1: "T1",
  T2: "T2",
};
const COLORS = ["--series-1", "--series-2", "--series-3"];

export class PlotsPanel implements Panel {
  readonly element: HTMLElement;
  private readonly box = h("div", { class: "plot-box" });
  private readonly buttons = new Map<Group, HTMLButtonElement>();
  private readonly t_s: number[] = [];
  private readonly history = new Map<keyof AnglesState, (number | null)[]>();
  private group: Group = "right";
  private plot: uPlot | null = null;
  private drawn_ms = -Infinity;

  constructor() {
    const { element, tools } = frame("plots", "panel.plots", this.box);
    this.element = element;
    for (const group of Object.keys(GROUPS) as Group[]) {
      for (const name of GROUPS[group]) this.history.set(name, []);
      const button = translated(h("button", { class: "chip", type: "button" }), `plot.${group}`);
      button.addEventListener("click", () => this.choose(group));
      this.buttons.set(group, button);
      tools.append(button);
    }
    new ResizeObserver(() => this.resize()).observe(this.box);
    this.choose("right");
  }

  private choose(group: Group): void {
    this.group = group;
    for (const [name, button] of this.buttons) button.setAttribute("aria-pressed", String(name === group));
    this.build();
  }

  restyle(): void {
    this.build();
  }

  private build(): void {
    this.plot?.destroy();
    const axis: uPlot.Axis = {
      stroke: cssColor("--muted"),
      grid: { stroke: cssColor("--line"), width: 1 },
      ticks: { show: false },
      font: `${rem(0.78)}px ${cssColor("--font")}`,
    };
    const series = GROUPS[this.group].map((name, i) => ({
      label: LABELS[name],
      stroke: cssColor(COLORS[i] ?? "--muted"),
      width: 2,
      points: { show: false },
    }));
    const options: uPlot.Options = {
      width: Math.max(100, this.box.clientWidth),
      height: Math.max(80, this.box.clientHeight),
      cursor: { show: false },
      legend: { show: false },
      padding: [rem(0.6), rem(1), 0, 0],
      scales: {
        x: { time: false, range: (_plot, _min, max) => [max - WINDOW_S, max] },
        y: { range: this.group === "legs" ? [0, 50] : [0, 205] },
      },
      axes: [
        { ...axis, size: rem(1.7), values: (plot, ticks) => ticks.map((tick) => `${(tick - (plot.scales["x"]?.max ?? 0)).toFixed(0)} s`), splits: (plot) => everyFive(plot) },
        { ...axis, size: rem(2.7), values: (_plot, ticks) => ticks.map((tick) => `${tick}°`), splits: () => (this.group === "legs" ? [0, 12, 14, 30, 45] : [0, 45, 90, 135, 180]) },
      ],
      series: [{}, ...series],
      hooks: { draw: [(plot) => this.names(plot)] },
    };
    this.plot = new uPlot(options, this.data(), this.box);
  }

  /** The series' names in the plot itself, so that no legend takes room. */
  private names(plot: uPlot): void {
    const ratio = uPlot.pxRatio;
    plot.ctx.save();
    plot.ctx.font = `600 ${rem(0.85) * ratio}px ${cssColor("--font")}`;
    plot.ctx.textAlign = "left";
    plot.ctx.textBaseline = "top";
    GROUPS[this.group].forEach((name, i) => {
      plot.ctx.fillStyle = cssColor(COLORS[i] ?? "--muted");
      plot.ctx.fillText(LABELS[name], plot.bbox.left + rem(0.6 + 2.2 * i) * ratio, plot.bbox.top + 2 * ratio);
    });
    plot.ctx.restore();
  }

  private data(): uPlot.AlignedData {
    return [this.t_s, ...GROUPS[this.group].map((name) => this.history.get(name) ?? [])];
  }

  private resize(): void {
    if (this.box.clientWidth > 0 && this.box.clientHeight > 0) {
      this.plot?.setSize({ width: this.box.clientWidth, height: this.box.clientHeight });
    }
  }

  state(state: State, now_ms: number): void {
    const last = this.t_s.at(-1);
    if (last === undefined || state.t > last) this.push(state);
    else if (state.t < last) this.clear(); // the recording was sought back or began anew
    if (now_ms - this.drawn_ms < EVERY_MS) return;
    this.drawn_ms = now_ms;
    this.plot?.setData(this.data());
  }

  private push(state: State): void {
    const full = this.t_s.length >= CAPACITY;
    if (full) this.t_s.shift();
    this.t_s.push(state.t);
    for (const [name, values] of this.history) {
      if (full) values.shift();
      values.push(state.angles[name]);
    }
  }

  private clear(): void {
    this.t_s.length = 0;
    for (const values of this.history.values()) values.length = 0;
  }
}

function everyFive(plot: uPlot): number[] {
  const end = plot.scales["x"]?.max ?? 0;
  return [end - 20, end - 15, end - 10, end - 5, end];
}
