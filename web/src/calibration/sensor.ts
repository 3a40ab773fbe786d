/** Height and tilt of the sensor, measured from the floor it sees. */

import { act } from "../act";
import { api } from "../api";
import { Attribute, Text, h } from "../dom";
import { type Key, t, translated } from "../i18n";
import { treeOf } from "../settings/schema";
import type { State } from "../wire";
import { Lasting } from "./lasting";
import { Readings } from "./readings";
import type { Step } from "./step";

/** Two seconds of states. */
const WINDOW = 60;
const STEADY_DEG = 0.4;
const STEADY_M = 0.015;
/** What the README asks for, with reserve: about a metre high, nearly level. */
const HEIGHT_M = [0.6, 1.6] as const;
const MOST_PITCH_DEG = 20;
const MOST_ROLL_DEG = 5;
const TILT = "teleop.intent.level.tilt_deg";

class Gauge {
  readonly element: HTMLElement;
  private readonly value = new Text(h("output"));

  constructor(title: Key) {
    this.element = h("div", { class: "gauge" }, translated(h("small"), title), this.value.element);
  }

  set(text: string): void {
    this.value.set(text);
  }
}

export class SensorStep implements Step {
  readonly title = "calibrate.sensor" as const;
  readonly element: HTMLElement;
  private readonly height = new Gauge("calibrate.height");
  private readonly pitch = new Gauge("calibrate.pitch");
  private readonly roll = new Gauge("calibrate.roll");
  private readonly verdict = new Text(h("p", { class: "verdict" }));
  private readonly look = new Attribute(this.verdict.element, "data-good");
  private readonly keep = translated(h("button", { class: "button primary", type: "button" }), "calibrate.keep");
  private readonly heights_m = new Readings(WINDOW);
  private readonly pitches_deg = new Readings(WINDOW);
  private readonly rolls_deg = new Readings(WINDOW);
  private readonly usable = new Lasting();
  private kept_deg: number | null = null;

  constructor() {
    const gauges = h("div", { class: "gauges" }, this.height.element, this.pitch.element, this.roll.element);
    this.element = h("div", {}, translated(h("p"), "calibrate.sensor.text"), gauges, this.verdict.element, this.keep);
    this.keep.addEventListener("click", () => void this.save());
  }

  enter(): void {
    for (const known of [this.heights_m, this.pitches_deg, this.rolls_deg, this.usable]) known.clear();
  }

  state(state: State, now_ms: number): void {
    const floor = state.floor;
    if (!floor) {
      this.enter();
      for (const gauge of [this.height, this.pitch, this.roll]) gauge.set("–");
      this.say("calibrate.nofloor", false, now_ms);
      return;
    }
    this.heights_m.add(floor.camera_height_m);
    this.pitches_deg.add(floor.pitch_deg);
    this.rolls_deg.add(floor.roll_deg);
    this.height.set(`${this.heights_m.mean.toFixed(2)} m`);
    this.pitch.set(`${this.pitches_deg.mean.toFixed(1)}°`);
    this.roll.set(`${this.rolls_deg.mean.toFixed(1)}°`);
    const steady = this.heights_m.full && this.pitches_deg.spread < STEADY_DEG && this.heights_m.spread < STEADY_M;
    if (!steady) this.say("calibrate.unsteady", false, now_ms);
    else this.judge(now_ms);
  }

  private judge(now_ms: number): void {
    const height_m = this.heights_m.mean;
    if (height_m < HEIGHT_M[0] || height_m > HEIGHT_M[1]) this.say("calibrate.badheight", false, now_ms, true);
    else if (Math.abs(this.pitches_deg.mean) > MOST_PITCH_DEG) this.say("calibrate.badpitch", false, now_ms, true);
    else if (Math.abs(this.rolls_deg.mean) > MOST_ROLL_DEG) this.say("calibrate.badroll", false, now_ms, true);
    else this.say("calibrate.steady", true, now_ms);
  }

  private say(key: Key, good: boolean, now_ms: number, usable = good): void {
    this.verdict.set(t(key));
    this.look.set(String(good));
    this.keep.disabled = !this.usable.at(now_ms, usable);
  }

  private async save(): Promise<void> {
    const pitch_deg = Math.round(10 * this.pitches_deg.mean) / 10;
    if (await act(api.changeConfig(treeOf(new Map([[TILT, pitch_deg]]))))) this.kept_deg = pitch_deg;
  }

  result(): string {
    if (this.kept_deg === null) return "";
    return t("calibrate.sensor.result", { height: this.heights_m.mean.toFixed(2), tilt: this.kept_deg.toFixed(1) });
  }
}
