/** Renderer, lights and camera of the 3-D view. World axes as the robot's: x along the row, y left, z up, metres.
 *
 * Draws only when something changed and somebody sees it, at most 30 times a second, and never before the last
 * picture is finished. WebGL draws on a canvas beside the page; finished pictures are copied to the one in the page.
 * A canvas in the page would make every paint of the overlay wait for the picture being drawn: without a GPU that is
 * tens of milliseconds.
 */

import {
  AmbientLight,
  Color,
  DirectionalLight,
  Fog,
  HemisphereLight,
  PerspectiveCamera,
  Scene,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { cssColor, h } from "../dom";
import type { Coverage, Hello, State, TaskPreview } from "../wire";
import { Fruits } from "./fruits";
import { Pointer } from "./pointer";
import { RobotModel } from "./robot";
import { Halo, Route } from "./route";
import { AISLE_HALF_WIDTH_M, type Scenery, buildScenery, disposeScenery } from "./scenery";

const MIN_PERIOD_MS = 33;
const SOFTWARE_PERIOD_MS = 80;
const SOFTWARE_SLOWEST_MS = 500;
/** An overlay painted later than this after its state came was kept waiting. */
const LATE_MS = 33;
/** One late overlay in about seven keeps the pace as it is. */
const SLOWER = 1.1;
const QUICKER = 0.985;
/** How often a picture being drawn is asked whether it is finished. */
const POLL_MS = 8;
/** Drawing by the processor takes its time from tracking and simulation: rest four times as long as a picture takes. */
const SOFTWARE_REST = 4;
/** So long no picture is begun after an emergency stop: where the server shares the processor, it brakes meanwhile. */
const STOP_QUIET_MS = 300;
const SOFTWARE_PIXEL_RATIO = 0.75;
const HOME_EYE_M = new Vector3(1.85, -2.0, 1.75);
const HOME_TARGET_M = new Vector3(0.05, 0, 0.78);

export function webglWorks(): boolean {
  return document.createElement("canvas").getContext("webgl2") !== null;
}

function drawnBySoftware(): boolean {
  const gl = document.createElement("canvas").getContext("webgl2");
  if (!gl) return false;
  // the plain name is masked in some browsers
  const unmasked = gl.getExtension("WEBGL_debug_renderer_info")?.UNMASKED_RENDERER_WEBGL ?? gl.RENDERER;
  return /swiftshader|llvmpipe|software|basic render/i.test(String(gl.getParameter(unmasked)));
}

export class Stage {
  follow = true;
  private readonly renderer: WebGLRenderer;
  private readonly gl: WebGL2RenderingContext;
  private readonly shown = h("canvas", { class: "scene-canvas" });
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera(42, 1, 0.05, 60);
  private readonly controls: OrbitControls;
  private readonly base = new Vector3();
  private readonly step = new Vector3();
  private readonly fruits = new Fruits();
  private readonly route = new Route();
  private readonly meant = new Halo(0xf2b134);
  private readonly hovered = new Halo(0xffffff);
  private planned: string | null = null;
  private under: string | null = null;
  private wet: Coverage["wet"] = {};
  private scenery: Scenery | null = null;
  private robot: RobotModel | null = null;
  private scheduled = false;
  private drawn_ms = -Infinity;
  private quiet_ms = -Infinity;
  private readonly rest: number;
  private readonly software: boolean;
  private period_ms: number;
  private visible = true;
  private fence: WebGLSync | null = null;
  private fenced_ms = 0;
  private finished_ms = -Infinity;
  private cost_ms = 0;
  private wanted = false;
  private compiled = false;
  private told_ms = -Infinity;
  private told_triangles = -1;

  constructor(
    private readonly box: HTMLElement,
    private readonly report: (triangles: number, cost_ms: number) => void,
    private readonly ghosts: (commanded: boolean, recorded: boolean) => void,
    private readonly chosen: (fruit: string) => void = () => {},
    private readonly over: (fruit: string | null) => void = () => {},
  ) {
    const software = drawnBySoftware();
    this.software = software;
    this.rest = software ? SOFTWARE_REST : 0;
    this.period_ms = software ? SOFTWARE_PERIOD_MS : MIN_PERIOD_MS;
    this.renderer = new WebGLRenderer({
      antialias: !software,
      powerPreference: "high-performance",
      preserveDrawingBuffer: true,
    });
    this.renderer.setPixelRatio(software ? SOFTWARE_PIXEL_RATIO : Math.min(window.devicePixelRatio, 2));
    this.gl = this.renderer.getContext() as WebGL2RenderingContext;
    box.prepend(this.shown);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, this.shown);
    this.controls.maxPolarAngle = 0.495 * Math.PI;
    this.controls.minDistance = 0.6;
    this.controls.maxDistance = 12;
    this.controls.addEventListener("change", () => {
      this.cutAway();
      this.invalidate();
    });
    const sun = new DirectionalLight(0xffffff, 1.9);
    sun.position.set(3, -4, 8);
    this.scene.add(sun, new HemisphereLight(0xe8f4ee, 0x3a4a40, 1.5), new AmbientLight(0xffffff, 0.25));
    this.scene.add(this.route.group, this.meant.mesh, this.hovered.mesh);
    new Pointer(this.shown, (point) => this.hover(point && this.fruits.at(point, this.camera)), (point) => {
      const fruit = this.fruits.at(point, this.camera);
      if (fruit !== null) this.chosen(fruit);
    });
    new ResizeObserver(() => this.resize()).observe(box);
    new IntersectionObserver((entries) => this.see(entries.at(-1)?.isIntersecting ?? true)).observe(box);
    document.addEventListener("visibilitychange", () => this.invalidate());
    this.restyle();
    this.home();
    this.resize();
  }

  build(urdf: string, hello: Hello): void {
    if (this.scenery) {
      this.scene.remove(this.scenery.all);
      disposeScenery(this.scenery);
    }
    if (this.robot) {
      this.scene.remove(this.robot.group);
      this.robot.dispose();
    }
    this.fruits.hello(hello.fruits);
    this.scenery = buildScenery(hello.scenery);
    this.robot = new RobotModel(urdf, hello.arm_joints);
    this.scenery.wet.set(this.wet);
    this.scene.add(this.scenery.all, this.robot.group);
    this.cutAway();
    this.invalidate();
  }

  state(state: State): void {
    this.fruits.state(state.robot);
    const meant = state.aim ? state.aim.fruit : this.planned;
    const fruit = meant !== null && state.robot.fruits[meant] === undefined ? this.fruits.where(meant) : null;
    if (this.meant.set(fruit)) this.invalidate();
    if (this.scenery?.moved.set(state.robot.moved)) this.invalidate();
    if (!this.robot?.set(state)) return;
    const { commanded, recorded } = this.robot.ghosts;
    this.ghosts(commanded, recorded);
    const { x, y } = state.robot.base;
    this.step.set(x, y, 0).sub(this.base);
    this.base.add(this.step);
    if (this.follow) {
      this.camera.position.add(this.step);
      this.controls.target.add(this.step);
      this.controls.update();
    }
    this.invalidate();
  }

  /** Where an assisted pick will go, or an empty preview. */
  preview(preview: TaskPreview): void {
    this.planned = preview.fruit || null;
    const { x, y } = this.base;
    this.route.set(preview, { x, y, yaw: this.robot?.group.rotation.z ?? 0 });
    this.invalidate();
  }

  private hover(fruit: string | null): void {
    if (fruit !== this.under) this.over(fruit);
    this.under = fruit;
    this.shown.style.cursor = fruit === null ? "" : "pointer";
    if (this.hovered.set(fruit === this.planned ? null : this.fruits.where(fruit))) this.invalidate();
  }

  coverage({ wet }: Coverage): void {
    this.wet = wet;
    if (this.scenery?.wet.set(wet)) this.invalidate();
  }

  home(): void {
    this.camera.position.copy(HOME_EYE_M).add(this.base);
    this.controls.target.copy(HOME_TARGET_M).add(this.base);
    this.controls.update();
    this.invalidate();
  }

  /**
   * How long the overlay took. Without a GPU pictures of the scene take their time from everything else, also from the
   * stop button: they come less often as long as overlays come late.
   */
  painted(paint_ms: number): void {
    if (!this.software) return;
    const pace_ms = this.period_ms * (paint_ms > LATE_MS ? SLOWER : QUICKER);
    this.period_ms = Math.min(Math.max(pace_ms, SOFTWARE_PERIOD_MS), SOFTWARE_SLOWEST_MS);
  }

  /** Begin no picture for a moment, where the processor draws it. */
  giveWay(): void {
    if (this.software) this.quiet_ms = performance.now() + STOP_QUIET_MS;
  }

  /** Hides the row that stands between the eye and the robot. */
  private cutAway(): void {
    if (!this.scenery) return;
    this.scenery.left.visible = this.camera.position.y < AISLE_HALF_WIDTH_M;
    this.scenery.right.visible = this.camera.position.y > -AISLE_HALF_WIDTH_M;
  }

  restyle(): void {
    const sky = new Color(cssColor("--sky"));
    this.scene.background = sky;
    this.scene.fog = new Fog(sky, 6, 16);
    this.invalidate();
  }

  private resize(): void {
    const { clientWidth, clientHeight } = this.box;
    if (clientWidth === 0 || clientHeight === 0) return;
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.camera.aspect = clientWidth / clientHeight;
    this.camera.updateProjectionMatrix();
    this.invalidate();
  }

  private copy(): void {
    const picture = this.renderer.domElement;
    if (this.shown.width !== picture.width) this.shown.width = picture.width;
    if (this.shown.height !== picture.height) this.shown.height = picture.height;
    this.shown.getContext("2d", { alpha: false })?.drawImage(picture, 0, 0);
  }

  /** At most twice a second, and whenever there is more or less to draw. */
  private tell(now_ms: number): void {
    const { triangles } = this.renderer.info.render;
    if (triangles === this.told_triangles && now_ms - this.told_ms < 500) return;
    this.told_ms = now_ms;
    this.told_triangles = triangles;
    this.report(triangles, this.cost_ms);
  }

  private see(visible: boolean): void {
    this.visible = visible;
    if (visible) this.invalidate();
  }

  private invalidate(): void {
    this.wanted = true;
    if (this.scheduled) return;
    this.scheduled = true;
    this.later(0);
  }

  /** A task of its own, never inside an animation frame: there the overlay is painted. */
  private later(wait_ms: number): void {
    window.setTimeout(this.tick, wait_ms);
  }

  private readonly tick = (): void => {
    const now_ms = performance.now();
    if (!this.finished(now_ms)) {
      this.later(POLL_MS);
      return;
    }
    if (!this.wanted || document.hidden || !this.visible) {
      this.scheduled = false;
      return;
    }
    const due_ms = Math.max(this.drawn_ms + this.period_ms, this.finished_ms + this.rest * this.cost_ms, this.quiet_ms);
    if (now_ms < due_ms) {
      this.later(due_ms - now_ms);
      return;
    }
    this.later(POLL_MS);
    this.wanted = false;
    this.drawn_ms = now_ms;
    this.renderer.render(this.scene, this.camera);
    this.fenced_ms = performance.now();
    this.fence = this.gl.fenceSync(this.gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    this.gl.flush();
  };

  /** Whether the last picture is complete; measures how long it took. */
  private finished(now_ms: number): boolean {
    if (!this.fence) return true;
    if (this.gl.getSyncParameter(this.fence, this.gl.SYNC_STATUS) !== this.gl.SIGNALED) return false;
    this.gl.deleteSync(this.fence);
    this.fence = null;
    this.finished_ms = now_ms;
    const spent_ms = Math.max(0, now_ms - this.fenced_ms);
    // The first picture compiles the shaders; it says nothing about the next ones.
    if (this.compiled) this.cost_ms += 0.2 * (spent_ms - this.cost_ms);
    this.compiled = true;
    this.copy();
    this.tell(now_ms);
    return true;
  }
}
