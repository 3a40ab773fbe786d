/** The server's recordings, to pick one from. */

import { act } from "../act";
import { type Recording, RequestError, api } from "../api";
import { h } from "../dom";
import { t, titled, translated } from "../i18n";
import { clock } from "./replay";

export class RecordingsDialog {
  readonly element = h("dialog", { class: "sheet" });
  private readonly list = h("div", { class: "recordings" });
  private readonly loop = h("input", { type: "checkbox", checked: true });

  constructor() {
    const close = titled(h("button", { class: "button round", type: "button" }, "×"), "button.close");
    close.addEventListener("click", () => this.element.close());
    this.element.append(
      h("header", {}, translated(h("h2"), "panel.recordings"), close),
      this.list,
      h("label", { class: "check" }, this.loop, translated(h("span"), "recordings.loop")),
    );
  }

  async open(): Promise<void> {
    this.list.replaceChildren();
    if (!this.element.open) this.element.showModal();
    try {
      const recordings = await api.recordings();
      this.list.replaceChildren(...recordings.map((recording) => this.entry(recording)));
      if (recordings.length === 0) this.list.append(h("p", {}, t("recordings.empty")));
    } catch (error) {
      if (!(error instanceof RequestError)) throw error;
      this.list.replaceChildren(h("p", { class: "bad" }, error.message));
    }
  }

  private entry(recording: Recording): HTMLElement {
    const megabytes = `${(recording.size_bytes / 1e6).toFixed(1)} MB`;
    const length = recording.duration_s === null ? "" : clock(recording.duration_s);
    const button = h("button", { class: "recording", type: "button" }, h("b", {}, recording.name), h("span", {}, length), h("span", {}, megabytes));
    button.addEventListener("click", () => void this.choose(recording));
    return button;
  }

  private async choose(recording: Recording): Promise<void> {
    if (await act(api.openSession(recording.uri, this.loop.checked))) this.element.close();
  }
}
