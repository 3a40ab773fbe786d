/** The robot from its URDF, and a ghost of the pose that is commanded of its arms, before the limits. */

import { Group, Mesh, MeshLambertMaterial, type Object3D } from "three";
import URDFLoader, { type URDFRobot } from "urdf-loader";
import type { ArmJoints, ArmTargetState, CommandState, RobotWire, State } from "../wire";
import { mergeLink } from "./merge";
import { Shadow } from "./shadow";
import { Spray } from "./spray";

/** A difference the eye cannot see in this view. */
const STILL_RAD = 5e-4;
const GHOST_FROM_RAD = 0.05;
const SPRAYER = "rear_tool";
const RAD = Math.PI / 180;
const ARM_JOINT = /^(right|left|rear)_/;

export class RobotModel {
  readonly group = new Group();
  private readonly robot: URDFRobot;
  private readonly ghost: URDFRobot;
  private readonly materials = new Map<number, MeshLambertMaterial>();
  private readonly ghostMaterial = new MeshLambertMaterial({ color: 0x8fe3b8, transparent: true, opacity: 0.3, depthWrite: false });
  private readonly shadow = new Shadow();
  private readonly spray = new Spray();

  constructor(
    urdf: string,
    private readonly armJoints: { [arm: string]: ArmJoints },
  ) {
    const loader = new URDFLoader();
    loader.parseCollision = false;
    this.robot = loader.parse(urdf);
    this.ghost = loader.parse(urdf);
    for (const link of Object.values(this.robot.links)) {
      for (const { mesh, opacity } of mergeLink(link)) mesh.material = this.material(opacity);
    }
    for (const link of Object.values(this.ghost.links)) {
      for (const { mesh } of mergeLink(link)) {
        mesh.material = this.ghostMaterial;
        mesh.visible = onArm(link);
      }
    }
    this.ghost.visible = false;
    this.robot.links[SPRAYER]?.add(this.spray.mesh);
    this.group.add(this.shadow.mesh, this.robot, this.ghost);
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
  set({ robot: state, command }: State): boolean {
    let changed = this.move(state);
    for (const name in state.joints) {
      changed = setJoint(this.robot, name, state.joints[name] ?? 0) || changed;
    }
    changed = this.spray.set(state.spray_on, state.liquid) || changed;
    return this.setGhost(state, command) || changed;
  }

  private move(state: RobotWire): boolean {
    const { x, y, yaw } = state.base;
    const { position, rotation } = this.group;
    if (Math.hypot(position.x - x, position.y - y) < STILL_RAD && Math.abs(rotation.z - yaw) < STILL_RAD) return false;
    position.set(x, y, 0);
    rotation.z = yaw;
    return true;
  }

  /** The ghost shows while an arm is on its way. */
  private setGhost(state: RobotWire, command: CommandState): boolean {
    const goals = this.goals(state, command);
    let away = false;
    for (const [name, goal] of goals) {
      if (Math.abs(goal - (state.joints[name] ?? 0)) > GHOST_FROM_RAD) away = true;
    }
    const changed = this.ghost.visible !== away;
    this.ghost.visible = away;
    if (!away) return changed;
    let moved = false;
    for (const name in state.joints) {
      moved = setJoint(this.ghost, name, goals.get(name) ?? state.joints[name] ?? 0) || moved;
    }
    return moved || changed;
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
    this.ghostMaterial.dispose();
    this.shadow.dispose();
    this.spray.dispose();
    this.group.traverse((object) => {
      if (object instanceof Mesh) object.geometry.dispose();
    });
  }
}

function setJoint(robot: URDFRobot, name: string, value: number): boolean {
  const joint = robot.joints[name];
  if (!joint || Math.abs(Number(joint.angle) - value) < STILL_RAD) return false;
  return joint.setJointValue(value);
}

function onArm(link: Object3D): boolean {
  for (let at: Object3D | null = link; at; at = at.parent) {
    if ("isURDFJoint" in at && ARM_JOINT.test(at.name)) return true;
  }
  return false;
}
