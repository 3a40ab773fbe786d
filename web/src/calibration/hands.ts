/** Whether both hands are read right: each is held open, then as a fist, for a second. */

import { Attribute, Text, h } from "../dom";
import { t, translated } from "../i18n";
import { type IconName, icon, setIcon } from "../icons";
import type { State } from "../wire";
import { SIDES, type Side } from "../words";
import type { Step } from "./step";

const HELD_MS = 1_000;
const SHOWN = ["open", "fist"] as const;

class Check {
  readonly element: HTMLElement;
  private readonly bar = h("i");
  private readonly width = new Attribute(this.bar, "style");
  private readonly glyph;
  private since_ms: number | null = null;
  passed = false;

  constructor(
    readonly side: Side,
    private readonly shown: (typeof SHOWN)[number],
  ) {
    this.glyph = icon(shown);
    const title = h("span", {}, translated(h("b"), `hand.${side}`), " ", translated(h("span"), `hand.${shown}`));
    this.element = h("div", { class: "hand-check", "data-side": side }, this.glyph, title, h("span", { class: "meter" }, this.bar));
  }

  begin(): void {
    this.since_ms = null;
    this.passed = false;
    this.show(0, this.shown);
  }

  see(state: State, now_ms: number): void {
    if (this.passed) return;
    if (state.hands[this.side] !== this.shown) this.since_ms = null;
    else this.since_ms ??= now_ms;
    const held_ms = this.since_ms === null ? 0 : now_ms - this.since_ms;
    this.passed = held_ms >= HELD_MS;
    this.show(Math.min(1, held_ms / HELD_MS), this.passed ? "check" : this.shown);
  }

  private show(share: number, name: IconName): void {
    setIcon(this.glyph, name);
    this.element.toggleAttribute("data-passed", this.passed);
    this.width.set(`width:${(100 * share).toFixed(0)}%`);
  }
}

export class HandsStep implements Step {
  readonly title = "calibrate.hands" as const;
  readonly element: HTMLElement;
  private readonly checks = SIDES.flatMap((side) => SHOWN.map((shown) => new Check(side, shown)));
  private readonly now = new Text(h("p", { class: "verdict" }));

  constructor() {
    const checks = h("div", { class: "hand-checks" }, ...this.checks.map((check) => check.element));
    this.element = h("div", {}, translated(h("p"), "calibrate.hands.text"), checks, this.now.element);
  }

  enter(): void {
    for (const check of this.checks) check.begin();
  }

  state(state: State, now_ms: number): void {
    for (const check of this.checks) check.see(state, now_ms);
    const words = SIDES.map((side) => {
      const sure = (100 * state.hands[`${side}_confidence`]).toFixed(0);
      return `${t(`hand.${side}`)}: ${t(`hand.${state.hands[side]}`)} (${sure} %)`;
    });
    this.now.set(words.join("   "));
  }

  result(): string {
    const passed = this.checks.filter((check) => check.passed).length;
    return passed === 0 ? "" : t("calibrate.hands.result", { passed, all: this.checks.length });
  }
}
