/** Spray coverage: a wet leaf takes the colour of its liquid, the more the wetter it is. */

import { Color } from "three";
import type { Coverage } from "../wire";
import type { Piece } from "./moved";
import { LIQUID_COLORS } from "./spray";

/** Names of a leaf's further boxes. */
const MORE = /_(lobe|pair)$/;
/** Leaves stay a little green, so that their shape is seen. */
const MOST = 0.85;

export class Wet {
  private readonly leaves = new Map<string, Piece[]>();
  private readonly color = new Color();
  private readonly liquid = new Color();
  private shown: Coverage["wet"] = {};

  constructor(pieces: ReadonlyMap<string, Piece>) {
    for (const [name, piece] of pieces) {
      const leaf = name.replace(MORE, "");
      const boxes = this.leaves.get(leaf);
      if (boxes) boxes.push(piece);
      else this.leaves.set(leaf, [piece]);
    }
  }

  /** wet: leaf -> shares of water, nutrient, pesticide. True when the picture changes. */
  set(wet: Coverage["wet"]): boolean {
    let changed = false;
    for (const leaf of new Set([...Object.keys(wet), ...Object.keys(this.shown)])) {
      const shares = wet[leaf] ?? [0, 0, 0];
      if (shares.join() === (this.shown[leaf] ?? [0, 0, 0]).join()) continue;
      for (const piece of this.leaves.get(leaf) ?? []) this.paint(piece, shares);
      changed = true;
    }
    this.shown = wet;
    return changed;
  }

  private paint({ item, shared, index }: Piece, shares: readonly number[]): void {
    const most = Math.max(...shares);
    const [r, g, b] = item.rgba;
    this.color.setRGB(r, g, b, "srgb");
    const hex = Object.values(LIQUID_COLORS)[shares.indexOf(most)];
    if (most > 0 && hex !== undefined) this.color.lerp(this.liquid.setHex(hex), MOST * Math.sqrt(most));
    shared.setColorAt(index, this.color);
    if (shared.instanceColor) shared.instanceColor.needsUpdate = true;
  }
}
