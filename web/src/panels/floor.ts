/** Floor map seen from above: zones, the operator's spine and its trail.
 *
 * Drawn as the operator stands: sensor at the top, z downwards, x (the operator's right) to the right.
 */

import { Attribute, Text, h, s } from "../dom";
import { type Key, t, titled, translated } from "../i18n";
import { type Panel, frame } from "../panel";
import type { Hello, State, Zone, ZoneInfo } from "../wire";

const TRAIL_POINTS = 160;
/** The nearest metre holds nothing but the sensor: the map begins there, so that the zones are drawn large. */
const NEAR_M = 0.92;
const FAR_M = 3.66;
const HALF_WIDTH_M = 1.4;
/** How much room the operator's mark needs round their place. */
const MARK_M = { side: 0.22, front: 0.22, behind: 0.1 };
const LINE_M = { side: 0.02, front: 0.02, behind: 0.02 };

/** The nearest place with so much room on the map: who stands beside it, or at its very edge, is drawn there. */
function onMap([x, z]: readonly [number, number], room: { side: number; front: number; behind: number }): [number, number] {
  const side = HALF_WIDTH_M - room.side;
  return [Math.min(Math.max(x, -side), side), Math.min(Math.max(z, NEAR_M + room.front), FAR_M - room.behind)];
}

export class FloorPanel implements Panel {
  readonly element: HTMLElement;
  private readonly map = titled(
    s("svg", { class: "floor-map", viewBox: `${-HALF_WIDTH_M} ${NEAR_M} ${2 * HALF_WIDTH_M} ${FAR_M - NEAR_M}`, role: "img" }),
    "panel.floor",
  );
  private readonly areas = new Map<Zone, SVGElement>();
  private readonly margin = s("rect", { class: "floor-margin", visibility: "hidden" });
  private readonly trail = s("polyline", { class: "floor-trail" });
  private readonly dot = s("g", { class: "floor-dot", visibility: "hidden" });
  private readonly place = new Attribute(this.dot, "transform");
  private readonly shown = new Attribute(this.dot, "visibility");
  private readonly note = new Text(h("span", { class: "floor-note" }));
  private readonly xz = new Float64Array(2 * TRAIL_POINTS);
  private count = 0;
  private lit: Zone | null = null;
  private hysteresis_m = 0;

  /** placed: told where the map is pressed or dragged, in metres; asked for only while `canPlace` says so. */
  constructor(
    private readonly canPlace: () => boolean,
    private readonly placed: (x_m: number, z_m: number) => void,
  ) {
    const { element, tools } = frame("floor", "panel.floor", h("div", { class: "floor-box" }));
    this.element = element;
    element.querySelector(".floor-box")?.append(this.map);
    tools.append(this.note.element);
    this.map.addEventListener("pointerdown", (event) => this.point(event));
    this.map.addEventListener("pointermove", (event) => event.buttons === 1 && this.point(event));
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
    this.hysteresis_m = zones.hysteresis_m;
    const [near, work, back, far] = zones.depth_cuts_m;
    const center = zones.center_half_width_m;
    const side = zones.side_limit_m;
    this.area("forward", -center, near, center, work);
    this.area("work", -center, work, center, back);
    this.area("back", -center, back, center, far);
    this.area("left", -side, near, -center, far);
    this.area("right", center, near, side, far);
    this.bands(zones);
    this.names(zones);
    this.label("floor.pick", 0, back - 0.2, "small");
    this.label("floor.spray", 0, back - 0.09, "small");
    this.label("floor.stop", 0, near - 0.12, "stop");
    this.label("floor.stop", 0, far + 0.17, "stop");
    this.label("floor.left", -(side + center) / 2 - 0.05, near - 0.07, "small");
    this.label("floor.right", (side + center) / 2 + 0.05, near - 0.07, "small");
    this.measures(zones);
    this.map.append(
      s("path", { class: "floor-view", d: `M0 0 L${-HALF_WIDTH_M} ${HALF_WIDTH_M / Math.tan(0.51)} M0 0 L${HALF_WIDTH_M} ${HALF_WIDTH_M / Math.tan(0.51)}` }),
      s("path", { class: "floor-sensor", d: `M-0.17 ${NEAR_M + 0.05} h0.34 v0.09 h-0.34 z M0 ${NEAR_M} l0.05 0.05 h-0.1 z` }),
      this.margin,
      this.trail,
      this.dot,
    );
    this.label("floor.sensor", 0.36, NEAR_M + 0.13, "small");
    this.lit = null;
  }

