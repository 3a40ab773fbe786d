/** The settings: a form made from the configuration's own schema. Only what can change while the server runs. */

import { act, notify } from "../act";
import { RequestError, api } from "../api";
import { h } from "../dom";
import { hinted, language, t, translated } from "../i18n";
import { SECTIONS_ZH } from "../i18n/settings_zh";
import { Sheet } from "../sheet";
import { SettingRow } from "./row";
import { type Json, type Value, fieldsOf, refusals, treeOf, valueAt } from "./schema";
import { download, toml } from "./toml";

/** The part of the tree that the server takes while it runs. */
const LIVE = "teleop";
const FILE = "teleop.toml";

/** Called with the values that were in force before and those that are now, once new ones are taken. */
export type Applied = (before: ReadonlyMap<string, Value>, after: ReadonlyMap<string, Value>) => void;

export class SettingsSheet {
  private readonly search = hinted(h("input", { type: "search", class: "search" }), "settings.search");
  private readonly list = h("div", { class: "settings" }, translated(h("p", { class: "waiting" }), "settings.loading"));
  private readonly nothing = translated(h("p", { class: "waiting", hidden: true }), "settings.nothing");
  private readonly note = h("p", { class: "setting-refusal", role: "alert" });
  private readonly apply = translated(h("button", { class: "button primary", type: "submit", disabled: true }), "settings.apply");
  private readonly undo = translated(h("button", { class: "button", type: "button" }), "settings.undo");
  private readonly keep = translated(h("button", { class: "button", type: "button" }), "settings.download");
  private readonly count = h("span", { class: "settings-count" });
  private readonly form = h(
    "form",
    { class: "settings-form", novalidate: true },
    this.search,
    this.list,
    this.nothing,
    this.note,
    h("div", { class: "sheet-foot" }, this.count, this.keep, this.undo, this.apply),
  );
  private readonly sheet = new Sheet("panel.settings", this.form);
  readonly element = this.sheet.element;
  private rows: SettingRow[] = [];
  private applied: Applied | null = null;

  constructor() {
    this.element.classList.add("wide");
    this.search.addEventListener("input", () => this.filter());
    this.undo.addEventListener("click", () => void this.load());
    this.keep.addEventListener("click", () => this.save());
    this.form.addEventListener("submit", (event) => {
      event.preventDefault();
      void this.send();
    });
  }

  /** Opens the form; applied: told of the change, once, instead of leaving it at a notice. */
  async open(applied: Applied | null = null): Promise<void> {
    this.applied = applied;
    translated(this.apply, applied ? "settings.try" : "settings.apply");
    this.sheet.open();
    await this.load();
  }

  toggle(): void {
    if (this.element.open) this.sheet.close();
    else void this.open();
  }

  private async load(): Promise<void> {
    let config: Json = {};
    const done = await act(
      (async () => {
        config = await api.config();
        if (this.rows.length === 0) this.build(fieldsOf(await api.configSchema(), LIVE).map((f) => new SettingRow(f, () => this.show())));
      })(),
    );
    if (!done) return;
    for (const row of this.rows) row.load(valueAt(config, row.field.path) ?? null);
    this.note.textContent = "";
    this.show();
  }

  private build(rows: SettingRow[]): void {
    this.rows = rows;
    const sections = new Map<string, HTMLElement>();
    for (const row of rows) {
      let section = sections.get(row.field.section);
      if (!section) {
        section = h("details", { class: "setting-section" }, h("summary", { "data-section": row.field.section }));
        sections.set(row.field.section, section);
      }
      section.append(row.element);
    }
    this.list.replaceChildren(...sections.values());
    this.restyle();
    this.filter(); // words may have been typed already
  }

  /** The language changed. */
  restyle(): void {
    for (const row of this.rows) row.relabel();
    for (const summary of this.list.querySelectorAll("summary")) summary.textContent = sectionName(summary.dataset["section"] ?? "");
  }

  private filter(): void {
    const words = this.search.value.trim().toLowerCase();
    for (const row of this.rows) row.element.hidden = !row.matches(words);
    this.nothing.hidden = this.rows.length === 0 || this.rows.some((row) => !row.element.hidden);
    for (const section of this.list.querySelectorAll("details")) {
      const hits = section.querySelectorAll(".setting:not([hidden])").length;
      section.hidden = hits === 0;
      section.open = words !== "" && hits > 0;
    }
  }

  private get changed(): SettingRow[] {
    return this.rows.filter((row) => row.isChanged);
  }

  private show(): void {
    const changed = this.changed.length;
    this.apply.disabled = this.undo.disabled = changed === 0;
    this.count.textContent = changed === 0 ? "" : t("settings.changed", { count: changed });
    this.keep.disabled = !this.rows.some((row) => row.differsFromStandard);
  }

  private async send(): Promise<void> {
    const changed = this.changed;
    const before = new Map<string, Value>(changed.map((row) => [row.field.path, row.field.standard ?? null]));
    this.note.textContent = "";
    try {
      const running = await api.config();
      for (const row of changed) before.set(row.field.path, valueAt(running, row.field.path) ?? null);
      const config = await api.changeConfig(treeOf(new Map(changed.map((row) => [row.field.path, row.value]))));
      for (const row of this.rows) row.load(valueAt(config, row.field.path) ?? null);
    } catch (error) {
      if (!(error instanceof RequestError)) throw error;
      this.refuse(error.message, changed);
      return;
    }
    this.show();
    if (this.applied) {
      this.sheet.close();
      this.applied(before, new Map(changed.map((row) => [row.field.path, row.value])));
    } else notify(t("settings.done"));
  }

  /** Each refusal at its field; what concerns several of them at the foot. */
  private refuse(detail: string, changed: readonly SettingRow[]): void {
    const by = refusals(detail, changed.map((row) => row.field.path));
    for (const row of changed) {
      row.refuse(by.get(row.field.path) ?? null);
      if (by.has(row.field.path)) row.element.closest("details")?.setAttribute("open", "");
    }
    this.note.textContent = by.get("") ?? "";
    this.rows.find((row) => by.has(row.field.path))?.element.scrollIntoView({ block: "nearest" });
  }

  private save(): void {
    const own = this.rows.filter((row) => row.differsFromStandard);
    download(FILE, toml(new Map(own.map((row) => [row.field.path, row.value]))));
  }
}

/** `teleop.body.filter`: Body · filter. */
function sectionName(path: string): string {
  const parts = path.split(".").slice(1);
  const word = (part: string) => (language() === "zh" ? SECTIONS_ZH[part] : undefined) ?? part.replaceAll("_", " ");
  return (parts.length ? parts : [path]).map(word).join(" · ");
}
