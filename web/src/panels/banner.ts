/** The line that must be legible at 3 m: mode, reason, engage ring, emergency stop. */

import { act, emergencyStop } from "../act";
import { api } from "../api";
import type { Link } from "../connection";
import { Attribute, Text, h, s } from "../dom";
import { type Key, reasonText, t, titled, translated } from "../i18n";
import { type IconName, icon, setIcon } from "../icons";
import type { Panel } from "../panel";
import type { State } from "../wire";

const ICONS: Record<State["mode"], IconName> = {
  no_person: "nobody",
  seen: "eye",
  engaged: "engaged",
  picking: "picking",
  spraying: "spraying",
  forward: "forward",
  back: "back",
  left: "left",
  right: "right",
  held: "held",
  stopped: "stopped",
};
const RING_LENGTH = 100;
/** Codes that say what happens all the time and would hide what the operator should know. */
const QUIET = /^(mode|limit)\.|^hold\.arm_locked$/;

/** More letters than this do not fit at full size on a screen 1280 wide. */
const LONG = 37;

/** The reason to show large: a stop before a hold before a refusal; null when there is none. */
export function mainReason(reasons: readonly string[]): string | null {
  const loud = reasons.filter((code) => !QUIET.test(code));
  for (const kind of ["stop.", "hold.", "refused."]) {
    const found = loud.find((code) => code.startsWith(kind));
    if (found !== undefined) return found;
  }
  return loud[0] ?? null;
}

/** The line under the mode. A robot that picks without an operator is not stopped because nobody is seen. */
function words(state: State): string {
  if (state.task?.status === "running" && !state.task.attended) return t("task.byitself");
  const reason = mainReason(state.reasons);
  return reason === null ? t(`hint.${state.mode}`) : reasonText(reason);
}

/** Whether what moves the robot is a person now, or a recording of one: nobody should have to guess. */
function sourceKind(source: State["source"]): "none" | "fault" | "live" | "virtual" | "paused" | "replay" {
  if (!source) return "none";
  if (source.fault) return "fault";
  if (source.kind === "virtual") return "virtual";
  if (source.live) return "live";
  return source.paused || source.ended ? "paused" : "replay";
}

export class Banner implements Panel {
  readonly element: HTMLElement;
  private readonly glyph = icon("eye");
  private readonly ring = s("circle", { class: "ring-value", cx: 20, cy: 20, r: 17.5, pathLength: RING_LENGTH });
  private readonly ringOffset = new Attribute(this.ring, "stroke-dashoffset");
  private readonly modeText = new Text(h("strong", { class: "mode" }));
  private readonly reason = new Text(h("span", { class: "reason" }));
  private readonly long = new Attribute(this.reason.element, "data-long");
  private readonly link = h("span", { class: "link", "data-link": "connecting" });
  private readonly source = new Text(h("span", { class: "source-badge" }));
  private readonly sourceLook = new Attribute(this.source.element, "data-source");
  private readonly engage = titled(h("button", { class: "button engage", type: "button" }), "button.engage.title");
  private readonly reset = titled(h("button", { class: "button reset", type: "button" }), "button.reset.title");
  private readonly look: Attribute;
  private readonly stopLook: Attribute;
  private readonly engageText = new Text(this.engage);
  private engaged = false;

  constructor(tools: HTMLElement, lease: HTMLElement) {
    const stop = titled(h("button", { class: "estop", type: "button" }), "button.estop.title");
    stop.append(icon("stopped"), translated(h("span"), "button.estop"));
    // Pointer down, not click: a stop does not wait for the finger to leave the button.
    stop.addEventListener("pointerdown", () => void emergencyStop());
    stop.addEventListener("click", (event) => {
      if (event.detail === 0) void emergencyStop(); // pressed by a key or a screen reader
    });
    this.reset.append(translated(h("span"), "button.reset"));
    this.reset.addEventListener("click", () => void act(api.estopReset()));
    this.engage.addEventListener("click", () => this.toggleEngage());
    const ring = s("svg", { class: "ring", viewBox: "0 0 40 40", "aria-hidden": "true" });
    ring.append(s("circle", { class: "ring-track", cx: 20, cy: 20, r: 17.5 }), this.ring);
    this.ring.setAttribute("stroke-dasharray", String(RING_LENGTH));
    this.element = h(
      "header",
      { class: "banner", "data-mode": "no_person" },
      h("div", { class: "sign" }, ring, this.glyph),
      h("div", { class: "words", role: "status", "aria-live": "polite" }, this.modeText.element, this.reason.element),
      h("div", { class: "side" }, h("div", { class: "who" }, this.source.element, this.link, lease), tools),
      h("div", { class: "actions", "data-commands": true }, this.engage, this.reset),
      stop,
    );
    this.look = new Attribute(this.element, "data-mode");
    this.stopLook = new Attribute(this.element, "data-estop");
    this.showLink("connecting");
    this.engageText.set(t("button.engage"));
  }

  toggleEngage(): void {
    void act(this.engaged ? api.disengage() : api.engage());
  }

  private allowReset(allowed: boolean): void {
    if (this.reset.disabled === allowed) this.reset.disabled = !allowed;
  }

  showLink(link: Link): void {
    this.link.setAttribute("data-link", link);
    translated(this.link, `link.${link}`);
  }

  state(state: State): void {
    const { estop } = state.robot;
    const mode: State["mode"] = estop ? "stopped" : state.mode;
    const word = estop ? "estop" : state.mode;
    this.look.set(mode);
    this.stopLook.set(String(estop));
    this.modeText.set(t(`mode.${word}` as Key));
    const reason = estop ? t("hint.estop") : words(state);
    this.reason.set(reason);
    this.long.set(String(reason.length > LONG));
    setIcon(this.glyph, ICONS[mode]);
    const progress = state.engage_progress > 0 && state.engage_progress < 1 ? state.engage_progress : state.engaged ? 1 : 0;
    this.ringOffset.set((RING_LENGTH * (1 - progress)).toFixed(0));
    this.engaged = state.engaged;
    const kind = sourceKind(state.source);
    this.source.set(t(`source.${kind}`));
    this.sourceLook.set(state.source?.recording ? "recording" : kind);
    this.allowReset(estop || state.mode === "stopped");
    this.engageText.set(t(state.engaged ? "button.disengage" : "button.engage"));
  }
}
