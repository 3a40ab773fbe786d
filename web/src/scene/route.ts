/** Where an assisted pick will go: the hand's way to the fruit and on to the box, the fruit itself, the drive before it. */

import {
  BufferGeometry,
  CatmullRomCurve3,
  ConeGeometry,
  Group,
  Mesh,
  MeshBasicMaterial,
  SphereGeometry,
  TubeGeometry,
  Vector3,
} from "three";
import type { TaskPreview, Vec3 } from "../wire";

const THICK_M = 0.007;
const ALONG = 40;
const ROUND = 5;
const TO_FRUIT = 0xf2b134;
const TO_BOX = 0x4aa8e8;
const ARROW_M = 0.12;
const OVER_FLOOR_M = 0.06;

function tube(points: readonly Vec3[]): BufferGeometry {
  const curve = new CatmullRomCurve3(points.map((point) => new Vector3(...point)), false, "centripetal");
  return new TubeGeometry(curve, ALONG, THICK_M, ROUND);
}

export class Route {
  readonly group = new Group();
  private readonly there = this.line(TO_FRUIT);
  private readonly back = this.line(TO_BOX);
  private readonly arrow = new Mesh(
    new ConeGeometry(0.05, ARROW_M, 8).rotateZ(-Math.PI / 2),
    new MeshBasicMaterial({ color: TO_FRUIT }),
  );

  constructor() {
    this.group.visible = false;
    this.group.add(this.there, this.back, this.arrow);
  }

  private line(color: number): Mesh {
    // Over everything: leaves must not hide where the arm goes.
    const material = new MeshBasicMaterial({ color, depthTest: false, transparent: true, opacity: 0.9 });
    const mesh = new Mesh(new BufferGeometry(), material);
    mesh.renderOrder = 2;
    return mesh;
  }

  /** base: where the robot stands now; its drive is shown on the floor before it. */
  set(preview: TaskPreview, base: { x: number; y: number; yaw: number }): void {
    const planned = preview.to_fruit.length > 1 && preview.to_box.length > 1;
    this.group.visible = planned;
    if (!planned) return;
    for (const [mesh, points] of [[this.there, preview.to_fruit], [this.back, preview.to_box]] as const) {
      mesh.geometry.dispose();
      mesh.geometry = tube(points);
    }
    const far = preview.drive_m;
    this.arrow.visible = Math.abs(far) > 0.01;
    const [dx, dy] = [Math.cos(base.yaw), Math.sin(base.yaw)];
    this.arrow.position.set(base.x + far * dx, base.y + far * dy, OVER_FLOOR_M);
    this.arrow.rotation.z = base.yaw + (far < 0 ? Math.PI : 0);
  }
}

/** A halo round the fruit that is meant, pointed at, or under the pointer. */
export class Halo {
  readonly mesh: Mesh;

  constructor(color: number) {
    const material = new MeshBasicMaterial({ color, transparent: true, opacity: 0.35, depthTest: false, depthWrite: false });
    this.mesh = new Mesh(new SphereGeometry(1, 12, 8), material);
    this.mesh.visible = false;
    this.mesh.renderOrder = 1;
  }

  /** True when the picture changes; null hides it. */
  set(at: { place: Vector3; radius_m: number } | null): boolean {
    if (!at) {
      const was = this.mesh.visible;
      this.mesh.visible = false;
      return was;
    }
    if (this.mesh.visible && this.mesh.position.distanceTo(at.place) < 1e-3) return false;
    this.mesh.visible = true;
    this.mesh.position.copy(at.place);
    this.mesh.scale.setScalar(at.radius_m);
    return true;
  }
}
