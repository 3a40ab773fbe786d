/** The server's recordings: play one, try it with other settings, take it away as a file, remove it; live sources. */

import { act } from "../act";
import { type ExportFormat, ROOT, type Recording, RequestError, api } from "../api";
import { clock } from "../clock";
import { h } from "../dom";
import { language, t, titled, translated } from "../i18n";
import { icon } from "../icons";
import { Sheet } from "../sheet";
import { JobsList, size } from "./jobs";

const VIRTUAL = "virtual:live";
const SOURCES = ["openni2:", "freenect:", "realsense:", "orbbec:", "virtual:", VIRTUAL];
const FORMATS: readonly ExportFormat[] = ["csv", "mp4", "lerobot"];

export class RecordingsSheet {
  private readonly list = h("div", { class: "recordings" });
  private readonly loop = h("input", { type: "checkbox", checked: true });
  private readonly record = h("input", { type: "checkbox" });
  private readonly file = h("input", { type: "file", accept: ".mcap", class: "unseen" });
  private readonly uploadText = translated(h("span"), "recordings.upload");
  private readonly sent = titled(h("progress", { max: 1, value: 0, hidden: true }), "recordings.uploading");
  private readonly uri = h("input", { type: "text", placeholder: "openni2:  freenect:  realsense:  orbbec:", list: "sources", spellcheck: false, required: true });
  private readonly jobs = new JobsList(() => this.element.open);
  private readonly sheet: Sheet;
  readonly element: HTMLDialogElement;

  constructor(private readonly whatIf: (recording: Recording) => void) {
    const sources = h("datalist", { id: "sources" }, ...SOURCES.map((uri) => h("option", { value: uri })));
    const open = translated(h("button", { class: "button", type: "submit" }), "recordings.open");
    const virtual = translated(h("button", { class: "button", type: "button" }), "recordings.virtual");
    virtual.addEventListener("click", () => void this.play(VIRTUAL));
    titled(this.uri, "recordings.source");
    const live = h("form", { class: "live-source" }, translated(h("span"), "recordings.source"), this.uri, sources, open, virtual);
    live.addEventListener("submit", (event) => {
      event.preventDefault();
      void this.play(this.uri.value.trim());
    });
    this.sheet = new Sheet(
      "panel.recordings",
      this.list,
      this.jobs.element,
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
    this.element.classList.add("wide");
    this.file.addEventListener("change", () => void this.upload());
  }

  async open(): Promise<void> {
    if (this.list.childElementCount === 0) this.list.append(translated(h("p", { class: "waiting" }), "recordings.loading"));
    this.sheet.open();
    await Promise.all([this.refresh(), this.jobs.refresh()]);
  }

  /** Begins a long job, and shows how it goes on. */
  async begin(asked: Promise<unknown>): Promise<void> {
    await this.open();
    await this.jobs.begin(asked);
  }

  private async refresh(): Promise<void> {
    try {
      const recordings = await api.recordings();
      this.list.replaceChildren(...recordings.map((recording) => this.entry(recording)));
      if (recordings.length === 0) this.list.append(translated(h("p", { class: "waiting" }), "recordings.empty"));
    } catch (error) {
      if (!(error instanceof RequestError)) throw error;
      this.list.replaceChildren(h("p", { class: "bad" }, error.message));
    }
  }

  private entry(recording: Recording): HTMLElement {
    const facts = [
      recording.bundled ? t("recordings.bundled") : new Date(1000 * recording.modified).toLocaleString(language() === "zh" ? "zh-CN" : "en-GB", { dateStyle: "medium", timeStyle: "short" }),
      recording.duration_s === null ? t("recordings.unreadable") : clock(recording.duration_s),
      size(recording.size_bytes),
    ];
    const picture = h("img", { src: `${ROOT}/recordings/${recording.id}/preview.jpg`, alt: "", loading: "lazy", width: 96, height: 72 });
    picture.addEventListener("error", () => picture.classList.add("missing"));
    const play = h(
      "button",
      { class: "recording", type: "button", "data-commands": true },
      picture,
      h("span", { class: "recording-words" }, h("b", {}, recording.name), h("small", {}, facts.join("  ·  "))),
      icon("play"),
    );
    play.addEventListener("click", () => void this.play(recording.uri));
    return h("div", { class: "recording-row" }, play, this.more(recording));
  }

  private more(recording: Recording): HTMLElement {
    const other = this.action("whatif.ask", () => {
      this.sheet.close();
      this.whatIf(recording);
    });
    const save = translated(h("a", { class: "chip", href: `${ROOT}/recordings/${recording.id}`, download: `${recording.id}.mcap` }), "recordings.download");
    const exports = FORMATS.map((format) => this.action(`recordings.${format}`, () => void this.jobs.begin(api.exportRecording(recording.id, format))));
    const verify = this.action("recordings.verify", () => void this.jobs.begin(api.verify(recording.id)));
    const actions = h("div", { class: "recording-actions" }, other, save, ...exports, verify);
    if (!recording.bundled) actions.append(this.remover(recording));
    return actions;
  }

  private action(title: "whatif.ask" | "recordings.verify" | `recordings.${ExportFormat}`, act_: () => void): HTMLElement {
    const button = translated(h("button", { class: "chip", type: "button" }), title);
    button.addEventListener("click", act_);
    return button;
  }

  /** Removing needs a second press: what is recorded is not lost by a slip. */
  private remover(recording: Recording): HTMLElement {
    const remove = translated(h("button", { class: "chip", type: "button" }), "recordings.delete");
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
