/** Paints at most once per display frame, always the newest state, and tells when it is on the screen. */

import type { State } from "./wire";

export class Painter {
  private next: State | null = null;
  private scheduled = false;
  private painted_seq = 0;
  private readonly afterPaint = new MessageChannel();

  constructor(
    private readonly paint: (state: State, now_ms: number) => void,
    painted: (seq: number) => void,
  ) {
    // A message posted inside an animation frame is handled after that frame has been painted.
    this.afterPaint.port1.onmessage = () => painted(this.painted_seq);
  }

  show(state: State): void {
    this.next = state;
    if (this.scheduled) return;
    this.scheduled = true;
    requestAnimationFrame((now_ms) => this.run(now_ms));
  }

  private run(now_ms: number): void {
    this.scheduled = false;
    const state = this.next;
    if (!state) return;
    this.next = null;
    this.paint(state, now_ms);
    this.painted_seq = state.seq;
    this.afterPaint.port2.postMessage(null);
  }
}
