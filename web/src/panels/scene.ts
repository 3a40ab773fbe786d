/** The robot in its greenhouse. The 3-D code is loaded after the rest: the stop button does not wait for it. */

import { Text, h } from "../dom";
import { t, translated } from "../i18n";
import { type Panel, frame } from "../panel";
import type { Coverage, Hello, State, TaskPreview } from "../wire";
import type { Stage } from "../scene/stage";
import { PickCard } from "./pick";

export class ScenePanel implements Panel {
  readonly element: HTMLElement;
  private readonly box = h("div", { class: "scene-box" });
  private readonly note = new Text(h("p", { class: "scene-note" }));
  private readonly speed = new Text(h("p", { class: "scene-speed" }));
  private readonly cost = new Text(h("span", { class: "scene-cost" }));
  private readonly commanded = translated(h("span", { class: "ghost-name", "data-ghost": "commanded", hidden: true }), "scene.commanded");
  private readonly recorded = translated(h("span", { class: "ghost-name", "data-ghost": "recorded", hidden: true }), "scene.recorded");
  private readonly followButton = translated(h("button", { class: "chip", type: "button" }), "scene.follow");
  private readonly homeButton = translated(h("button", { class: "chip", type: "button" }), "scene.home");
  private stage: Stage | null = null;
  private loading: Promise<Stage | null> | null = null;
  private shown = "";
  private wet: Coverage | null = null;
  private route: TaskPreview | null = null;
  readonly pick = new PickCard();
  private readonly label = new Text(h("p", { class: "scene-label", "aria-hidden": "true" }));

  constructor() {
    const { element, tools } = frame("scene", "panel.scene", this.box);
    this.element = element;
    this.box.append(
      this.note.element,
      h("div", { class: "scene-legend" }, this.commanded, this.recorded),
      this.cost.element,
      this.speed.element,
      this.label.element,
      this.pick.element,
    );
    // In a tab of its own: the console with its stop button stays.
    const studies = translated(h("a", { class: "chip", href: "./motion.html", target: "_blank" }), "scene.studies");
    tools.append(studies, this.followButton, this.homeButton);
    this.followButton.addEventListener("click", () => this.toggleFollow());
    this.homeButton.addEventListener("click", () => this.stage?.home());
    this.showFollow();
  }

  hello(hello: Hello): void {
    this.pick.hello(hello);
    this.loading ??= this.start();
    void this.loading.then((stage) => this.fill(stage, hello));
  }

  private async start(): Promise<Stage | null> {
    this.note.set(t("scene.loading"));
    const { Stage, webglWorks } = await import("../scene/stage");
    if (!webglWorks()) {
      this.note.set(t("scene.nowebgl"));
      return null;
    }
    this.stage = new Stage(
      this.box,
      (triangles, ms) => this.cost.set(t("scene.triangles", { count: triangles, ms: ms.toFixed(0) })),
      (commanded, recorded) => {
        this.commanded.hidden = !commanded;
        this.recorded.hidden = !recorded;
      },
      (fruit) => void this.pick.ask(fruit),
      (fruit) => this.label.set(fruit === null ? "" : this.pick.called(fruit)),
    );
    if (this.wet) this.stage.coverage(this.wet);
    if (this.route) this.stage.preview(this.route);
    this.showFollow();
    return this.stage;
  }

  private async fill(stage: Stage | null, hello: Hello): Promise<void> {
    if (!stage) return;
    try {
      const response = await fetch(hello.urdf_url);
      if (!response.ok) throw new TypeError(`${response.status} ${response.statusText}`);
      const urdf = await response.text();
      const what = urdf + JSON.stringify(hello.scenery);
      if (what !== this.shown) stage.build(urdf, hello); // a new source brings the same robot again
      this.shown = what;
      this.note.set("");
    } catch (error) {
      if (!(error instanceof TypeError)) throw error;
      this.note.set(t("scene.failed", { detail: error.message }));
    }
  }

  toggleFollow(): void {
    if (this.stage) this.stage.follow = !this.stage.follow;
    this.showFollow();
  }

  private showFollow(): void {
    this.followButton.setAttribute("aria-pressed", String(this.stage?.follow ?? true));
  }

  state(state: State, now_ms: number): void {
    this.pick.state(state, now_ms);
    const { drive_m_s, turn_rad_s } = state.robot;
    this.speed.set(`${tidy(drive_m_s, 2)} m/s   ${tidy((turn_rad_s * 180) / Math.PI, 0)}°/s`);
    this.stage?.state(state);
  }

  /** An overlay is on the screen, so long after its state came. */
  painted(paint_ms: number): void {
    this.stage?.painted(paint_ms);
  }

  giveWay(): void {
    this.stage?.giveWay();
  }

  /** Held until the 3-D code is here. */
  coverage(coverage: Coverage): void {
    this.wet = coverage;
    this.stage?.coverage(coverage);
  }

  /** Held until the 3-D code is here, too. */
  preview(preview: TaskPreview): void {
    this.route = preview;
    this.stage?.preview(preview);
  }

  restyle(): void {
    this.stage?.restyle();
  }
}

/** A tiny negative number must not flicker between 0.00 and -0.00. */
function tidy(value: number, digits: number): string {
  const text = value.toFixed(digits);
  return Number(text) === 0 ? (0).toFixed(digits) : text;
}
