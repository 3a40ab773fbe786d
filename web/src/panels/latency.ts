/** Where the time goes between a motion and the painted overlay: median and 95 % of each stage.
 *
 * The headline holds the filter's delay, too: it is what the operator feels.
 */

import { Attribute, Text, h } from "../dom";
import { lookup, t, translated } from "../i18n";
import { type Panel, frame } from "../panel";
import type { StageLatency, State } from "../wire";

const EVERY_MS = 250;
const LEAST_SCALE_MS = 10;
const HEADLINE = "motion";
/** Sums of other stages: no bars of their own. */
const SUMS: readonly string[] = [HEADLINE, "total"];

class StageRow {
  readonly element: HTMLElement;
  private readonly name = new Text(h("span"));
  private readonly median = new Text(h("output"));
  private readonly p95 = new Text(h("output"));
  private readonly bar = h("i");
  private readonly whisker = h("b");
  private readonly barStyle = new Attribute(this.bar, "style");
  private readonly whiskerStyle = new Attribute(this.whisker, "style");

  constructor(private readonly stage: string) {
    const track = h("div", { class: "stage-bar" }, this.bar, this.whisker);
    this.element = h("div", { class: "stage" }, this.name.element, track, this.median.element, this.p95.element);
  }

  set(latency: StageLatency, scale_ms: number): void {
    this.name.set(lookup(`stage.${this.stage}`) ?? this.stage);
    this.median.set(ms(latency.p50));
    this.p95.set(ms(latency.p95));
    this.barStyle.set(`width:${share(latency.p50, scale_ms)}%`);
    this.whiskerStyle.set(`width:${share(latency.p95, scale_ms)}%`);
  }
}

export class LatencyPanel implements Panel {
  readonly element: HTMLElement;
  private readonly rows = new Map<string, StageRow>();
  private readonly list = h("div", { class: "stages" });
  private readonly median = new Text(h("b", { class: "total-value" }));
  private readonly p95 = new Text(h("b", { class: "total-value" }));
  private readonly shared = new Text(h("p", { class: "total-shared" }));
  private readonly fps = new Text(h("span"));
  private readonly clients = new Text(h("span"));
  private drawn_ms = -Infinity;

  constructor() {
    const total = h(
      "div",
      { class: "total" },
      translated(h("span"), "stage.motion"),
      h("div", {}, this.median.element, translated(h("small"), "latency.median"), this.p95.element, translated(h("small"), "latency.p95")),
    );
    const { element, tools } = frame("latency", "panel.latency", total, this.shared.element as HTMLElement, this.list);
    tools.append(this.fps.element, this.clients.element);
    this.element = element;
  }

  state(state: State, now_ms: number): void {
    if (now_ms - this.drawn_ms < EVERY_MS) return;
    this.drawn_ms = now_ms;
    this.fps.set(t("latency.fps", { fps: (state.source?.fps ?? 0).toFixed(0) }));
    this.clients.set(t(state.clients === 1 ? "latency.client" : "latency.clients", { count: state.clients }));
    const motion = state.latency_ms[HEADLINE];
    this.median.set(motion ? ms(motion.p50) : "–");
    this.p95.set(motion ? ms(motion.p95) : "–");
    const total = state.latency_ms["total"];
    this.shared.set(total ? t("latency.shared", { p50: ms(total.p50), p95: ms(total.p95) }) : "");
    let scale_ms = LEAST_SCALE_MS;
    for (const stage in state.latency_ms) {
      if (!SUMS.includes(stage)) scale_ms = Math.max(scale_ms, state.latency_ms[stage]?.p95 ?? 0);
    }
    for (const stage in state.latency_ms) {
      const latency = state.latency_ms[stage];
      if (SUMS.includes(stage) || !latency) continue;
      this.row(stage).set(latency, scale_ms);
    }
  }

  private row(stage: string): StageRow {
    let row = this.rows.get(stage);
    if (!row) {
      row = new StageRow(stage);
      this.rows.set(stage, row);
      this.list.append(row.element);
    }
    return row;
  }

  restyle(): void {
    this.drawn_ms = -Infinity;
  }
}

function ms(value: number): string {
  return value < 10 ? value.toFixed(1) : value.toFixed(0);
}

function share(value: number, scale: number): string {
  return Math.min(100, (100 * value) / scale).toFixed(1);
}
