/** The spray as a translucent cone in the colour of its liquid. */

import { ConeGeometry, Mesh, MeshBasicMaterial } from "three";
import type { Liquid } from "../wire";

const LENGTH_M = 0.55;
const RADIUS_M = 0.17;
/** From the sprayer's flange to its nozzles' mouths. */
const NOZZLE_M = 0.14;
/** In the order in which shares come over the wire. */
export const LIQUID_COLORS: Record<Liquid, number> = { water: 0x9fd8ff, nutrient: 0xa9e88f, pesticide: 0xf2c35a };

export class Spray {
  private readonly material = new MeshBasicMaterial({ transparent: true, opacity: 0.38, depthWrite: false });
  readonly mesh: Mesh;
  private liquid: Liquid | null = null;

  constructor() {
    // Tip at the nozzles, opening along -z, away from the flange.
    const cone = new ConeGeometry(RADIUS_M, LENGTH_M, 14, 1, true).rotateX(Math.PI / 2);
    this.mesh = new Mesh(cone.translate(0, 0, -NOZZLE_M - LENGTH_M / 2), this.material);
    this.mesh.visible = false;
  }

  /** True when the picture changes. */
  set(on: boolean, liquid: Liquid): boolean {
    if (this.mesh.visible === on && this.liquid === liquid) return false;
    this.mesh.visible = on;
    this.liquid = liquid;
    this.material.color.setHex(LIQUID_COLORS[liquid]);
    return true;
  }

  dispose(): void {
    this.material.dispose();
  }
}
