/** What has just been true counts as true a little longer: a button must not go away under the finger. Pure. */

const LASTS_MS = 1_000;

export class Lasting {
  private true_ms = -Infinity;

  /** The value at a time, and for a second after it was true. */
  at(now_ms: number, value: boolean): boolean {
    if (value) this.true_ms = now_ms;
    return now_ms - this.true_ms < LASTS_MS;
  }

  clear(): void {
    this.true_ms = -Infinity;
  }
}
