/** Pointing into the 3-D view: what the pointer is over, and clicks that are no drags. */

import { Vector2 } from "three";

const STILL_PX = 5;

export class Pointer {
  private down: { x: number; y: number } | null = null;

  constructor(
    private readonly canvas: HTMLElement,
    private readonly over: (point: Vector2 | null) => void,
    private readonly clicked: (point: Vector2) => void,
  ) {
    canvas.addEventListener("pointermove", (event) => {
      if (event.buttons === 0) this.over(this.place(event));
    });
    canvas.addEventListener("pointerleave", () => this.over(null));
    canvas.addEventListener("pointerdown", (event) => {
      this.down = { x: event.clientX, y: event.clientY };
    });
    canvas.addEventListener("pointerup", (event) => {
      const from = this.down;
      this.down = null;
      if (!from || Math.hypot(event.clientX - from.x, event.clientY - from.y) > STILL_PX) return;
      this.clicked(this.place(event));
    });
  }

  private place(event: PointerEvent): Vector2 {
    const box = this.canvas.getBoundingClientRect();
    return new Vector2(
      (2 * (event.clientX - box.left)) / box.width - 1,
      1 - (2 * (event.clientY - box.top)) / box.height,
    );
  }
}
