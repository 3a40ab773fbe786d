/** Calibration step by step. The emergency stop is latched as long as it is open: the robot does not move meanwhile. */

import { act, emergencyStop } from "../act";
import { api } from "../api";
import { h } from "../dom";
import { translated } from "../i18n";
import type { Panel } from "../panel";
import { Sheet } from "../sheet";
import type { Hello, State } from "../wire";
import { FinishStep } from "./finish";
import { HandsStep } from "./hands";
import { SensorStep } from "./sensor";
import type { Step } from "./step";
import { ZonesStep } from "./zones";

/** The stop that the wizard asks for takes this long to show at most; a released one ends the wizard. */
const LATCH_MS = 3_000;

export class Wizard implements Panel {
  readonly element: HTMLDialogElement;
  private readonly sheet: Sheet;
  private readonly steps: readonly Step[];
  private readonly marks: HTMLElement[];
  private readonly body = h("div", { class: "wizard-body" });
  private readonly back = translated(h("button", { class: "button", type: "button" }), "calibrate.back");
  private readonly next = translated(h("button", { class: "button primary", type: "button" }), "calibrate.next");
  private readonly release = translated(h("button", { class: "button primary", type: "button" }), "calibrate.release");
  private at = 0;
  private latched = false;
  private opened_ms = 0;

  constructor() {
    const steps = [new SensorStep(), new ZonesStep(), new HandsStep()];
    this.steps = [...steps, new FinishStep(steps)];
    this.marks = this.steps.map((step) => translated(h("li"), step.title));
    const foot = h("div", { class: "sheet-foot" }, this.back, this.next, this.release);
    const safe = translated(h("p", { class: "wizard-safe" }), "calibrate.safe");
    this.sheet = new Sheet("panel.calibrate", safe, h("ol", { class: "wizard-steps" }, ...this.marks), this.body, foot);
    this.element = this.sheet.element;
    this.element.classList.add("aside");
    this.back.addEventListener("click", () => this.go(this.at - 1));
    this.next.addEventListener("click", () => this.go(this.at + 1));
    this.release.addEventListener("click", () => void act(api.estopReset()));
  }

  toggle(): void {
    if (this.element.open) this.sheet.close();
    else void this.open();
  }

  private async open(): Promise<void> {
    if (!(await emergencyStop())) return;
    this.latched = false;
    this.opened_ms = performance.now();
    this.sheet.open();
    this.go(0);
  }

  private go(index: number): void {
    const step = this.steps[index];
    if (!step) return;
    this.at = index;
    this.body.replaceChildren(step.element);
    this.marks.forEach((mark, i) => mark.toggleAttribute("data-now", i === index));
    const last = index === this.steps.length - 1;
    this.back.disabled = index === 0;
    this.next.hidden = last;
    this.release.hidden = !last;
    step.enter();
  }

  hello(hello: Hello): void {
    for (const step of this.steps) step.hello?.(hello);
  }

  state(state: State, now_ms: number): void {
    if (!this.element.open) return;
    this.latched ||= state.robot.estop;
    const late = performance.now() - this.opened_ms > LATCH_MS;
    if (!state.robot.estop && (this.latched || late)) this.sheet.close();
    else this.steps[this.at]?.state(state, now_ms);
  }
}
