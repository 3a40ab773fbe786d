/** A second robot that can be seen through: where the arms are bound for, or where the robot was when it was recorded. */

import { Group, MeshLambertMaterial, type Object3D } from "three";
import URDFLoader, { type URDFRobot } from "urdf-loader";
import { mergeLink } from "./merge";

/** A difference the eye cannot see in this view. */
export const STILL_RAD = 5e-4;

export class SeeThrough {
  readonly group = new Group();
  private readonly robot: URDFRobot;
  private readonly material: MeshLambertMaterial;

  /** drawn: which links are seen. */
  constructor(urdf: string, color: number, drawn: (link: Object3D) => boolean) {
    const loader = new URDFLoader();
    loader.parseCollision = false;
    this.robot = loader.parse(urdf);
    this.material = new MeshLambertMaterial({ color, transparent: true, opacity: 0.3, depthWrite: false });
    for (const link of Object.values(this.robot.links)) {
      for (const { mesh } of mergeLink(link)) {
        mesh.material = this.material;
        mesh.visible = drawn(link);
      }
    }
    this.group.add(this.robot);
    this.group.visible = false;
  }

  /** Shows or hides it; true when that changes the picture. */
  show(visible: boolean): boolean {
    const changed = this.group.visible !== visible;
    this.group.visible = visible;
    return changed;
  }

  /** Takes joint positions; true when one moved. */
  pose(joints: Readonly<Record<string, number>>, goals?: ReadonlyMap<string, number>): boolean {
    let moved = false;
    for (const name in joints) moved = setJoint(this.robot, name, goals?.get(name) ?? joints[name] ?? 0) || moved;
    return moved;
  }

  dispose(): void {
    this.material.dispose();
  }
}

export function setJoint(robot: URDFRobot, name: string, value: number): boolean {
  const joint = robot.joints[name];
  if (!joint || Math.abs(Number(joint.angle) - value) < STILL_RAD) return false;
  return joint.setJointValue(value);
}
