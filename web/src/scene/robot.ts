/** The robot from its URDF; ghosts of the pose that is commanded of its arms, before the limits, and of a recorded one. */

import { Group, Mesh, MeshLambertMaterial, type Object3D } from "three";
import URDFLoader, { type URDFRobot } from "urdf-loader";
import type { ArmJoints, ArmTargetState, CommandState, Ghost, RobotWire, State } from "../wire";
import { STILL_RAD, SeeThrough, setJoint } from "./ghost";
import { mergeLink } from "./merge";
import { Shadow } from "./shadow";
import { Spray } from "./spray";

const GHOST_FROM_RAD = 0.05;
/** The recorded robot is shown once it is this far from the present one. */
const RECORDED_FROM_M = 0.03;
const COMMANDED = 0x8fe3b8;
const RECORDED = 0xf0a83c;
const SPRAYER = "rear_tool";
const RAD = Math.PI / 180;
const ARM_JOINT = /^(right|left|rear)_/;
/** Wheels turn without anybody seeing it. */
const POSED = /^(?!wheel)/;

export class RobotModel {
  /** The robot with its commanded ghost, and the recorded one, each at its place in the world. */
  readonly group = new Group();
  private readonly here = new Group();
  private readonly robot: URDFRobot;
  private readonly commanded: SeeThrough;
  private readonly recorded: SeeThrough;
  private readonly materials = new Map<number, MeshLambertMaterial>();
  private readonly shadow = new Shadow();
  private readonly spray = new Spray();

  constructor(
    urdf: string,
    private readonly armJoints: { [arm: string]: ArmJoints },
  ) {
    const loader = new URDFLoader();
    loader.parseCollision = false;
    this.robot = loader.parse(urdf);
    this.commanded = new SeeThrough(urdf, COMMANDED, onArm);
    this.recorded = new SeeThrough(urdf, RECORDED, () => true);
    for (const link of Object.values(this.robot.links)) {
      for (const { mesh, opacity } of mergeLink(link)) mesh.material = this.material(opacity);
    }
    this.robot.links[SPRAYER]?.add(this.spray.mesh);
    this.here.add(this.shadow.mesh, this.robot, this.commanded.group);
    this.group.add(this.here, this.recorded.group);
  }

  /** Which ghosts are seen now. */
  get ghosts(): { commanded: boolean; recorded: boolean } {
    return { commanded: this.commanded.group.visible, recorded: this.recorded.group.visible };
  }

  private material(opacity: number): MeshLambertMaterial {
    let material = this.materials.get(opacity);
    if (!material) {
      material = new MeshLambertMaterial({ vertexColors: true, transparent: opacity < 1, opacity, flatShading: false });
      this.materials.set(opacity, material);
    }
    return material;
  }

  /** Takes the pose of a state; true when the picture changes. */
  set({ robot: state, command, ghost }: State): boolean {
    let changed = move(this.here, state.base);
    for (const name in state.joints) {
      changed = setJoint(this.robot, name, state.joints[name] ?? 0) || changed;
    }
    changed = this.spray.set(state.spray_on, state.liquid) || changed;
    changed = this.setRecorded(state, ghost) || changed;
    return this.setGhost(state, command) || changed;
  }

  /** The recorded robot shows where it was when it was elsewhere, or held its arms otherwise. */
  private setRecorded(state: RobotWire, ghost: Ghost | null): boolean {
    if (!ghost) return this.recorded.show(false);
    let away = Math.hypot(ghost.base.x - state.base.x, ghost.base.y - state.base.y) > RECORDED_FROM_M;
    away ||= Math.abs(ghost.base.yaw - state.base.yaw) > GHOST_FROM_RAD;
    for (const name in ghost.joints) {
      if (POSED.test(name) && Math.abs((ghost.joints[name] ?? 0) - (state.joints[name] ?? 0)) > GHOST_FROM_RAD) away = true;
    }
    const changed = this.recorded.show(away);
    if (!away) return changed;
    const moved = move(this.recorded.group, ghost.base);
    return this.recorded.pose(ghost.joints) || moved || changed;
  }

  /** The ghost shows while an arm is on its way. */
  private setGhost(state: RobotWire, command: CommandState): boolean {
    const goals = this.goals(state, command);
    let away = false;
    for (const [name, goal] of goals) {
      if (Math.abs(goal - (state.joints[name] ?? 0)) > GHOST_FROM_RAD) away = true;
    }
    const changed = this.commanded.show(away);
    return away ? this.commanded.pose(state.joints, goals) || changed : changed;
  }

  /** Where each arm joint shall go: as commanded while an arm is, else as the motors are told. */
  private goals(state: RobotWire, command: CommandState): Map<string, number> {
    const goals = new Map<string, number>();
    for (const name in state.targets) if (ARM_JOINT.test(name)) goals.set(name, state.targets[name] ?? 0);
    const arms: [string, ArmTargetState | null][] = [["right", command.right_arm], ["left", command.left_arm], ["rear", command.rear_arm]];
    for (const [arm, target] of arms) {
      const joints = this.armJoints[arm];
      if (!target || !joints) continue;
      // As robot_sim.arm_angles: the elbow joint is zero when the arm is straight (180 deg).
      goals.set(joints.c1, target.c1_deg * RAD);
      goals.set(joints.c2, target.c2_deg * RAD);
      goals.set(joints.elbow, (180 - target.elbow_deg) * RAD);
    }
    return goals;
  }

  dispose(): void {
    for (const material of this.materials.values()) material.dispose();
    this.commanded.dispose();
    this.recorded.dispose();
    this.shadow.dispose();
    this.spray.dispose();
    this.group.traverse((object) => {
      if (object instanceof Mesh) object.geometry.dispose();
    });
  }
}

/** Puts something on the floor; true when it moved. */
function move(group: Group, { x, y, yaw }: RobotWire["base"]): boolean {
  const { position, rotation } = group;
  if (Math.hypot(position.x - x, position.y - y) < STILL_RAD && Math.abs(rotation.z - yaw) < STILL_RAD) return false;
  position.set(x, y, 0);
  rotation.z = yaw;
  return true;
}

function onArm(link: Object3D): boolean {
  for (let at: Object3D | null = link; at; at = at.parent) {
    if ("isURDFJoint" in at && ARM_JOINT.test(at.name)) return true;
  }
  return false;
}
