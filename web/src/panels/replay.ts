/** What is playing: name, timeline, play, step, speed, recording it, and the other recordings. */

import { act } from "../act";
import { RequestError, api } from "../api";
import { clock } from "../clock";
import { Attribute, Text, h } from "../dom";
import { t, titled, translated } from "../i18n";
import { icon, setIcon } from "../icons";
import { type Panel, frame } from "../panel";
import { Timeline } from "../timeline";
import type { EventMessage, SourceState, State } from "../wire";
import type { RecordingsSheet } from "./recordings";

const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4, 8] as const;
const SEEK_S = 5;
/** After a change the controls wait this long for states that know of it. */
const SETTLE_MS = 600;
const OPENED = "source.opened";

export class ReplayPanel implements Panel {
  readonly element: HTMLElement;
  private readonly glyph = icon("pause");
  private readonly play = titled(h("button", { class: "button round", type: "button" }, this.glyph), "replay.play");
  private readonly next = titled(h("button", { class: "button round", type: "button" }, icon("step")), "replay.step");
  private readonly timeline = new Timeline();
  private readonly slider = this.timeline.slider;
  private readonly loop = titled(h("button", { class: "button round", type: "button" }, icon("loop")), "replay.loop");
  private readonly looping = new Attribute(this.loop, "aria-pressed");
  private readonly speed = titled(h("select", {}), "replay.speed");
  private readonly record = titled(h("button", { class: "button round record", type: "button" }, icon("record")), "replay.record");
  private readonly recording = new Attribute(this.record, "aria-pressed");
  private readonly name = new Text(h("b", { class: "source-name" }));
  private readonly marks = new Text(h("span", { class: "source-marks" }));
  private readonly time = new Text(h("output"));
  private readonly live: Attribute;
  private source: SourceState | null = null;
  /** The recording whose story was asked for. */
  private told = "";
  private quiet_until_ms = 0;
  private dragging = false;

  constructor(recordings: RecordingsSheet) {
    for (const speed of SPEEDS) this.speed.append(h("option", { value: speed, selected: speed === 1 }, `${speed} ×`));
    this.play.addEventListener("click", () => this.toggle());
    this.next.addEventListener("click", () => this.stepFrame());
    this.slider.addEventListener("input", () => {
      this.dragging = true;
      this.showTime(Number(this.slider.value));
    });
    this.slider.addEventListener("change", () => {
      this.dragging = false;
      this.seek(Number(this.slider.value));
    });
    this.speed.addEventListener("change", () => this.sendSpeed());
    this.loop.addEventListener("click", () => this.toggleLoop());
    this.record.addEventListener("click", () => this.toggleRecord());
    const open = translated(h("button", { class: "button", type: "button" }), "replay.recordings");
    open.addEventListener("click", () => void recordings.open());
    const { element, tools } = frame(
      "replay",
      "panel.replay",
      h("div", { class: "replayed", "data-commands": true }, this.timeline.element),
      h(
        "div",
        { class: "transport" },
        h("div", { class: "replayed", "data-commands": true }, this.play, this.next, this.time.element, h("span", { class: "gap" }), this.loop, this.speed),
        h("span", { "data-commands": true }, this.record),
        open,
      ),
    );
    tools.append(this.name.element, this.marks.element);
    this.element = element;
    this.live = new Attribute(element, "data-live");
  }

  toggle(): void {
    if (this.source?.live !== false) return;
    void act(this.source.paused || this.source.ended ? api.play() : api.pause());
  }

  /** Shows the one frame that comes next. */
  stepFrame(): void {
    if (this.source?.live === false) void act(api.step());
  }

  toggleLoop(): void {
    if (this.source?.live === false) void act(api.loop(!this.source.loop));
  }

  /** Records what the source gives from now on, or ends the recording: the source is opened anew for it. */
  toggleRecord(): void {
    const source = this.source;
    if (source) void act(api.openSession({ source: source.uri, loop: source.loop, record: !source.recording }));
  }

  /** Moves by some steps of five seconds. */
  step(steps: number): void {
    if (this.source?.live === false) this.seek(this.source.position_s + steps * SEEK_S);
  }

  /** One speed up or down. */
  changeSpeed(steps: number): void {
    const index = this.speed.selectedIndex + steps;
    if (this.source?.live !== false || index < 0 || index >= SPEEDS.length) return;
    this.speed.selectedIndex = index;
    this.sendSpeed();
  }

  private sendSpeed(): void {
    this.quiet_until_ms = performance.now() + SETTLE_MS;
    void act(api.speed(Number(this.speed.value)));
  }

  private seek(position_s: number): void {
    const end = this.source?.duration_s ?? 0;
    this.quiet_until_ms = performance.now() + SETTLE_MS;
    void act(api.seek(Math.min(Math.max(0, position_s), Math.max(0, end))));
  }

  private showTime(position_s: number): void {
    const duration = this.source?.duration_s;
    this.time.set(duration == null ? clock(position_s) : `${clock(position_s)} / ${clock(duration)}`);
  }

  event(event: EventMessage): void {
    if (event.reason === OPENED) {
      this.timeline.clear();
      this.told = "";
    }
    this.timeline.event(event);
  }

  /** What the recording says of itself, for the timeline; one that is not in the library says nothing. */
  private async tell(source: SourceState): Promise<void> {
    this.told = source.uri;
    if (source.kind !== "mcap") return;
    try {
      const story = await api.story(source.uri);
      if (this.told === source.uri) this.timeline.tell(story);
    } catch (error) {
      if (!(error instanceof RequestError)) throw error;
    }
  }

  restyle(): void {
    this.timeline.restyle();
  }

  state(state: State, now_ms: number): void {
    const source = state.source;
    this.source = source;
    this.live.set(String(source?.live ?? true));
    if (!source) {
      this.name.set(t("replay.none"));
      this.marks.set("");
      return;
    }
    this.name.set(source.uri.split("/").at(-1) ?? source.uri);
    const marks: string[] = [];
    if (source.live) marks.push(t("replay.live"));
    if (source.ended) marks.push(t("replay.ended"));
    if (source.recording) marks.push(`● ${t("replay.recording")}`);
    this.marks.set(marks.join(" · "));
    this.looping.set(String(source.loop));
    this.recording.set(String(source.recording));
    setIcon(this.glyph, source.paused || source.ended ? "play" : "pause");
    if (source.live) return;
    this.timeline.extend(source.duration_s ?? 0);
    if (this.told !== source.uri) void this.tell(source);
    if (!source.paused) this.timeline.play(source.position_s, state.mode);
    if (this.dragging || now_ms < this.quiet_until_ms) return;
    this.slider.value = String(source.position_s);
    this.showTime(source.position_s);
    if (document.activeElement !== this.speed) this.speed.value = String(source.speed);
  }
}
