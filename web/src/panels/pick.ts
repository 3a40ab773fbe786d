/** The assisted pick over the 3-D view: which fruit, how far it is, confirming and ending it. */

import { act, notify } from "../act";
import { api } from "../api";
import { Attribute, Text, h } from "../dom";
import { fruitWords } from "../fruit";
import { type Key, lookup, reasonText, t, titled, translated } from "../i18n";
import { icon } from "../icons";
import type { FruitInfo, Hello, State, TaskStage, TaskState } from "../wire";

const STAGES: readonly TaskStage[] = ["align", "approach", "clamp", "hold", "cut", "retreat", "box"];
/** How long the end of a pick stays in view. */
const SHOWN_MS = 8_000;

export class PickCard {
  readonly element: HTMLElement;
  private readonly title = new Text(h("strong"));
  private readonly words = new Text(h("span", { class: "pick-words" }));
  private readonly bar = h("i");
  private readonly width = new Attribute(this.bar, "style");
  private readonly chips = STAGES.map((stage) => {
    const chip = translated(h("li", { "data-stage": stage }), `task.stage.${stage}`);
    return { stage, at: new Attribute(chip, "data-at"), chip };
  });
  private readonly start = translated(h("button", { class: "button pick-start", type: "button" }), "task.start");
  private readonly end = translated(h("button", { class: "button pick-end", type: "button" }), "task.end");
  private readonly nearest = titled(h("button", { class: "chip pick-nearest", type: "button" }), "task.nearest.title");
  private readonly look: Attribute;
  private fruits = new Map<string, FruitInfo>();
  private task: TaskState | null = null;
  private ended_ms = -Infinity;
  private seen = "";

  constructor() {
    this.nearest.append(icon("picking"), translated(h("span"), "task.nearest"));
    const head = h("div", { class: "pick-head" }, this.title.element, this.words.element);
    const buttons = h("div", { class: "pick-buttons", "data-commands": true }, this.start, this.end);
    this.element = h(
      "div",
      { class: "pick", "data-task": "none" },
      h("div", { class: "pick-ask", "data-commands": true }, this.nearest, translated(h("small"), "task.hint")),
      h(
        "div",
        { class: "pick-card", role: "status", "aria-live": "polite" },
        head,
        buttons,
        h("span", { class: "meter" }, this.bar),
        h("ol", {}, ...this.chips.map(({ chip }) => chip)),
      ),
    );
    this.look = new Attribute(this.element, "data-task");
    this.start.addEventListener("click", () => void this.confirm());
    this.end.addEventListener("click", () => void this.cancel());
    this.nearest.addEventListener("click", () => void this.ask(null));
  }

  hello(hello: Hello): void {
    this.fruits = new Map(hello.fruits.map((fruit) => [fruit.name, fruit]));
    this.element.hidden = hello.fruits.length === 0;
  }

  /** Shows the path to a fruit (null: the nearest ripe one); nothing moves before it is confirmed. */
  async ask(fruit: string | null): Promise<void> {
    if (document.body.classList.contains("locked")) return;
    await act(this.asked(fruit));
  }

  private async asked(fruit: string | null): Promise<void> {
    const task = await api.pick(fruit, true);
    if (task.status === "refused") notify(t("task.refused", { fruit: this.called(task.fruit), detail: ended(task) }));
  }

  /** G: the nearest ripe fruit, and again: begin. */
  key(): void {
    void (this.task?.status === "preview" && !this.task.attended ? this.confirm() : this.ask(null));
  }

  private async confirm(): Promise<void> {
    if (this.task) await act(api.confirmTask(this.task.id));
  }

  private async cancel(): Promise<void> {
    if (this.task) await act(api.cancelTask(this.task.id));
  }

  /** Name, state and ripeness of a fruit for people: "cucumber 2.1". */
  called(name: string): string {
    const words = fruitWords(name);
    return this.fruits.get(name)?.ripe === false ? t("task.unripe", { fruit: words }) : words;
  }

  state(state: State, now_ms: number): void {
    const task = state.task;
    const aimed = state.aim;
    if (aimed) {
      this.look.set("aim");
      this.title.set(aimed.fruit === null ? t("task.aim.none") : this.called(aimed.fruit));
      this.words.set(t(aimed.fruit === null ? "task.aim.point" : "task.aim.hold"));
      this.width.set(percent(aimed.progress));
      return;
    }
    const mark = task ? `${task.id} ${task.status}` : "";
    if (mark !== this.seen) {
      // what had ended before this page was opened is old news
      const fresh = task !== null && (task.ended === null || this.seen !== "" || state.t - task.ended < SHOWN_MS / 1e3);
      this.ended_ms = fresh ? now_ms : -Infinity;
      this.seen = mark;
    }
    const over = task !== null && task.ended !== null;
    this.task = task === null || (over && now_ms - this.ended_ms > SHOWN_MS) ? null : task;
    this.look.set(this.task?.status ?? "none");
    if (this.task) this.show(this.task);
  }

  private show(task: TaskState): void {
    this.title.set(this.called(task.fruit));
    this.words.set(wordsOf(task));
    this.width.set(percent(task.progress));
    this.start.hidden = task.status !== "preview" || task.attended;
    this.end.hidden = task.ended !== null;
    const now = task.stage === null ? -1 : STAGES.indexOf(task.stage);
    this.chips.forEach(({ at }, i) => {
      const done = i < now || task.status === "succeeded";
      at.set(done ? "done" : i > now ? "later" : task.ended === null ? "now" : "broken");
    });
  }
}

function percent(share: number): string {
  return `width:${(100 * share).toFixed(0)}%`;
}

/** What to do about a pick that ended early: the server's own sentence is English, so the code's words come first. */
function ended(task: TaskState): string {
  const words = lookup(`reason.${task.reason}`);
  if (task.forward_m !== null) return t(task.forward_m > 0 ? "task.forward" : "task.back", { m: Math.abs(task.forward_m).toFixed(2) });
  return words ?? task.detail;
}

function wordsOf(task: TaskState): string {
  switch (task.status) {
    case "preview":
      if (task.attended) return t(task.confirmed ? "task.close" : "task.fist");
      return t("task.confirm");
    case "running":
      return task.attended ? t("task.keep") : t(`task.doing.${task.stage ?? "align"}` as Key);
    case "succeeded":
      return t("task.done");
    default:
      return task.reason ? ended(task) : reasonText(task.status);
  }
}
