/** What every step of the calibration looks like to the wizard. */

import type { Key } from "../i18n";
import type { Hello, State } from "../wire";

export interface Step {
  readonly title: Key;
  readonly element: HTMLElement;
  /** The step is shown now. */
  enter(): void;
  hello?(hello: Hello): void;
  state(state: State, now_ms: number): void;
  /** In one line what came out; empty while nothing has. */
  result(): string;
}
