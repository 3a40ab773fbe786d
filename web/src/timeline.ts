/** The position slider of a recording: the operator's mode all along, and a mark wherever something happened.
 *
 *   marks      | |    ||   |        events, recorded and of now
 *   recorded   ====----====         modes as they were recorded, where they were
 *   now        ====----             modes as it plays now
 *   slider     ------o-------
 */

import { Band } from "./mode_band";
import { h } from "./dom";
import { type Key, reasonText, t, titled } from "./i18n";
import { clock } from "./clock";
import type { Story } from "./api";
import type { EventMessage, Mode, State } from "./wire";

/** Marks closer than this and of one family are one. */
const APART_S = 0.3;
const MOST = 400;
/** Pointer within this share of the bar shows what a mark means. */
const NEAR = 0.008;
const SHOWN = /^(mode|tool|stop|refused)\./;

interface Mark {
  family: string;
  reason: string;
  at_s: number;
  mark: HTMLElement;
}

export class Timeline {
  readonly slider = titled(h("input", { type: "range", min: 0, max: 1, step: 0.01, value: 0 }), "replay.position");
  private readonly marks = h("div", { class: "timeline-marks" });
  private readonly recorded = new Band();
  private readonly now = new Band();
  private readonly tip = h("div", { class: "timeline-tip", hidden: true });
  readonly element = h(
    "div",
    { class: "timeline" },
    h("div", { class: "timeline-told", "aria-hidden": "true" }, this.marks, this.recorded.element, this.now.element),
    this.slider,
    this.tip,
  );
  private readonly known: Mark[] = [];
  private length_s = 0;

  constructor() {
    this.recorded.element.hidden = true;
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
    const [now, recorded] = [this.now.at(share), this.recorded.at(share)];
    if (recorded && now && recorded !== now) words.unshift(t("replay.was", { was: modeText(recorded), now: modeText(now) }));
    else if (now ?? recorded) words.unshift(modeText((now ?? recorded) as Mode));
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

  /** What the recording itself says happened. */
  tell(story: Story): void {
    this.extend(story.duration_s);
    for (const event of story.events) this.mark(event.reason, event.position_s);
    this.recorded.element.hidden = story.modes.length === 0;
    this.recorded.fill(story.modes.map(({ position_s, mode }) => ({ share: this.share(position_s), mode: mode as Mode })));
  }

  event(event: EventMessage): void {
    if (event.position_s !== null) this.mark(event.reason, event.position_s);
  }

  /** The mode at the place that is playing. */
  play(position_s: number, mode: State["mode"]): void {
    if (this.length_s > 0) this.now.learn(this.share(position_s), mode);
  }

  /** Another recording, or the same one anew. */
  clear(): void {
    for (const { mark } of this.known) mark.remove();
    this.known.length = 0;
    this.now.clear();
    this.recorded.clear();
    this.recorded.element.hidden = true;
  }

  restyle(): void {
    this.now.restyle();
    this.recorded.restyle();
  }

  private mark(reason: string, at_s: number): void {
    const family = reason.split(".")[0] ?? "";
    if (!SHOWN.test(reason)) return;
    if (this.known.some((other) => other.family === family && Math.abs(other.at_s - at_s) < APART_S)) return;
    const mark = h("i", { "data-family": family });
    this.put(mark, at_s);
    this.marks.append(mark);
    this.known.push({ family, reason, at_s, mark });
    if (this.known.length > MOST) this.known.shift()?.mark.remove();
  }

  private share(at_s: number): number {
    return this.length_s > 0 ? Math.min(1, at_s / this.length_s) : 0;
  }

  private put(mark: HTMLElement, at_s: number): void {
    mark.style.left = `${(100 * this.share(at_s)).toFixed(2)}%`;
  }
}

function modeText(mode: Mode): string {
  return t(`mode.${mode}` as Key);
}
