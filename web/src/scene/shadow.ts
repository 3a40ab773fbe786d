/** A soft patch under the robot, so that it stands on the floor. */

import { CanvasTexture, Mesh, MeshBasicMaterial, PlaneGeometry } from "three";

const WIDTH_M = 1.7;
const TEXTURE_PX = 64;
const OVER_FLOOR_M = 0.012;

function softDisc(): HTMLCanvasElement {
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = TEXTURE_PX;
  const g = canvas.getContext("2d");
  if (!g) return canvas;
  const middle = TEXTURE_PX / 2;
  const fade = g.createRadialGradient(middle, middle, 0, middle, middle, middle);
  fade.addColorStop(0.3, "rgb(0 0 0 / 55%)");
  fade.addColorStop(1, "rgb(0 0 0 / 0%)");
  g.fillStyle = fade;
  g.fillRect(0, 0, TEXTURE_PX, TEXTURE_PX);
  return canvas;
}

export class Shadow {
  private readonly texture = new CanvasTexture(softDisc());
  private readonly material = new MeshBasicMaterial({ map: this.texture, transparent: true, depthWrite: false });
  readonly mesh = new Mesh(new PlaneGeometry(WIDTH_M, WIDTH_M), this.material);

  constructor() {
    this.mesh.position.z = OVER_FLOOR_M;
  }

  dispose(): void {
    this.texture.dispose();
    this.material.dispose();
  }
}