  private point(event: PointerEvent): void {
    const toMap = this.map.getScreenCTM()?.inverse();
    if (!this.canPlace() || !toMap) return;
    const { x, y } = new DOMPoint(event.clientX, event.clientY).matrixTransform(toMap);
    this.placed(x, y);
  }

  private area(zone: Exclude<Zone, "none" | "out">, x0: number, z0: number, x1: number, z1: number): void {
    const box = s("rect", { class: "floor-zone", "data-zone": zone, x: x0, y: z0, width: x1 - x0, height: z1 - z0 });
    this.areas.set(zone, box);
    this.map.append(box);
  }

  private names({ depth_cuts_m: [near, work, back, far], center_half_width_m: center, side_limit_m: side }: ZoneInfo): void {
    for (const [turn, x] of [["left", -(center + side) / 2], ["right", (center + side) / 2]] as const) {
      this.label("floor.turn", x, (near + far) / 2 - 0.04, "");
      this.label(`floor.turn.${turn}`, x, (near + far) / 2 + 0.12, "");
    }
    this.label("zone.forward", 0, (near + work) / 2 + 0.04, "");
    this.label("zone.work", 0, back - 0.31, ""); // the operator mostly stands in the nearer half
    this.label("zone.back", 0, (back + far) / 2 + 0.04, "");
  }

  private label(key: Key, x: number, y: number, kind: string): void {
    this.map.append(translated(s("text", { class: `floor-label ${kind}`, x, y }), key));
  }

  /** Where the zone depends on the one before: the operator has to cross such a band to change it. */
  private bands({ depth_cuts_m: cuts, center_half_width_m: center, side_limit_m: side, hysteresis_m: margin }: ZoneInfo): void {
    const near = cuts[0];
    const depth = cuts[3] - near;
    const across = (x: number) => this.band(x - margin, near, 2 * margin, depth);
    for (const x of [-side, -center, center, side]) across(x);
    for (const z of [near, cuts[3]]) this.band(-side, z - margin, 2 * side, 2 * margin);
    for (const z of [cuts[1], cuts[2]]) this.band(-center, z - margin, 2 * center, 2 * margin);
  }

  private band(x: number, z: number, width: number, height: number): void {
    this.map.append(s("rect", { class: "floor-band", x, y: z, width, height }));
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
    if (zone !== this.lit) this.light(zone);
    const at = state.spine_xz;
    this.shown.set(at ? "visible" : "hidden");
    if (at) {
      const [x, z] = onMap(at, MARK_M);
      this.place.set(`translate(${x.toFixed(3)} ${z.toFixed(3)})`);
      this.remember(...onMap(at, LINE_M));
    } else if (this.count > 0) {
      this.count = 0;
      this.trail.setAttribute("points", "");
    }
    if (state.floor) {
      const { camera_height_m, tilt_deg } = state.floor;
      this.note.set(t("floor.height", { height: camera_height_m.toFixed(2), tilt: tilt_deg.toFixed(1) }));
    } else this.note.set("");
  }

  /** Lights the zone, with the border that has to be crossed to leave it. */
  private light(zone: Zone): void {
    if (this.lit) this.areas.get(this.lit)?.classList.remove("lit");
    this.lit = zone;
    const area = this.areas.get(zone);
    area?.classList.add("lit");
    this.margin.setAttribute("visibility", area ? "visible" : "hidden");
    if (!area) return;
    const grow = { x: -1, y: -1, width: 2, height: 2 };
    for (const [name, times] of Object.entries(grow)) {
      this.margin.setAttribute(name, String(Number(area.getAttribute(name)) + times * this.hysteresis_m));
    }
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
