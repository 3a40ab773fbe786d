/** Mean and spread of the last readings of one quantity. Pure. */

export class Readings {
  private readonly values: number[] = [];

  constructor(private readonly window: number) {}

  add(value: number): void {
    this.values.push(value);
    if (this.values.length > this.window) this.values.shift();
  }

  clear(): void {
    this.values.length = 0;
  }

  get full(): boolean {
    return this.values.length === this.window;
  }

  get mean(): number {
    return this.values.reduce((sum, value) => sum + value, 0) / Math.max(1, this.values.length);
  }

  /** Standard deviation. */
  get spread(): number {
    const mean = this.mean;
    const squares = this.values.reduce((sum, value) => sum + (value - mean) ** 2, 0);
    return Math.sqrt(squares / Math.max(1, this.values.length));
  }
}
