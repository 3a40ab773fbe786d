/** Floor map seen from above: zones, the operator's spine and its trail.
 *
 * Drawn as the operator stands: sensor at the top, z downwards, x (the operator's right) to the right.
 */

import { Attribute, Text, h, s } from "../dom";
import { type Key, t, translated } from "../i18n";
import { type Panel, frame } from "../panel";
import type { Hello, State, ZoneInfo } from "../wire";
import type { Zone } from "../words";

const TRAIL_POINTS = 90;
const FAR_M = 3.75;
const HALF_WIDTH_M = 1.32;

export class FloorPanel implements Panel {
  readonly element: HTMLElement;
  private readonly map = s("svg", {
    class: "floor-map",
    viewBox: `${-HALF_WIDTH_M} -0.12 ${2 * HALF_WIDTH_M} ${FAR_M + 0.12}`,
    role: "img",
  });
  private readonly areas = new Map<Zone, SVGElement>();
  private readonly trail = s("polyline", { class: "floor-trail" });
  private readonly dot = s("g", { class: "floor-dot", visibility: "hidden" });
  private readonly place = new Attribute(this.dot, "transform");
  private readonly shown = new Attribute(this.dot, "visibility");
  private readonly note = new Text(h("span", { class: "floor-note" }));
  private readonly xz = new Float64Array(2 * TRAIL_POINTS);
  private count = 0;
  private lit: Zone | null = null;

  constructor() {
    const { element, tools } = frame("floor", "panel.floor", h("div", { class: "floor-box" }));
    this.element = element;
    element.querySelector(".floor-box")?.append(this.map);
    tools.append(this.note.element);
    this.dot.append(
      s("ellipse", { rx: 0.2, ry: 0.08 }),
      s("circle", { r: 0.075 }),
      s("path", { d: "M-0.05 -0.12 L0 -0.19 L0.05 -0.12" }),
    );
  }

  hello(hello: Hello): void {
    const zones = hello.zones;
    this.map.replaceChildren();
    this.areas.clear();
    const [near, work, back, far] = zones.depth_cuts_m;
    const center = zones.center_half_width_m;
    const side = zones.side_limit_m;
    this.area("forward", -center, near, center, work);
    this.area("work", -center, work, center, back);
    this.area("back", -center, back, center, far);
    this.area("left", -side, near, -center, far);
    this.area("right", center, near, side, far);
    this.label("floor.pick", 0, back - 0.17, "small");
    this.label("floor.spray", 0, back - 0.06, "small");
    this.label("floor.stop", 0, near - 0.3, "stop");
    this.label("floor.stop", 0, far + 0.2, "stop");
    this.label("floor.left", -(side + center) / 2 - 0.05, near - 0.06, "small");
    this.label("floor.right", (side + center) / 2 + 0.05, near - 0.06, "small");
    this.measures(zones);
    this.map.append(
      s("path", { class: "floor-view", d: `M0 0 L${-HALF_WIDTH_M} ${HALF_WIDTH_M / Math.tan(0.51)} M0 0 L${HALF_WIDTH_M} ${HALF_WIDTH_M / Math.tan(0.51)}` }),
      s("rect", { class: "floor-sensor", x: -0.22, y: -0.07, width: 0.44, height: 0.12, rx: 0.03 }),
      this.trail,
      this.dot,
    );
    this.label("floor.sensor", 0, 0.24, "small");
    this.lit = null;
  }

  private area(zone: Zone, x0: number, z0: number, x1: number, z1: number): void {
    const box = s("rect", { class: "floor-zone", "data-zone": zone, x: x0, y: z0, width: x1 - x0, height: z1 - z0 });
    this.areas.set(zone, box);
    const sideways = zone === "left" || zone === "right";
    const y = zone === "work" ? z0 + 0.26 : (z0 + z1) / 2 + 0.05;
    this.map.append(box);
    this.label(`zone.${zone}`, (x0 + x1) / 2, y, zone === "work" ? "large" : sideways ? "turn" : "");
  }

  private label(key: Key, x: number, y: number, kind: string): void {
    this.map.append(translated(s("text", { class: `floor-label ${kind}`, x, y }), key));
  }

  private measures(zones: ZoneInfo): void {
    for (const z of zones.depth_cuts_m) {
      this.map.append(
        s("path", { class: "floor-tick", d: `M${zones.side_limit_m} ${z} h0.1` }),
        s("text", { class: "floor-measure", x: zones.side_limit_m + 0.14, y: z + 0.04 }, `${z.toFixed(1)} m`),
      );
    }
  }

  state(state: State): void {
    const zone = state.zone;
    if (zone !== this.lit) {
      if (this.lit) this.areas.get(this.lit)?.classList.remove("lit");
      this.areas.get(zone)?.classList.add("lit");
      this.lit = zone;
    }
    const at = state.spine_xz;
    this.shown.set(at ? "visible" : "hidden");
    if (at) {
      this.place.set(`translate(${at[0].toFixed(3)} ${at[1].toFixed(3)})`);
      this.remember(at[0], at[1]);
    } else if (this.count > 0) {
      this.count = 0;
      this.trail.setAttribute("points", "");
    }
    if (state.floor) {
      const { camera_height_m, tilt_deg } = state.floor;
      this.note.set(t("floor.height", { height: camera_height_m.toFixed(2), tilt: tilt_deg.toFixed(1) }));
    } else this.note.set("");
  }

  /** Keeps the last places, one every few centimetres, so that standing still leaves no knot. */
  private remember(x: number, z: number): void {
    const n = this.count;
    if (n > 0 && Math.hypot(x - (this.xz[2 * n - 2] ?? 0), z - (this.xz[2 * n - 1] ?? 0)) < 0.03) return;
    if (n === TRAIL_POINTS) this.xz.copyWithin(0, 2);
    const i = Math.min(n, TRAIL_POINTS - 1);
    this.xz[2 * i] = x;
    this.xz[2 * i + 1] = z;
    this.count = i + 1;
    this.trail.setAttribute("points", Array.from(this.xz.subarray(0, 2 * this.count), (v) => v.toFixed(2)).join(" "));
  }
}
