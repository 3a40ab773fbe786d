/** A recording's modes from its begin to its end as one coloured line; filled from what was recorded, or as it plays. */

import { cssColor, h } from "./dom";
import type { Mode } from "./wire";

const BINS = 480;
/** Places passed over between two states, at eight times the speed, belong to the mode as well. */
const JUMP = 16;
const COLORS: Record<Mode, string> = {
  no_person: "--line",
  seen: "--ready",
  engaged: "--good",
  picking: "--good",
  spraying: "--spray",
  forward: "--drive",
  back: "--drive",
  left: "--drive",
  right: "--drive",
  held: "--hold",
  stopped: "--stop",
};

export class Band {
  readonly element = h("canvas", { class: "band", width: BINS, height: 1 });
  private readonly modes: (Mode | null)[] = Array.from({ length: BINS }, () => null);
  private last = -1;

  /** The mode at a share of the length, null where nothing is known. */
  at(share: number): Mode | null {
    return this.modes[bin(share)] ?? null;
  }

  /** Learns the mode at a place that is being played. */
  learn(share: number, mode: Mode): void {
    const now = bin(share);
    const from = now > this.last && now - this.last <= JUMP ? this.last + 1 : now;
    this.last = now;
    for (let i = from; i <= now; i++) this.set(i, mode);
  }

  /** From each share on until the next: the mode. */
  fill(changes: readonly { share: number; mode: Mode }[]): void {
    this.clear();
    changes.forEach(({ share, mode }, k) => {
      const end = k + 1 < changes.length ? bin(changes[k + 1]?.share ?? 1) : BINS;
      for (let i = bin(share); i < end; i++) this.set(i, mode);
    });
  }

  clear(): void {
    this.modes.fill(null);
    this.last = -1;
    this.element.getContext("2d")?.clearRect(0, 0, BINS, 1);
  }

  restyle(): void {
    this.modes.forEach((mode, i) => mode && this.paint(i, mode));
  }

  private set(index: number, mode: Mode): void {
    if (this.modes[index] === mode) return;
    this.modes[index] = mode;
    this.paint(index, mode);
  }

  private paint(index: number, mode: Mode): void {
    const g = this.element.getContext("2d");
    if (!g) return;
    g.fillStyle = cssColor(COLORS[mode]);
    g.fillRect(index, 0, 1, 1);
  }
}

function bin(share: number): number {
  return Math.min(BINS - 1, Math.max(0, Math.floor(share * BINS)));
}
