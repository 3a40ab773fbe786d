/** The robot from its URDF, and a ghost of the set-points its arms are moving to. */

import {
  BoxGeometry,
  type BufferGeometry,
  CylinderGeometry,
  Group,
  Mesh,
  MeshLambertMaterial,
  type MeshPhongMaterial,
  type Object3D,
  SphereGeometry,
} from "three";
import URDFLoader, { type URDFRobot } from "urdf-loader";
import type { RobotWire } from "../wire";

/** A difference the eye cannot see in this view. */
const STILL_RAD = 5e-4;
const GHOST_FROM_RAD = 0.05;
const ARM_JOINT = /^(right|left|rear)_/;

/** The loader's own primitives are far finer than the view needs. */
const SHAPES: Record<string, BufferGeometry> = {
  BoxGeometry: new BoxGeometry(1, 1, 1),
  CylinderGeometry: new CylinderGeometry(1, 1, 1, 12),
  SphereGeometry: new SphereGeometry(1, 10, 8),
};

export class RobotModel {
  readonly group = new Group();
  private readonly robot: URDFRobot;
  private readonly ghost: URDFRobot;
  private readonly materials = new Map<string, MeshLambertMaterial>();
  private readonly ghostMaterial = new MeshLambertMaterial({ color: 0x8fe3b8, transparent: true, opacity: 0.28, depthWrite: false });

  constructor(urdf: string) {
    const loader = new URDFLoader();
    loader.parseCollision = false;
    this.robot = loader.parse(urdf);
    this.ghost = loader.parse(urdf);
    this.forMeshes(this.robot, (mesh) => {
      mesh.material = this.material(mesh.material as MeshPhongMaterial);
    });
    this.forMeshes(this.ghost, (mesh) => {
      mesh.material = this.ghostMaterial;
      mesh.visible = onArm(mesh);
    });
    this.ghost.visible = false;
    this.group.add(this.robot, this.ghost);
  }

  private forMeshes(robot: URDFRobot, change: (mesh: Mesh) => void): void {
    robot.traverse((object) => {
      if (!(object instanceof Mesh)) return;
      object.geometry = SHAPES[object.geometry.type] ?? object.geometry;
      change(object);
    });
  }

  /** One shared material per colour. */
  private material(from: MeshPhongMaterial): MeshLambertMaterial {
    const key = `${from.color.getHexString()} ${from.opacity}`;
    let material = this.materials.get(key);
    if (!material) {
      material = new MeshLambertMaterial({ color: from.color, transparent: from.opacity < 1, opacity: from.opacity });
      this.materials.set(key, material);
    }
    return material;
  }

  /** Takes the pose of a state; true when the picture changes. */
  set(state: RobotWire): boolean {
    let changed = this.move(state);
    for (const name in state.joints) {
      changed = setJoint(this.robot, name, state.joints[name] ?? 0) || changed;
    }
    return this.setGhost(state) || changed;
  }

  private move(state: RobotWire): boolean {
    const { x, y, yaw } = state.base;
    const { position, rotation } = this.group;
    if (Math.hypot(position.x - x, position.y - y) < STILL_RAD && Math.abs(rotation.z - yaw) < STILL_RAD) return false;
    position.set(x, y, position.z);
    rotation.z = yaw;
    return true;
  }

  /** The ghost shows while an arm is on its way. */
  private setGhost(state: RobotWire): boolean {
    let away = false;
    for (const name in state.targets) {
      const gap = Math.abs((state.targets[name] ?? 0) - (state.joints[name] ?? 0));
      if (ARM_JOINT.test(name) && gap > GHOST_FROM_RAD) away = true;
    }
    const changed = this.ghost.visible !== away;
    this.ghost.visible = away;
    if (!away) return changed;
    let moved = false;
    for (const name in state.targets) {
      const value = ARM_JOINT.test(name) ? state.targets[name] : state.joints[name];
      moved = setJoint(this.ghost, name, value ?? 0) || moved;
    }
    return moved || changed;
  }

  dispose(): void {
    for (const material of this.materials.values()) material.dispose();
    this.ghostMaterial.dispose();
  }
}

function setJoint(robot: URDFRobot, name: string, value: number): boolean {
  const joint = robot.joints[name];
  if (!joint || Math.abs(Number(joint.angle) - value) < STILL_RAD) return false;
  return joint.setJointValue(value);
}

function onArm(object: Object3D): boolean {
  for (let at: Object3D | null = object; at; at = at.parent) {
    if ("isURDFJoint" in at && ARM_JOINT.test(at.name)) return true;
  }
  return false;
}
