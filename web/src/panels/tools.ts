/** Hands, tools and liquid; the lift and the disc, which only the console and the API move. */

import { act } from "../act";
import { type RobotRequest, api } from "../api";
import { Attribute, Text, h } from "../dom";
import { type Key, t, translated } from "../i18n";
import { icon, setIcon } from "../icons";
import { type Panel, frame } from "../panel";
import type { Hello, State } from "../wire";
import { SIDES, type Side } from "../words";
import { Stocks } from "./stocks";

const SEND_EVERY_MS = 100;

class Lamp {
  readonly element: HTMLElement;
  private readonly word = new Text(h("b"));
  private readonly lit: Attribute;

  constructor(title: Key) {
    this.element = h("div", { class: "lamp" }, h("i"), translated(h("small"), title), this.word.element);
    this.lit = new Attribute(this.element, "data-lit");
  }

  set(word: string, lit: boolean, look = ""): void {
    this.word.set(word);
    this.lit.set(lit ? look || "on" : "off");
  }
}

class HandMark {
  readonly element: HTMLElement;
  private readonly glyph = icon("unknown");
  private readonly word = new Text(h("b"));
  private readonly bar = h("i");
  private readonly width = new Attribute(this.bar, "style");
  private readonly look: Attribute;

  constructor(private readonly side: Side) {
    const title = translated(h("small"), `hand.${side}`);
    this.element = h("div", { class: "hand", "data-side": side }, this.glyph, title, this.word.element, h("span", { class: "meter" }, this.bar));
    this.look = new Attribute(this.element, "data-hand");
  }

  set(state: State): void {
    const hand = state.hands[this.side];
    setIcon(this.glyph, hand);
    this.look.set(hand);
    this.word.set(t(`hand.${hand}`));
    this.width.set(`width:${(100 * state.hands[`${this.side}_confidence`]).toFixed(0)}%`);
  }
}

/** A slider that sends what it shows, and follows the robot while nobody holds it. */
class Drive {
  readonly element: HTMLElement;
  private readonly slider = h("input", { type: "range", min: 0, max: 1, step: 0.01 });
  private readonly value = new Text(h("output"));
  private held = false;
  private timer: number | null = null;

  constructor(
    title: Key,
    private readonly scale: number,
    private readonly unit: string,
    private readonly request: (value: number) => RobotRequest,
  ) {
    const label = h("label", {}, translated(h("small"), title), this.slider, this.value.element);
    this.element = h("div", { class: "drive" }, label);
    this.slider.addEventListener("input", () => this.moved());
    this.slider.addEventListener("change", () => this.release());
  }

  limits(lower: number, upper: number): void {
    this.slider.min = String(lower);
    this.slider.max = String(upper);
    this.slider.step = String((upper - lower) / 200);
  }

  follow(position: number): void {
    if (!this.held && this.timer === null) this.slider.value = String(position);
    this.value.set(`${(position * this.scale).toFixed(this.scale === 1 ? 2 : 0)} ${this.unit}`);
  }

  private moved(): void {
    this.held = true;
    this.timer ??= window.setTimeout(() => {
      this.timer = null;
      void act(api.robot(this.request(Number(this.slider.value))));
    }, SEND_EVERY_MS);
  }

  private release(): void {
    this.moved();
    this.held = false;
  }
}

export class ToolsPanel implements Panel {
  readonly element: HTMLElement;
  private readonly hands = SIDES.map((side) => new HandMark(side));
  private readonly gripper = new Lamp("tool.gripper");
  private readonly cutter = new Lamp("tool.cutter");
  private readonly spray = new Lamp("tool.spray");
  private readonly stocks = new Stocks();
  private readonly lift = new Drive("tool.lift", 1, "m", (value) => ({ lift_m: value }));
  private readonly disc = new Drive("tool.disc", 180 / Math.PI, "°", (value) => ({ disc_rad: value }));

  constructor() {
    const lamps = [this.gripper, this.cutter, this.spray].map((lamp) => lamp.element);
    this.element = frame(
      "tools",
      "panel.tools",
      h("div", { class: "hands" }, ...this.hands.map((hand) => hand.element)),
      h("div", { class: "lamps" }, ...lamps),
      this.stocks.element,
      h("div", { class: "drives", "data-commands": true }, this.lift.element, this.disc.element),
    ).element;
  }

  hello(hello: Hello): void {
    this.stocks.hello(hello);
    this.lift.limits(...hello.lift_range_m);
    this.disc.limits(...hello.disc_range_rad);
  }

  state(state: State): void {
    const robot = state.robot;
    for (const hand of this.hands) hand.set(state);
    this.gripper.set(t(robot.gripper_open ? "tool.open" : "tool.closed"), !robot.gripper_open);
    this.cutter.set(t(robot.cutter_closed ? "tool.closed" : "tool.open"), robot.cutter_closed);
    this.spray.set(`${t(`liquid.${robot.liquid}`)}, ${t(robot.spray_on ? "tool.on" : "tool.off")}`, robot.spray_on, robot.liquid);
    this.stocks.set(robot);
    this.lift.follow(robot.joints["lift"] ?? 0);
    this.disc.follow(robot.joints["disc"] ?? 0);
  }
}
