/** The server's recordings, to pick one from. */

import { act } from "../act";
import { type Recording, RequestError, api } from "../api";
import { h } from "../dom";
import { t, translated } from "../i18n";
import { Sheet } from "../sheet";
import { clock } from "./replay";

export class RecordingsSheet {
  private readonly list = h("div", { class: "recordings" });
  private readonly loop = h("input", { type: "checkbox", checked: true });
  private readonly file = h("input", { type: "file", accept: ".mcap", class: "unseen" });
  private readonly uploadText = translated(h("span"), "recordings.upload");
  private readonly sheet = new Sheet(
    "panel.recordings",
    this.list,
    h(
      "div",
      { class: "recordings-foot" },
      h("label", { class: "check" }, this.loop, translated(h("span"), "recordings.loop")),
      h("label", { class: "button" }, this.file, this.uploadText),
    ),
  );
  readonly element = this.sheet.element;

  constructor() {
    this.file.addEventListener("change", () => void this.upload());
  }

  async open(): Promise<void> {
    this.list.replaceChildren();
    this.sheet.open();
    await this.refresh();
  }

  private async refresh(): Promise<void> {
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

  private async upload(): Promise<void> {
    const file = this.file.files?.[0];
    if (!file) return;
    this.file.disabled = true;
    translated(this.uploadText, "recordings.uploading");
    if (await act(api.upload(file))) await this.refresh();
    translated(this.uploadText, "recordings.upload");
    this.file.disabled = false;
    this.file.value = ""; // the same file may be chosen again
  }

  private async choose(recording: Recording): Promise<void> {
    if (await act(api.openSession(recording.uri, this.loop.checked))) this.sheet.close();
  }
}
