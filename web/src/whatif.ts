/** What if: a recording replayed with other settings, and the way back to those before. Survives a reload of the page. */

import { act } from "./act";
import { type Recording, api } from "./api";
import { h } from "./dom";
import { t, translated } from "./i18n";
import { type Value, treeOf } from "./settings/schema";
import type { SettingsSheet } from "./settings/sheet";

const STORED = "greenhouse-what-if";

interface Trial {
  recording: string;
  before: [path: string, value: Value][];
  after: [path: string, value: Value][];
}

export class WhatIf {
  private readonly text = h("span");
  private readonly again = translated(h("button", { class: "button", type: "button" }), "whatif.again");
  private readonly back = translated(h("button", { class: "button", type: "button" }), "whatif.back");
  private readonly differ = translated(h("button", { class: "button", type: "button" }), "whatif.differ");
  readonly element = h("aside", { class: "whatif", hidden: true, "data-commands": true }, this.text, this.again, this.differ, this.back);
  private trial: Trial | null = null;

  /** begin: shows how a long job goes on, and what came of it. */
  constructor(
    private readonly settings: SettingsSheet,
    private readonly begin: (job: Promise<unknown>) => void,
  ) {
    const stored = sessionStorage.getItem(STORED);
    this.set(stored === null ? null : (JSON.parse(stored) as Trial));
    this.again.addEventListener("click", () => void this.replay());
    this.differ.addEventListener("click", () => this.compare());
    this.back.addEventListener("click", () => void this.restore());
  }

  /** Asks for other settings, then plays the recording with them from its start. */
  ask(recording: Recording): void {
    void this.settings.open((before, after) => {
      const same = this.trial?.recording === recording.uri ? this.trial : null;
      const known = new Map(same?.before);
      for (const [path, value] of before) if (!known.has(path)) known.set(path, value);
      this.set({ recording: recording.uri, before: [...known], after: [...new Map([...(same?.after ?? []), ...after])] });
      void this.replay();
    });
  }

  restyle(): void {
    if (this.trial) this.text.textContent = t("whatif.text", { name: this.trial.recording, count: this.trial.before.length });
  }

  private async replay(): Promise<void> {
    if (this.trial) await act(api.openSession({ source: this.trial.recording, loop: true, record: false }));
  }

  /** The whole session once more under these settings, off to the side, and in words what would have been different. */
  private compare(): void {
    if (this.trial) this.begin(api.whatIf(this.trial.recording, treeOf(new Map(this.trial.after))));
  }

  private async restore(): Promise<void> {
    if (this.trial && (await act(api.changeConfig(treeOf(new Map(this.trial.before)))))) this.set(null);
  }

  private set(trial: Trial | null): void {
    this.trial = trial;
    this.element.hidden = trial === null;
    if (trial) sessionStorage.setItem(STORED, JSON.stringify(trial));
    else sessionStorage.removeItem(STORED);
    this.restyle();
  }
}
