/** The server's recordings: play one, record it anew, try it with other settings, add and remove; live sources. */

import { act } from "../act";
import { type Recording, RequestError, api } from "../api";
import { clock } from "../clock";
import { h } from "../dom";
import { t, titled, translated } from "../i18n";
import { Sheet } from "../sheet";

export class RecordingsSheet {
  private readonly list = h("div", { class: "recordings" });
  private readonly loop = h("input", { type: "checkbox", checked: true });
  private readonly record = h("input", { type: "checkbox" });
  private readonly file = h("input", { type: "file", accept: ".mcap", class: "unseen" });
  private readonly uploadText = translated(h("span"), "recordings.upload");
  private readonly sent = titled(h("progress", { max: 1, value: 0, hidden: true }), "recordings.uploading");
  private readonly uri = h("input", { type: "text", placeholder: "openni2:  freenect:  realsense:  orbbec:  virtual:", list: "sources", spellcheck: false, required: true });
  private readonly sheet: Sheet;
  readonly element: HTMLDialogElement;

  constructor(private readonly whatIf: (recording: Recording) => void) {
    const sources = h("datalist", { id: "sources" }, ...["openni2:", "freenect:", "realsense:", "orbbec:", "virtual:"].map((uri) => h("option", { value: uri })));
    const open = translated(h("button", { class: "button", type: "submit" }), "recordings.open");
    titled(this.uri, "recordings.source");
    const live = h("form", { class: "live-source" }, translated(h("span"), "recordings.source"), this.uri, sources, open);
    live.addEventListener("submit", (event) => {
      event.preventDefault();
      void this.play(this.uri.value.trim());
    });
    this.sheet = new Sheet(
      "panel.recordings",
      this.list,
      live,
      h(
        "div",
        { class: "sheet-foot" },
        h("label", { class: "check" }, this.loop, translated(h("span"), "recordings.loop")),
        h("label", { class: "check" }, this.record, translated(h("span"), "recordings.record")),
        this.sent,
        h("label", { class: "button" }, this.file, this.uploadText),
      ),
    );
    this.element = this.sheet.element;
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
    const play = h("button", { class: "recording", type: "button" }, h("b", {}, recording.name), h("span", {}, length), h("span", {}, megabytes));
    play.addEventListener("click", () => void this.play(recording.uri));
    const other = translated(h("button", { class: "button", type: "button" }), "whatif.ask");
    other.addEventListener("click", () => {
      this.sheet.close();
      this.whatIf(recording);
    });
    const row = h("div", { class: "recording-row" }, play, other);
    if (!recording.bundled) row.append(this.remover(recording));
    return row;
  }

  /** Removing needs a second press: what is recorded is not lost by a slip. */
  private remover(recording: Recording): HTMLElement {
    const remove = translated(h("button", { class: "button", type: "button" }), "recordings.delete");
    remove.addEventListener("click", () => {
      if (!remove.hasAttribute("data-sure")) {
        remove.setAttribute("data-sure", "");
        translated(remove, "recordings.sure");
        return;
      }
      void act(api.deleteRecording(recording.id)).then(() => this.refresh());
    });
    remove.addEventListener("blur", () => {
      remove.removeAttribute("data-sure");
      translated(remove, "recordings.delete");
    });
    return remove;
  }

  private async upload(): Promise<void> {
    const file = this.file.files?.[0];
    if (!file) return;
    this.file.disabled = true;
    this.sent.hidden = false;
    this.sent.value = 0;
    translated(this.uploadText, "recordings.uploading");
    const sent = api.upload(file, (share) => {
      this.sent.value = share;
      this.uploadText.textContent = `${t("recordings.uploading")} ${(100 * share).toFixed(0)} %`;
    });
    if (await act(sent)) await this.refresh();
    translated(this.uploadText, "recordings.upload");
    this.sent.hidden = true;
    this.file.disabled = false;
    this.file.value = ""; // the same file may be chosen again
  }

  private async play(source: string): Promise<void> {
    if (await act(api.openSession({ source, loop: this.loop.checked, record: this.record.checked }))) this.sheet.close();
  }
}
