/** The camera's picture with the tracked skeleton drawn over it. */

import { Text, fitCanvas, h } from "../dom";
import { t, titled, translated } from "../i18n";
import { icon } from "../icons";
import { type Panel, frame } from "../panel";
import { prefs, savePrefs } from "../prefs";
import { COLOR_IMAGE, DEPTH_IMAGE, HEAD_IMAGE, PARTS_IMAGE, SIDES, type Side } from "../words";
import type { Hello, ImageChoice, State, View } from "../wire";

/** The operator's right and left keep one colour each on the whole screen (Okabe and Ito, safe for the colour-blind). */
const SIDE_COLORS: Record<Side | "center", string> = { right: "#f0a83c", left: "#5cb8f0", center: "#dfe9e2" };
const CHOICES: readonly ImageChoice[] = ["depth", "color", "none"];

function sideOf(joint: string): Side | "center" {
  return joint.endsWith("_right") ? "right" : joint.endsWith("_left") ? "left" : "center";
}

export class CameraPanel implements Panel {
  readonly element: HTMLElement;
  private readonly picture = h("canvas", { class: "picture" });
  private readonly overlay = h("canvas", { class: "overlay" });
  private readonly parts = h("canvas", { class: "parts", hidden: true });
  private readonly head = h("canvas", { class: "head-picture", width: 320, height: 240, hidden: true });
  private readonly buttons = new Map<ImageChoice, HTMLButtonElement>();
  private readonly partsButton = titled(h("button", { class: "chip", type: "button" }, icon("parts")), "image.parts");
  private readonly numbersButton = titled(h("button", { class: "chip", type: "button" }, "%"), "image.numbers");
  private readonly headButton = titled(h("button", { class: "chip", type: "button" }, icon("camera")), "image.head");
  private readonly mirrorButton = titled(h("button", { class: "chip", type: "button" }, icon("mirror")), "button.mirror");
  private readonly empty = new Text(h("p", { class: "camera-empty" }));
  private hello_: Hello | null = null;
  private last: State | null = null;
  private decoding = new Set<number>();

  constructor(private readonly viewChanged: (view: View) => void) {
    const stack = h("div", { class: "camera-stack" }, this.picture, this.parts, this.overlay, this.empty.element as HTMLElement, this.head);
    const { element, tools } = frame("camera", "panel.camera", stack);
    this.element = element;
    for (const choice of CHOICES) {
      const button = translated(h("button", { class: "chip", type: "button" }), `image.${choice}`);
      button.addEventListener("click", () => this.choose(choice));
      this.buttons.set(choice, button);
      tools.append(button);
    }
    this.headButton.addEventListener("click", () => this.toggleHead());
    this.partsButton.addEventListener("click", () => this.toggleParts());
    this.numbersButton.addEventListener("click", () => this.toggleNumbers());
    this.mirrorButton.addEventListener("click", () => this.toggleMirror());
    tools.append(this.partsButton, this.numbersButton, this.headButton, this.mirrorButton);
    this.showChoice();
  }

  hello(hello: Hello): void {
    this.hello_ = hello;
    this.element.style.setProperty("--aspect", `${hello.camera.width} / ${hello.camera.height}`);
    this.picture.getContext("2d")?.clearRect(0, 0, this.picture.width, this.picture.height);
    this.choose(prefs.image);
  }

  choose(image: ImageChoice): void {
    prefs.image = image;
    savePrefs();
    this.showChoice();
    this.viewChanged({ type: "view", image: prefs.image, head: headShown(), parts: prefs.parts });
  }

  /** Seen from afar the head camera's picture is always there. */
  restyle(): void {
    this.choose(prefs.image);
  }

  toggleHead(): void {
    prefs.head = !prefs.head;
    this.choose(prefs.image);
  }

  toggleParts(): void {
    prefs.parts = !prefs.parts;
    this.choose(prefs.image);
  }

  toggleNumbers(): void {
    prefs.numbers = !prefs.numbers;
    savePrefs();
    this.showChoice();
    if (this.last) this.state(this.last);
  }

  toggleImage(): void {
    this.choose(prefs.image === "depth" ? "color" : "depth");
  }

  toggleMirror(): void {
    prefs.mirror = !prefs.mirror;
    savePrefs();
    this.showChoice();
    if (this.last) this.state(this.last);
  }

  private showChoice(): void {
    for (const [choice, button] of this.buttons) button.setAttribute("aria-pressed", String(choice === prefs.image));
    this.headButton.setAttribute("aria-pressed", String(prefs.head));
    this.mirrorButton.setAttribute("aria-pressed", String(prefs.mirror));
    this.partsButton.setAttribute("aria-pressed", String(prefs.parts));
    this.numbersButton.setAttribute("aria-pressed", String(prefs.numbers));
    this.head.hidden = !headShown();
    if (!prefs.parts) this.parts.getContext("2d")?.clearRect(0, 0, this.parts.width, this.parts.height);
    this.parts.hidden = !prefs.parts;
    if (prefs.image === "none") this.picture.getContext("2d")?.clearRect(0, 0, this.picture.width, this.picture.height);
  }

  /** True when the picture has to be turned over to show what the operator wants to see. */
  private get flipped(): boolean {
    return this.hello_ !== null && this.hello_.camera.mirrored !== prefs.mirror;
  }

