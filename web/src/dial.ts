/** One arm angle as a quarter dial: the needle is the operator's arm, hanging down at the bottom.
 *
 *   pivot o------ 90 deg          The pivot is the joint; 0 (elbow: 180, straight) points down.
 *         |  .                    Bins are the steps in which a shoulder angle is sent.
 *         | .   needle
 *         0 deg
 */

import { Attribute, Text, h, s } from "./dom";
import { type Key, translated } from "./i18n";

const RADIUS = 70;
const INNER = 50;
const PIVOT = 14;
const FULL_DEG = 90;

function point(down_deg: number, radius: number): string {
  const a = (down_deg * Math.PI) / 180;
  return `${(PIVOT + radius * Math.sin(a)).toFixed(2)} ${(PIVOT + radius * Math.cos(a)).toFixed(2)}`;
}

function sector(from_deg: number, to_deg: number): string {
  return `M${point(from_deg, RADIUS)} A${RADIUS} ${RADIUS} 0 0 0 ${point(to_deg, RADIUS)} L${point(to_deg, INNER)} A${INNER} ${INNER} 0 0 1 ${point(from_deg, INNER)}z`;
}

export interface DialKind {
  title: Key;
  /** Step of the bins in degrees; null for a continuous angle. */
  step_deg: number | null;
  /** True for the elbow, where 180 deg is straight down. */
  elbow: boolean;
}

export class Dial {
  readonly element: HTMLElement;
  private readonly bins: SVGElement[] = [];
  private readonly needle = s("path", { class: "dial-needle", d: `M${PIVOT} ${PIVOT} V${PIVOT + RADIUS - 3}` });
  private readonly turn = new Attribute(this.needle, "transform");
  private readonly visible = new Attribute(this.needle, "visibility");
  private readonly sent = s("circle", { class: "dial-sent", r: 4 });
  private readonly sentPlace = new Attribute(this.sent, "transform");
  private readonly sentVisible = new Attribute(this.sent, "visibility");
  private readonly value = new Text(h("output"));
  private lit = -1;

  constructor(private readonly kind: DialKind) {
    const face = s("svg", { viewBox: "0 0 90 90", class: "dial-face", "aria-hidden": "true" });
    if (kind.step_deg !== null) {
      const step = kind.step_deg;
      for (let center = 0; center <= FULL_DEG; center += step) {
        const from = Math.max(0, center - step / 2) + 0.8;
        const to = Math.min(FULL_DEG, center + step / 2) - 0.8;
        this.bins.push(s("path", { class: "dial-bin", d: sector(from, to) }));
      }
      face.append(...this.bins);
    } else {
      face.append(s("path", { class: "dial-bin", d: sector(0, FULL_DEG) }));
      for (const deg of [30, 60]) face.append(s("path", { class: "dial-tick", d: `M${point(deg, INNER)} L${point(deg, RADIUS)}` }));
    }
    face.append(this.needle, this.sent, s("circle", { class: "dial-pivot", cx: PIVOT, cy: PIVOT, r: 5 }));
    this.element = h("div", { class: "dial" }, translated(h("small"), kind.title), this.value.element as HTMLElement);
    this.element.append(face);
  }

  /** angle_deg: the operator's angle; sent_deg: the angle in the command; null where there is none. */
  set(angle_deg: number | null, sent_deg: number | null): void {
    this.value.set(angle_deg === null ? "–" : `${angle_deg.toFixed(0)}°`);
    this.visible.set(angle_deg === null ? "hidden" : "visible");
    if (angle_deg !== null) this.turn.set(`rotate(${(-this.down(angle_deg)).toFixed(1)} ${PIVOT} ${PIVOT})`);
    if (this.kind.step_deg !== null) this.light(sent_deg === null ? -1 : Math.round(sent_deg / this.kind.step_deg));
    const mark = this.kind.step_deg === null && sent_deg !== null;
    this.sentVisible.set(mark ? "visible" : "hidden");
    if (mark) this.sentPlace.set(`translate(${point(this.down(sent_deg), (INNER + RADIUS) / 2)})`);
  }

  private down(angle_deg: number): number {
    return Math.min(100, Math.max(-5, this.kind.elbow ? 180 - angle_deg : angle_deg));
  }

  private light(index: number): void {
    if (index === this.lit) return;
    this.bins[this.lit]?.classList.remove("lit");
    this.bins[index]?.classList.add("lit");
    this.lit = index;
  }
}
