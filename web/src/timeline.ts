/** The position slider of a recording, with a mark wherever something happened. */

import { h } from "./dom";
import { reasonText, titled } from "./i18n";
import { clock } from "./clock";
import type { EventMessage } from "./wire";

/** Marks closer than this and of one family are one. */
const APART_S = 0.3;
const MOST = 80;
/** Pointer within this share of the bar shows what a mark means. */
const NEAR = 0.012;
const OPENED = "source.opened";
const SHOWN = /^(mode|tool|stop|refused)\./;

export class Timeline {
  readonly slider = titled(h("input", { type: "range", min: 0, max: 1, step: 0.01, value: 0 }), "replay.position");
  private readonly marks = h("div", { class: "timeline-marks", "aria-hidden": "true" });
  private readonly tip = h("div", { class: "timeline-tip", hidden: true });
  readonly element = h("div", { class: "timeline" }, this.marks, this.slider, this.tip);
  private readonly known: { family: string; reason: string; at_s: number; mark: HTMLElement }[] = [];
  private length_s = 0;

  constructor() {
    this.element.addEventListener("pointermove", (event) => this.point(event));
    this.element.addEventListener("pointerleave", () => (this.tip.hidden = true));
  }

  /** Says what happened where the pointer is, and when that is. */
  private point(event: PointerEvent): void {
    const box = this.marks.getBoundingClientRect();
    const share = Math.min(1, Math.max(0, (event.clientX - box.left) / Math.max(1, box.width)));
    const at_s = share * this.length_s;
    const near = this.known.filter((mark) => Math.abs(mark.at_s - at_s) <= NEAR * this.length_s);
    const words = [...new Set(near.map((mark) => reasonText(mark.reason)))];
    this.tip.replaceChildren(h("b", {}, clock(at_s)), ...words.map((word) => h("span", {}, word)));
    this.tip.style.left = `${(100 * share).toFixed(1)}%`;
    this.tip.style.translate = `${(-100 * share).toFixed(0)}%`;
    this.tip.hidden = this.length_s === 0;
  }

  /** Length of the recording; the marks move with it. */
  extend(length_s: number): void {
    if (length_s === this.length_s) return;
    this.length_s = length_s;
    this.slider.max = String(length_s);
    for (const { mark, at_s } of this.known) this.put(mark, at_s);
  }

  event(event: EventMessage): void {
    if (event.reason === OPENED) this.clear();
    const at_s = event.position_s;
    const family = event.reason.split(".")[0] ?? "";
    if (at_s === null || !SHOWN.test(event.reason)) return;
    if (this.known.some((other) => other.family === family && Math.abs(other.at_s - at_s) < APART_S)) return;
    const mark = h("i", { "data-family": family });
    this.put(mark, at_s);
    this.marks.append(mark);
    this.known.push({ family, reason: event.reason, at_s, mark });
    if (this.known.length > MOST) this.known.shift()?.mark.remove();
  }

  private put(mark: HTMLElement, at_s: number): void {
    mark.style.left = `${this.length_s > 0 ? (100 * Math.min(1, at_s / this.length_s)).toFixed(2) : 0}%`;
  }

  private clear(): void {
    for (const { mark } of this.known) mark.remove();
    this.known.length = 0;
  }
}