  /** Shows a picture; one that arrives while the last is still being decoded is left out. */
  async image(kind: number, picture: Blob): Promise<void> {
    if (this.decoding.has(kind) || !wanted(kind)) return;
    this.decoding.add(kind);
    try {
      const bitmap = await createImageBitmap(picture);
      if (!wanted(kind)) return; // another picture was chosen meanwhile
      const canvas = kind === HEAD_IMAGE ? this.head : kind === PARTS_IMAGE ? this.parts : this.picture;
      if (canvas.width !== bitmap.width || canvas.height !== bitmap.height) {
        canvas.width = bitmap.width;
        canvas.height = bitmap.height;
      }
      canvas.classList.toggle("flipped", kind !== HEAD_IMAGE && this.flipped);
      const g = canvas.getContext("2d");
      if (kind === PARTS_IMAGE) g?.clearRect(0, 0, canvas.width, canvas.height);
      g?.drawImage(bitmap, 0, 0);
      bitmap.close();
    } finally {
      this.decoding.delete(kind);
    }
  }

  state(state: State): void {
    this.last = state;
    const hello = this.hello_;
    const g = this.overlay.getContext("2d");
    if (!hello || !g) return;
    if (!fitCanvas(this.overlay)) g.clearRect(0, 0, this.overlay.width, this.overlay.height);
    const fault = state.source?.fault;
    this.empty.set(fault ? t("camera.fault", { detail: fault }) : state.skeleton ? "" : t("camera.nobody"));
    if (fault || !state.skeleton) return;
    this.drawSkeleton(g, hello, state.skeleton);
    for (const side of SIDES) this.drawHand(g, hello, state, side);
  }

  private u(u_px: number, hello: Hello): number {
    const k = this.overlay.width / hello.camera.width;
    return this.flipped ? this.overlay.width - (u_px + 0.5) * k : (u_px + 0.5) * k;
  }

  private v(v_px: number, hello: Hello): number {
    return ((v_px + 0.5) * this.overlay.height) / hello.camera.height;
  }

  private drawSkeleton(g: CanvasRenderingContext2D, hello: Hello, skeleton: NonNullable<State["skeleton"]>): void {
    const unit = this.overlay.width / 100;
    g.lineCap = "round";
    for (const [i, j] of hello.bones) {
      const a = hello.joint_names[i] ?? "";
      const b = hello.joint_names[j] ?? "";
      const p = skeleton.pixels[a];
      const q = skeleton.pixels[b];
      if (!p || !q) continue;
      g.beginPath();
      g.moveTo(this.u(p[0], hello), this.v(p[1], hello));
      g.lineTo(this.u(q[0], hello), this.v(q[1], hello));
      g.globalAlpha = opacity(Math.min(skeleton.confidence[a] ?? 0, skeleton.confidence[b] ?? 0));
      g.lineWidth = 1.5 * unit;
      g.strokeStyle = "#07120ccc"; // a dark edge keeps the line visible on any picture
      g.stroke();
      g.lineWidth = 0.85 * unit;
      g.strokeStyle = SIDE_COLORS[sideOf(b)];
      g.stroke();
    }
    for (const name of hello.joint_names) {
      const p = skeleton.pixels[name];
      if (p) this.drawJoint(g, this.u(p[0], hello), this.v(p[1], hello), sideOf(name), skeleton.confidence[name] ?? 0);
    }
    g.globalAlpha = 1;
  }

  /** A joint's ring closes with its confidence: a full circle is sure, an arc is not; readable without colour. */
  private drawJoint(g: CanvasRenderingContext2D, x: number, y: number, side: Side | "center", confidence: number): void {
    const unit = this.overlay.width / 100;
    g.globalAlpha = 1;
    g.beginPath();
    g.arc(x, y, 1.25 * unit, 0, 2 * Math.PI);
    g.fillStyle = "#07120c";
    g.fill();
    g.beginPath();
    g.arc(x, y, 0.95 * unit, -Math.PI / 2, -Math.PI / 2 + 2 * Math.PI * Math.min(1, Math.max(0.05, confidence)));
    g.lineWidth = 0.6 * unit;
    g.strokeStyle = SIDE_COLORS[side];
    g.stroke();
    if (!prefs.numbers) return;
    g.font = `600 ${(3.1 * unit).toFixed(0)}px system-ui, sans-serif`;
    g.textBaseline = "middle";
    g.lineWidth = 0.9 * unit;
    g.strokeStyle = "#07120c";
    const text = (100 * confidence).toFixed(0);
    g.strokeText(text, x + 1.8 * unit, y);
    g.fillStyle = "#ffffff";
    g.fillText(text, x + 1.8 * unit, y);
  }

  /** An open hand is a ring, a fist a full disc, an unseen one a dashed ring: told apart without colour. */
  private drawHand(g: CanvasRenderingContext2D, hello: Hello, state: State, side: Side): void {
    const p = state.skeleton?.pixels[`hand_${side}`];
    if (!p) return;
    const unit = this.overlay.width / 100;
    const hand = state.hands[side];
    g.beginPath();
    g.arc(this.u(p[0], hello), this.v(p[1], hello), 3.4 * unit, 0, 2 * Math.PI);
    g.lineWidth = 0.9 * unit;
    g.strokeStyle = SIDE_COLORS[side];
    g.fillStyle = SIDE_COLORS[side];
    g.globalAlpha = 0.55 + 0.45 * state.hands[`${side}_confidence`];
    g.setLineDash(hand === "unknown" ? [1.6 * unit, 1.6 * unit] : []);
    if (hand === "fist") g.fill();
    else g.stroke();
    g.setLineDash([]);
    g.globalAlpha = 1;
  }
}

function headShown(): boolean {
  return prefs.head || prefs.far;
}

/** Whether the operator looks at this kind of picture. */
function wanted(kind: number): boolean {
  if (kind === HEAD_IMAGE) return headShown();
  if (kind === PARTS_IMAGE) return prefs.parts;
  return (kind === DEPTH_IMAGE && prefs.image === "depth") || (kind === COLOR_IMAGE && prefs.image === "color");
}

function opacity(confidence: number): number {
  return 0.2 + 0.8 * Math.min(1, Math.max(0, confidence));
}
