/** Long jobs of the server: how far they are, what came of them, their files. Asked for only while somebody looks. */

import { act } from "../act";
import { type Job, ROOT, RequestError, api } from "../api";
import { h } from "../dom";
import { lookup, t, titled } from "../i18n";
import { icon } from "../icons";

const ASK_EVERY_MS = 700;
/** Finished ones beyond these are old news. */
const SHOWN = 6;

export class JobsList {
  readonly element = h("div", { class: "jobs", role: "status", "aria-live": "polite" });
  private timer: number | null = null;
  private told = "";

  constructor(private readonly looking: () => boolean) {}

  /** Asks now, and again while a job runs and somebody looks. */
  async refresh(): Promise<void> {
    let jobs: Job[] = [];
    try {
      jobs = await api.jobs();
    } catch (error) {
      if (!(error instanceof RequestError)) throw error;
    }
    this.show(jobs.slice(0, SHOWN));
    const running = jobs.some((job) => job.status === "queued" || job.status === "running");
    if (this.timer !== null) window.clearTimeout(this.timer);
    this.timer = running && this.looking() ? window.setTimeout(() => void this.refresh(), ASK_EVERY_MS) : null;
  }

  /** Begins one and shows it. */
  async begin(asked: Promise<unknown>): Promise<void> {
    if (await act(asked)) await this.refresh();
  }

  private show(jobs: readonly Job[]): void {
    const text = JSON.stringify(jobs) + t("jobs.done");
    if (text === this.told) return; // an open list of lines stays as it is
    this.told = text;
    this.element.replaceChildren(...jobs.map((job) => this.entry(job)));
  }

  private entry(job: Job): HTMLElement {
    const name = (lookup(`jobs.${job.kind}`) ?? job.kind).replace("{name}", job.detail);
    const status = job.status === "running" ? t("jobs.running", { percent: (100 * job.progress).toFixed(0) }) : t(`jobs.${job.status}`);
    const row = h("div", { class: "job", "data-status": job.status }, h("b", {}, name), h("span", {}, status));
    if (job.status === "queued" || job.status === "running") {
      row.append(h("progress", { max: 1, value: job.progress, "aria-label": name }), this.cancel(job));
    }
    if (job.error) row.append(h("p", { class: "bad" }, job.error));
    const { file, bytes, lines } = job.result ?? {};
    if (file) {
      const words = t("jobs.save", { file, size: size(bytes ?? 0) });
      row.append(h("a", { class: "button", href: `${ROOT}/jobs/${job.id}/file`, download: file }, icon("download"), words));
    }
    if (lines) row.append(h("pre", { tabindex: 0 }, lines.join("\n")));
    return row;
  }

  private cancel(job: Job): HTMLElement {
    const button = titled(h("button", { class: "chip", type: "button" }, "×"), "jobs.cancel");
    button.addEventListener("click", () => void this.begin(api.cancelJob(job.id)));
    return button;
  }
}

export function size(bytes: number): string {
  return bytes < 1e6 ? `${(bytes / 1e3).toFixed(0)} kB` : `${(bytes / 1e6).toFixed(1)} MB`;
}
