/** One setting: its name, input, unit, legal range, what it is, and why a value was refused. */

import { Text, h } from "../dom";
import { language, t, titled } from "../i18n";
import { SETTINGS_ZH } from "../i18n/settings_zh";
import type { Field, Value } from "./schema";

let made = 0;

export class SettingRow {
  readonly element: HTMLElement;
  private readonly input: HTMLInputElement | HTMLSelectElement;
  private readonly refusal = new Text(h("p", { class: "setting-refusal", role: "alert" }));
  private readonly standard = titled(h("button", { class: "chip", type: "button", hidden: true }, "↺"), "settings.standard");
  private readonly about = new Text(h("p", { class: "setting-about" }));
  private running: Value = null;

  constructor(
    readonly field: Field,
    private readonly changed: () => void,
  ) {
    const id = `setting-${made++}`;
    this.about.element.id = `${id}-about`;
    this.input = inputFor(field);
    this.input.id = id;
    this.input.setAttribute("aria-describedby", this.about.element.id);
    this.input.addEventListener("input", () => this.touched());
    this.standard.addEventListener("click", () => {
      this.show(field.standard ?? null);
      this.touched();
    });
    this.element = h(
      "div",
      { class: "setting", "data-path": field.path },
      h("label", { for: id }, field.name),
      h("span", { class: "setting-value" }, this.input, h("span", { class: "setting-unit" }, field.unit), this.standard),
      this.about.element as HTMLElement,
      this.refusal.element as HTMLElement,
    );
    this.relabel();
  }

  /** What it is, in the operator's language. */
  relabel(): void {
    this.about.set(rangeText(this.field) + aboutText(this.field));
  }

  /** Takes the value in force over. */
  load(value: Value): void {
    this.running = value;
    this.show(value);
    this.refuse(null);
    this.mark();
  }

  get value(): Value {
    if (this.field.kind === "boolean") return (this.input as HTMLInputElement).checked;
    if (this.field.kind === "number" || this.field.kind === "integer") return Number(this.input.value);
    return this.input.value;
  }

  get isChanged(): boolean {
    return this.value !== this.running;
  }

  get differsFromStandard(): boolean {
    return this.field.standard !== undefined && this.value !== this.field.standard;
  }

  /** Why the server did not take the value; the one in force stays. */
  refuse(why: string | null): void {
    this.refusal.set(why === null ? "" : t("settings.refused", { why, value: String(this.running) }));
    if (why === null) this.input.removeAttribute("aria-invalid");
    else this.input.setAttribute("aria-invalid", "true");
  }

  matches(words: string): boolean {
    return words === "" || `${this.field.path} ${this.field.about} ${aboutText(this.field)}`.toLowerCase().includes(words);
  }

  set enabled(enabled: boolean) {
    this.input.disabled = this.standard.disabled = !enabled;
  }

  private show(value: Value): void {
    if (this.field.kind === "boolean") (this.input as HTMLInputElement).checked = value === true;
    else this.input.value = String(value ?? "");
  }

  private touched(): void {
    this.refuse(null);
    this.mark();
    this.changed();
  }

  private mark(): void {
    this.element.toggleAttribute("data-changed", this.isChanged);
    this.standard.hidden = !this.differsFromStandard;
  }
}

function aboutText({ path, about }: Field): string {
  return (language() === "zh" ? SETTINGS_ZH[path.replace(/^teleop\./, "")] : undefined) ?? about;
}

function inputFor(field: Field): HTMLInputElement | HTMLSelectElement {
  if (field.kind === "choice") return h("select", {}, ...field.choices.map((choice) => h("option", { value: choice }, choice)));
  if (field.kind === "boolean") return h("input", { type: "checkbox" });
  if (field.kind === "text") return h("input", { type: "text", size: 12 });
  const input = h("input", { type: "number", step: field.kind === "integer" ? 1 : "any" });
  if (field.low !== null) input.min = String(field.low);
  if (field.high !== null) input.max = String(field.high);
  return input;
}

function rangeText(field: Field): string {
  if (field.low === null && field.high === null) return "";
  return `${field.low ?? "…"} – ${field.high ?? "…"}${field.unit ? ` ${field.unit}` : ""} · `;
}
