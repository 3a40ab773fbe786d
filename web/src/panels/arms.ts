/** The operator's arms: three dials each, and which robot arm they drive. */

import { Dial } from "../dial";
import { Attribute, Text, h } from "../dom";
import { t, translated } from "../i18n";
import { type Panel, frame } from "../panel";
import type { ArmTargetState, CommandState, Hello, State } from "../wire";
import { SIDES, type Side } from "../words";

/** The command of the robot arm that this side of the operator drives, and its name; null while it holds. */
function driven(command: CommandState, side: Side): { name: Side | "rear"; target: ArmTargetState } | null {
  if (side === "right" && command.rear_arm) return { name: "rear", target: command.rear_arm };
  const target = side === "right" ? command.right_arm : command.left_arm;
  return target ? { name: side, target } : null;
}

class ArmRow {
  readonly element: HTMLElement;
  private readonly theta1: Dial;
  private readonly theta2: Dial;
  private readonly theta3: Dial;
  private readonly drives = new Text(h("span", { class: "arm-drives" }));
  private readonly active: Attribute;

  constructor(
    private readonly side: Side,
    step_deg: number,
  ) {
    this.theta1 = new Dial({ title: "dial.theta1", step_deg, elbow: false });
    this.theta2 = new Dial({ title: "dial.theta2", step_deg, elbow: false });
    this.theta3 = new Dial({ title: "dial.theta3", step_deg: null, elbow: true });
    const name = translated(h("h3"), `arm.${side}`);
    this.element = h(
      "div",
      { class: "arm-row", "data-side": side },
      h("div", { class: "arm-name" }, name, this.drives.element),
      h("div", { class: "dials" }, this.theta1.element, this.theta2.element, this.theta3.element),
    );
    this.active = new Attribute(this.element, "data-driven");
  }

  set(state: State): void {
    const link = driven(state.command, this.side);
    const target = link?.target ?? null;
    this.drives.set(link ? t(`arm.drives.${link.name}`) : t("arm.locked"));
    this.active.set(String(link !== null));
    // C2 follows theta1 (source eq. 17), C1 follows theta2 (eq. 18).
    this.theta1.set(state.angles[`theta1_${this.side}`], target?.c2_deg ?? null);
    this.theta2.set(state.angles[`theta2_${this.side}`], target?.c1_deg ?? null);
    this.theta3.set(state.angles[`theta3_${this.side}`], target?.elbow_deg ?? null);
  }
}

export class ArmsPanel implements Panel {
  readonly element: HTMLElement;
  private readonly body = h("div", { class: "arms" });
  private rows: ArmRow[] = [];

  constructor() {
    this.element = frame("arms", "panel.arms", this.body).element;
  }

  hello(hello: Hello): void {
    this.rows = SIDES.map((side) => new ArmRow(side, hello.shoulder_step_deg));
    this.body.replaceChildren(...this.rows.map((row) => row.element));
  }

  state(state: State): void {
    for (const row of this.rows) row.set(state);
  }
}
