/** The two leg angles as bars with the thresholds that choose the task. */

import { Attribute, Text, h } from "../dom";
import { type Key, translated } from "../i18n";
import { type Panel, frame } from "../panel";
import type { Hello, State } from "../wire";

const FULL_SCALE_DEG = 40;

class Bar {
  readonly element: HTMLElement;
  private readonly fill = h("i");
  private readonly width = new Attribute(this.fill, "style");
  private readonly above: Attribute;
  private readonly value = new Text(h("output"));

  constructor(
    title: Key,
    private readonly threshold_deg: number,
  ) {
    const mark = h("b", { style: `left:${(100 * threshold_deg) / FULL_SCALE_DEG}%` }, h("small", {}, `${threshold_deg}°`));
    this.element = h("div", { class: "leg" }, translated(h("span"), title), h("div", { class: "leg-bar" }, this.fill, mark), this.value.element);
    this.above = new Attribute(this.element, "data-above");
  }

  set(angle_deg: number | null): void {
    const percent = angle_deg === null ? 0 : Math.min(100, (100 * angle_deg) / FULL_SCALE_DEG);
    this.width.set(`width:${percent.toFixed(1)}%`);
    this.value.set(angle_deg === null ? "–" : `${angle_deg.toFixed(1)}°`);
    this.above.set(String(angle_deg !== null && angle_deg > this.threshold_deg));
  }
}

export class LegsPanel implements Panel {
  readonly element: HTMLElement;
  private readonly body = h("div", { class: "legs" });
  private T1: Bar | null = null;
  private T2: Bar | null = null;

  constructor() {
    this.element = frame("legs", "panel.legs", this.body).element;
  }

  hello(hello: Hello): void {
    this.T1 = new Bar("legs.T1", hello.T1_threshold_deg);
    this.T2 = new Bar("legs.T2", hello.T2_threshold_deg);
    this.body.replaceChildren(this.T1.element, this.T2.element);
  }

  state(state: State): void {
    this.T1?.set(state.angles.T1);
    this.T2?.set(state.angles.T2);
  }
}
