/** The 3-D view of a motion. Draws only when something changed; z is up, metres. */

import {
  AmbientLight,
  Box3,
  Color,
  DirectionalLight,
  GridHelper,
  type Group,
  HemisphereLight,
  type Mesh,
  PerspectiveCamera,
  Scene,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import type { URDFRobot } from "urdf-loader";
import { cssColor } from "../dom";
import { buildPath, buildRobot, buildVolumes, disposeTree } from "./drawn";
import { type Motion, jointsAt } from "./motion";

const FIELD_DEG = 38;
const FROM = new Vector3(0.66, -0.66, 0.42).normalize();
const POSES_IN_VIEW = 24;

export function webglWorks(): boolean {
  return document.createElement("canvas").getContext("webgl2") !== null;
}

export class MotionView {
  private readonly renderer = new WebGLRenderer({ antialias: true });
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera(FIELD_DEG, 1, 0.01, 60);
  private readonly controls: OrbitControls;
  private motion: Motion | null = null;
  private robot: URDFRobot | null = null;
  private volumes: Group | null = null;
  private path: Mesh | null = null;
  private grid: GridHelper | null = null;
  private readonly bounds = new Box3();
  private readonly joints: number[] = [];
  private wanted = false;
  private shows = { path: true, volumes: true };

  constructor(private readonly box: HTMLElement) {
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    box.append(this.renderer.domElement);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    this.controls.addEventListener("change", () => this.draw());
    const sun = new DirectionalLight(0xffffff, 1.9);
    sun.position.set(3, -4, 8);
    this.scene.add(sun, new HemisphereLight(0xe8f4ee, 0x3a4a40, 1.5), new AmbientLight(0xffffff, 0.3));
    new ResizeObserver(() => this.resize()).observe(box);
    this.restyle();
  }

  show(motion: Motion): void {
    for (const old of [this.robot, this.volumes, this.path]) {
      if (!old) continue;
      this.scene.remove(old);
      disposeTree(old);
    }
    this.motion = motion;
    this.robot = buildRobot(motion);
    this.volumes = buildVolumes(motion.volumes);
    this.scene.add(this.robot, this.volumes);
    this.measure(motion);
    this.path = buildPath(motion, this.bounds.getSize(new Vector3()).length());
    if (this.path) this.scene.add(this.path);
    this.layFloor();
    this.setShown(this.shows);
    this.home();
    this.place(0);
  }

  /** The box that holds robot and volumes during the whole motion. */
  private measure(motion: Motion): void {
    this.bounds.makeEmpty();
    if (this.volumes) this.bounds.expandByObject(this.volumes);
    const end_s = motion.t_s.at(-1) ?? 0;
    for (let k = 0; k <= POSES_IN_VIEW; k++) {
      this.place((end_s * k) / POSES_IN_VIEW);
      if (this.robot) this.bounds.expandByObject(this.robot);
    }
  }

  private layFloor(): void {
    if (this.grid) {
      this.scene.remove(this.grid);
      this.grid.dispose();
    }
    const size = this.bounds.getSize(new Vector3());
    const step_m = size.length() > 1.2 ? 0.25 : 0.05;
    const count = 2 * Math.ceil((1.4 * Math.max(size.x, size.y)) / step_m / 2);
    this.grid = new GridHelper(count * step_m, count, new Color(cssColor("--muted")), new Color(cssColor("--line")));
    this.grid.rotateX(Math.PI / 2);
    const middle = this.bounds.getCenter(new Vector3());
    this.grid.position.set(middle.x, middle.y, this.bounds.min.z - 0.002);
    this.scene.add(this.grid);
  }

  /** Puts the robot where it is at a time. */
  place(t_s: number): void {
    if (!this.motion || !this.robot) return;
    jointsAt(this.motion, t_s, this.joints);
    this.motion.joint_names.forEach((name, k) => {
      const joint = this.robot?.joints[name];
      if (!joint) return;
      joint.ignoreLimits = true; // what the study recorded is shown, over-range joints too
      joint.setJointValue(this.joints[k] ?? 0);
    });
    this.draw();
  }

  setShown(shows: { path: boolean; volumes: boolean }): void {
    this.shows = shows;
    if (this.path) this.path.visible = shows.path;
    if (this.volumes) this.volumes.visible = shows.volumes;
    this.draw();
  }

  home(): void {
    if (this.bounds.isEmpty()) return;
    const middle = this.bounds.getCenter(new Vector3());
    const radius_m = this.bounds.getSize(new Vector3()).length() / 2;
    const half = ((FIELD_DEG / 2) * Math.PI) / 180;
    const narrow = Math.min(half, Math.atan(Math.tan(half) * this.camera.aspect));
    this.camera.position.copy(middle).addScaledVector(FROM, (0.92 * radius_m) / Math.sin(narrow));
    this.controls.target.copy(middle);
    this.controls.update();
    this.draw();
  }

  restyle(): void {
    this.scene.background = new Color(cssColor("--sky"));
    if (this.grid) this.layFloor();
    this.draw();
  }

  private resize(): void {
    const { clientWidth, clientHeight } = this.box;
    if (clientWidth === 0 || clientHeight === 0) return;
    const first = this.camera.aspect === 1;
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.camera.aspect = clientWidth / clientHeight;
    this.camera.updateProjectionMatrix();
    if (first) this.home();
    this.draw();
  }

  private draw(): void {
    if (this.wanted) return;
    this.wanted = true;
    requestAnimationFrame(() => {
      this.wanted = false;
      this.renderer.render(this.scene, this.camera);
    });
  }
}
