/** The zones, laid round the place where the operator wants to work; each length can be set by hand, too. */

import { act } from "../act";
import { RequestError, api } from "../api";
import { Text, h } from "../dom";
import { t, translated } from "../i18n";
import { SettingRow } from "../settings/row";
import { type Json, fieldsOf, refusals, treeOf, valueAt } from "../settings/schema";
import type { State } from "../wire";
import { Lasting } from "./lasting";
import { Readings } from "./readings";
import type { Step } from "./step";

const SECTION = "teleop.intent.zones";
const SHOWN = ["l1_m", "l2_m", "l3_m", "l4_m", "l5_m", "l6_m", "l7_m", "margin_m"];
/** One second of states. */
const WINDOW = 30;
const STEADY_M = 0.04;
const OFF_CENTRE_M = 0.15;

export class ZonesStep implements Step {
  readonly title = "calibrate.zones" as const;
  readonly element: HTMLElement;
  private readonly where = new Text(h("p", { class: "verdict" }));
  private readonly here = translated(h("button", { class: "button primary", type: "button" }), "calibrate.here");
  private readonly rows = h("div", { class: "settings" });
  private readonly apply = translated(h("button", { class: "button", type: "submit", disabled: true }), "settings.apply");
  private readonly note = h("p", { class: "setting-refusal", role: "alert" });
  private readonly z_m = new Readings(WINDOW);
  private readonly x_m = new Readings(WINDOW);
  private readonly still = new Lasting();
  private settings: SettingRow[] = [];
  private done = "";

  constructor() {
    const form = h("form", { novalidate: true }, this.rows, this.note, this.apply);
    const details = h("details", { class: "setting-section" }, translated(h("summary"), "calibrate.lengths"), form);
    this.element = h("div", {}, translated(h("p"), "calibrate.zones.text"), this.where.element, this.here, details);
    this.here.addEventListener("click", () => void this.workHere());
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      void this.send(new Map(this.settings.filter((row) => row.isChanged).map((row) => [row.field.path, Number(row.value)])));
    });
  }

  enter(): void {
    this.forget();
    void act(this.load());
  }

  private async load(): Promise<void> {
    if (this.settings.length === 0) {
      const fields = fieldsOf(await api.configSchema(), SECTION).filter((field) => SHOWN.includes(field.name));
      this.settings = fields.map((field) => new SettingRow(field, () => this.touched()));
      this.rows.replaceChildren(...this.settings.map((row) => row.element));
    }
    const config = await api.config();
    for (const row of this.settings) row.load(valueAt(config, row.field.path) ?? null);
    this.touched();
  }

  private touched(): void {
    this.apply.disabled = !this.settings.some((row) => row.isChanged);
  }

  private forget(): void {
    for (const known of [this.z_m, this.x_m, this.still]) known.clear();
  }

  state(state: State, now_ms: number): void {
    const at = state.spine_xz;
    if (!at) {
      this.forget();
      this.where.set(t("calibrate.nobody"));
      this.here.disabled = true;
      return;
    }
    this.x_m.add(at[0]);
    this.z_m.add(at[1]);
    const still = this.z_m.full && this.z_m.spread < STEADY_M;
    const off = Math.abs(this.x_m.mean) > OFF_CENTRE_M ? ` ${t("calibrate.offcentre", { x: this.x_m.mean.toFixed(2) })}` : "";
    this.where.set(t("calibrate.where", { z: this.z_m.mean.toFixed(2), zone: t(`zone.${state.zone}`) }) + off);
    this.here.disabled = !this.still.at(now_ms, still);
  }

  /** Moves all zones so that the middle of the working zone is where the operator stands. */
  private async workHere(): Promise<void> {
    const z_m = this.z_m.mean; // as it was when the button was pressed
    let config: Json = {};
    if (!(await act(api.config().then((running) => (config = running))))) return;
    const length_m = (name: string) => Number(valueAt(config, `${SECTION}.${name}`));
    const l1_m = Math.round(100 * (z_m - length_m("l2_m") - length_m("l3_m") / 2)) / 100;
    await this.send(new Map([[`${SECTION}.l1_m`, l1_m]]));
  }

  private async send(lengths_m: ReadonlyMap<string, number>): Promise<void> {
    this.note.textContent = "";
    try {
      await api.changeConfig(treeOf(lengths_m));
      const l1_m = lengths_m.get(`${SECTION}.l1_m`) ?? this.settings[0]?.value ?? "";
      this.done = t("calibrate.zones.result", { z: String(l1_m) });
      await this.load();
    } catch (error) {
      if (!(error instanceof RequestError)) throw error;
      const by = refusals(error.message, [...lengths_m.keys()]);
      for (const row of this.settings) row.refuse(by.get(row.field.path) ?? null);
      this.note.textContent = by.get("") ?? "";
      this.element.querySelector("details")?.setAttribute("open", "");
    }
  }

  result(): string {
    return this.done;
  }
}
