/** What is left in the tanks, and what became of the fruit. */

import { Attribute, Text, h } from "../dom";
import { type Key, translated } from "../i18n";
import type { Hello, Liquid, RobotWire } from "../wire";

const LIQUIDS: readonly Liquid[] = ["water", "nutrient", "pesticide"];
const FATES = ["held", "boxed", "dropped", "damaged"] as const;
/** Share of a tank at which its bar warns. */
const LOW = 0.15;

type Fate = (typeof FATES)[number];

class Tank {
  readonly element: HTMLElement;
  private readonly value = new Text(h("output"));
  private readonly fill = h("i");
  private readonly width = new Attribute(this.fill, "style");
  private readonly look: Attribute;

  constructor(readonly liquid: Liquid) {
    const meter = h("span", { class: "meter" }, this.fill);
    this.element = h("div", { class: "tank", "data-liquid": liquid }, translated(h("small"), `liquid.${liquid}`), this.value.element, meter);
    this.look = new Attribute(this.element, "data-low");
  }

  set(level_l: number, full_l: number): void {
    const share = full_l > 0 ? Math.min(1, level_l / full_l) : 0;
    this.value.set(`${level_l.toFixed(1)} l`);
    this.width.set(`width:${(100 * share).toFixed(0)}%`);
    this.look.set(String(share < LOW));
  }
}

class Count {
  readonly element: HTMLElement;
  private readonly value = new Text(h("b"));
  private readonly any: Attribute;

  constructor(fate: Fate) {
    this.element = h("div", { class: "count", "data-fate": fate }, this.value.element, translated(h("small"), `fruit.${fate}` as Key));
    this.any = new Attribute(this.element, "data-any");
  }

  set(count: number): void {
    this.value.set(String(count));
    this.any.set(String(count > 0));
  }
}

export class Stocks {
  readonly element: HTMLElement;
  private readonly tanks = LIQUIDS.map((liquid) => new Tank(liquid));
  private readonly counts = FATES.map((fate) => new Count(fate));
  private readonly tally = new Map<Fate, number>();
  private full_l = 0;

  constructor() {
    const tanks = h("div", { class: "tanks" }, ...this.tanks.map((tank) => tank.element));
    const counts = h("div", { class: "counts" }, ...this.counts.map((count) => count.element));
    this.element = h("div", { class: "stocks" }, tanks, counts);
  }

  hello(hello: Hello): void {
    this.full_l = hello.full_tank_l;
  }

  set(robot: RobotWire): void {
    for (const tank of this.tanks) tank.set(robot.tank_l[tank.liquid] ?? 0, this.full_l);
    for (const fate of FATES) this.tally.set(fate, 0);
    for (const name in robot.fruits) {
      for (const fate of FATES) {
        if (robot.fruits[name]?.includes(fate)) this.tally.set(fate, (this.tally.get(fate) ?? 0) + 1);
      }
    }
    this.counts.forEach((count, i) => count.set(this.tally.get(FATES[i] ?? "held") ?? 0));
  }
}
