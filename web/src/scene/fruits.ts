/** The fruit of the greenhouse as things to point at: where each is now, and which one is under the pointer. */

import { type PerspectiveCamera, Ray, Raycaster, Sphere, Vector2, Vector3 } from "three";
import type { FruitInfo, RobotWire } from "../wire";

/** Fruit is small in the picture: a finger may miss it by so much. */
const GENEROUS = 1.15;

export class Fruits {
  private readonly raycaster = new Raycaster();
  private readonly ball = new Sphere();
  private readonly places = new Map<string, Vector3>();
  private hanging = new Set<string>();
  private known: readonly FruitInfo[] = [];

  hello(fruits: readonly FruitInfo[]): void {
    this.known = fruits;
    this.places.clear();
    for (const fruit of fruits) this.places.set(fruit.name, new Vector3(...fruit.xyz_m));
    this.hanging = new Set(fruits.map((fruit) => fruit.name));
  }

  state(robot: RobotWire): void {
    for (const { name, xyz_m } of this.known) {
      // A cucumber's body is a piece of its own name; trusses swing by less than they are wide.
      const moved = robot.moved[name];
      this.places.get(name)?.set(...(moved ? ([moved[0], moved[1], moved[2]] as const) : xyz_m));
      const status = robot.fruits[name];
      if (status === undefined || status.startsWith("hanging")) this.hanging.add(name);
      else this.hanging.delete(name);
    }
  }

  info(name: string): FruitInfo | undefined {
    return this.known.find((fruit) => fruit.name === name);
  }

  where(name: string | null): { place: Vector3; radius_m: number } | null {
    const place = name === null ? undefined : this.places.get(name);
    return place && name !== null ? { place, radius_m: 1.05 * (this.info(name)?.radius_m ?? 0.1) } : null;
  }

  /** The hanging fruit under a point of the picture (-1..1 each way), the nearest one first. */
  at(point: Vector2, camera: PerspectiveCamera): string | null {
    this.raycaster.setFromCamera(point, camera);
    const ray: Ray = this.raycaster.ray;
    const hit = new Vector3();
    let best: string | null = null;
    let near = Infinity;
    for (const { name, radius_m } of this.known) {
      const place = this.places.get(name);
      if (!place || !this.hanging.has(name)) continue;
      this.ball.set(place, GENEROUS * radius_m);
      const met = ray.intersectSphere(this.ball, hit);
      const far = met ? met.distanceTo(ray.origin) : Infinity;
      if (far < near) [best, near] = [name, far];
    }
    return best;
  }
}
