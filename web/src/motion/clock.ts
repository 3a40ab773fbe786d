/** Time of the playback: runs at a speed, stops at the end, can be set. */

export class Clock {
  speed = 1;
  private at_s = 0;
  private end_s = 0;
  private last_ms: number | null = null;

  constructor(private readonly moved: (t_s: number, running: boolean) => void) {}

  get running(): boolean {
    return this.last_ms !== null;
  }

  load(end_s: number): void {
    this.end_s = end_s;
    this.seek(0);
  }

  seek(t_s: number): void {
    this.at_s = Math.min(Math.max(0, t_s), this.end_s);
    this.moved(this.at_s, this.running);
  }

  step(by_s: number): void {
    this.seek(this.at_s + by_s);
  }

  play(): void {
    if (this.running) return;
    if (this.at_s >= this.end_s) this.at_s = 0;
    this.last_ms = performance.now();
    requestAnimationFrame(this.tick);
    this.moved(this.at_s, true);
  }

  pause(): void {
    this.last_ms = null;
    this.moved(this.at_s, false);
  }

  toggle(): void {
    if (this.running) this.pause();
    else this.play();
  }

  private readonly tick = (now_ms: number): void => {
    if (this.last_ms === null) return;
    this.at_s += (Math.max(0, now_ms - this.last_ms) / 1000) * this.speed;
    this.last_ms = now_ms;
    if (this.at_s >= this.end_s) {
      this.at_s = this.end_s;
      this.pause();
      return;
    }
    this.moved(this.at_s, true);
    requestAnimationFrame(this.tick);
  };
}
