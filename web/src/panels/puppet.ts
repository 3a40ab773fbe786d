/** Sliders for the rendered operator of `virtual:live`: place (on the floor map), arms, hands, legs, gestures.
 *
 * Who is moved here is seen, tracked and obeyed like anybody else: nothing goes past the camera.
 */

import { act } from "../act";
import { RequestError, type VirtualArm, type VirtualChange, type VirtualOperator, api } from "../api";
import { Text, h } from "../dom";
import { type Key, translated } from "../i18n";
import { type Panel, frame } from "../panel";
import type { State } from "../wire";
import { SIDES, type Side } from "../words";

const SEND_EVERY_MS = 80;
const HANDS: readonly VirtualArm["hand"][] = ["open", "relaxed", "fist"];
const GESTURES: readonly VirtualOperator["gesture"][] = ["none", "engage", "stop"];
const KIND = "virtual";

/** A slider with its name and value. */
class Slide {
  readonly element: HTMLElement;
  private readonly input: HTMLInputElement;
  private readonly value = new Text(h("output"));

  constructor(title: Key, low: number, high: number, changed: (value: number) => void) {
    this.input = h("input", { type: "range", min: low, max: high, step: 1 });
    this.element = h("label", { class: "slide" }, translated(h("small"), title), this.input, this.value.element);
    this.input.addEventListener("input", () => {
      this.show(Number(this.input.value));
      changed(Number(this.input.value));
    });
  }

  show(value: number): void {
    this.input.value = String(value);
    this.value.set(`${value.toFixed(0)}°`);
  }
}

/** Buttons of which one is chosen. */
class Choice<T extends string> {
  readonly element: HTMLElement;
  private readonly buttons = new Map<T, HTMLButtonElement>();

  constructor(choices: readonly T[], prefix: string, changed: (choice: T) => void) {
    this.element = h("div", { class: "choice", role: "group" });
    for (const choice of choices) {
      const button = translated(h("button", { class: "chip", type: "button" }), `${prefix}.${choice}` as Key);
      button.addEventListener("click", () => {
        this.show(choice);
        changed(choice);
      });
      this.buttons.set(choice, button);
      this.element.append(button);
    }
  }

  show(choice: T): void {
    for (const [name, button] of this.buttons) button.setAttribute("aria-pressed", String(name === choice));
  }
}

class ArmSliders {
  readonly element: HTMLElement;
  private readonly side: Slide;
  private readonly front: Slide;
  private readonly elbow: Slide;
  private readonly hand: Choice<VirtualArm["hand"]>;

  constructor(side: Side, changed: (change: Partial<VirtualArm>) => void) {
    this.side = new Slide("dial.theta1", 0, 100, (side_deg) => changed({ side_deg }));
    this.front = new Slide("dial.theta2", 0, 80, (front_deg) => changed({ front_deg }));
    this.elbow = new Slide("dial.theta3", 50, 180, (elbow_deg) => changed({ elbow_deg }));
    this.hand = new Choice(HANDS, "puppet.hand", (hand) => changed({ hand }));
    this.element = h(
      "div",
      { class: "puppet-arm", "data-side": side },
      translated(h("h3"), `arm.${side}`),
      this.side.element,
      this.front.element,
      this.elbow.element,
      this.hand.element,
    );
  }

  show(arm: VirtualArm): void {
    this.side.show(arm.side_deg);
    this.front.show(arm.front_deg);
    this.elbow.show(arm.elbow_deg);
    this.hand.show(arm.hand);
  }
}

export class PuppetPanel implements Panel {
  readonly element: HTMLElement;
  private readonly gesture = new Choice(GESTURES, "puppet.gesture", (gesture) => this.send({ gesture }));
  private readonly apart = new Slide("legs.T1", 0, 45, (apart_deg) => this.send({ apart_deg }));
  private readonly turn = new Slide("puppet.turn", -60, 60, (turn_deg) => this.send({ turn_deg }));
  private readonly arms: Record<Side, ArmSliders> = {
    right: new ArmSliders("right", (right) => this.send({ right })),
    left: new ArmSliders("left", (left) => this.send({ left })),
  };
  private waiting: VirtualChange = {};
  private timer: number | null = null;
  /** The source whose operator is shown. */
  private shown = "";

  constructor() {
    const { element, tools } = frame(
      "puppet",
      "panel.puppet",
      h("div", { class: "puppet-body" }, this.gesture.element, this.apart.element, this.turn.element),
      ...SIDES.map((side) => this.arms[side].element),
    );
    tools.append(translated(h("span"), "puppet.hint"));
    this.element = element;
    this.element.hidden = true;
    this.element.setAttribute("data-commands", "");
  }

  /** Whether there is somebody to move. */
  get active(): boolean {
    return this.shown !== "";
  }

  /** Walk to a place of the floor. */
  place(x_m: number, z_m: number): void {
    this.send({ x_m: Math.min(2.5, Math.max(-2.5, x_m)), z_m: Math.min(4.5, Math.max(1, z_m)) });
  }

  state({ source }: State): void {
    const driven = source?.kind === KIND && source.live ? source.uri : "";
    if (driven === this.shown) return;
    this.shown = driven;
    this.element.hidden = driven === "";
    document.body.classList.toggle("puppet", driven !== "");
    if (driven) void this.load();
  }

  private async load(): Promise<void> {
    try {
      this.show(await api.virtual());
    } catch (error) {
      if (!(error instanceof RequestError)) throw error; // closed again meanwhile
    }
  }

  private show(operator: VirtualOperator): void {
    this.gesture.show(operator.gesture);
    this.apart.show(operator.apart_deg);
    this.turn.show(operator.turn_deg);
    for (const side of SIDES) this.arms[side].show(operator[side]);
  }

  /** Changes of a moment go together; sliders would flood the server. */
  private send(change: VirtualChange): void {
    const { right, left, ...rest } = change;
    this.waiting = { ...this.waiting, ...rest };
    if (right) this.waiting.right = { ...this.waiting.right, ...right };
    if (left) this.waiting.left = { ...this.waiting.left, ...left };
    this.timer ??= window.setTimeout(() => {
      this.timer = null;
      const told = this.waiting;
      this.waiting = {};
      void act(api.driveVirtual(told));
    }, SEND_EVERY_MS);
  }
}
