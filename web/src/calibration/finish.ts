/** What was set, and how to keep it beyond the next start of the server. */

import { act } from "../act";
import { api } from "../api";
import { h } from "../dom";
import { t, translated } from "../i18n";
import { fieldsOf, valueAt } from "../settings/schema";
import { download, toml } from "../settings/toml";
import type { Step } from "./step";

const SECTIONS = ["teleop.intent.level", "teleop.intent.zones"];

export class FinishStep implements Step {
  readonly title = "calibrate.finish" as const;
  readonly element: HTMLElement;
  private readonly results = h("ul");
  private readonly keep = translated(h("button", { class: "button", type: "button" }), "settings.download");

  constructor(private readonly steps: readonly Step[]) {
    this.element = h("div", {}, this.results, translated(h("p"), "calibrate.finish.text"), this.keep);
    this.keep.addEventListener("click", () => void act(this.save()));
  }

  enter(): void {
    const lines = this.steps.map((step) => step.result()).filter((line) => line !== "");
    this.results.replaceChildren(...(lines.length > 0 ? lines : [t("calibrate.nothing")]).map((line) => h("li", {}, line)));
  }

  state(): void {}

  result(): string {
    return "";
  }

  private async save(): Promise<void> {
    const [schema, config] = await Promise.all([api.configSchema(), api.config()]);
    const paths = SECTIONS.flatMap((section) => fieldsOf(schema, section)).map((field) => field.path);
    download("teleop.toml", toml(new Map(paths.map((path) => [path, valueAt(config, path) ?? null]))));
  }
}
