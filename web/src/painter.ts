/** Paints at most once per display frame, always the newest state, and tells when it is on the screen. */

import type { State } from "./wire";

interface Waiting {
  state: State;
  received_ms: number;
}

export class Painter {
  private next: Waiting | null = null;
  private painting: Waiting | null = null;
  private scheduled = false;
  private readonly afterPaint = new MessageChannel();

  /** painted: told with the state's number and the time from its receipt until it was on the screen. */
  constructor(
    private readonly paint: (state: State, now_ms: number) => void,
    painted: (seq: number, paint_ms: number) => void,
  ) {
    // A message posted inside an animation frame is handled after that frame has been painted.
    this.afterPaint.port1.onmessage = () => {
      const done = this.painting;
      this.painting = null;
      if (done) painted(done.state.seq, performance.now() - done.received_ms);
    };
  }

  show(state: State, received_ms: number): void {
    this.next = { state, received_ms };
    if (this.scheduled) return;
    this.scheduled = true;
    requestAnimationFrame((now_ms) => this.run(now_ms));
  }

  private run(now_ms: number): void {
    this.scheduled = false;
    const next = this.next;
    if (!next) return;
    this.next = null;
    this.paint(next.state, now_ms);
    this.painting = next;
    this.afterPaint.port2.postMessage(null);
  }
}
