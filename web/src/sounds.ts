/** Short tones for the operator who looks away: engaged, on hold, stopped, task changed. */

import { prefs } from "./prefs";
import type { State } from "./wire";

type Tone = readonly [frequency_hz: number, length_s: number][];

const ENGAGED: Tone = [[523, 0.09], [784, 0.16]];
const RELEASED: Tone = [[784, 0.09], [523, 0.16]];
const TASK: Tone = [[660, 0.12]];
const HOLD: Tone = [[330, 0.18]];
const STOP: Tone = [[220, 0.16], [165, 0.3]];
const VOLUME = 0.12;

export class Sounds {
  private context: AudioContext | null = null;
  private mode: State["mode"] | null = null;
  private engaged = false;
  private estop = false;
  private task: string | null = null;

  state(state: State): void {
    const tone = this.toneFor(state);
    this.mode = state.mode;
    this.engaged = state.engaged;
    this.estop = state.robot.estop;
    this.task = state.task?.status ?? null;
    if (tone && prefs.sound) this.play(tone);
  }

  private toneFor(state: State): Tone | null {
    if (this.mode === null) return null;
    if (state.robot.estop !== this.estop) return state.robot.estop ? STOP : RELEASED;
    const task = state.task?.status ?? null;
    if (task !== this.task && task === "succeeded") return ENGAGED;
    if (task !== this.task && this.task === "running") return HOLD;
    if (task !== this.task && (task === "preview" || task === "running")) return TASK;
    if (state.engaged !== this.engaged) return state.engaged ? ENGAGED : RELEASED;
    if (state.mode === this.mode) return null;
    if (state.mode === "stopped") return STOP;
    return state.mode === "held" ? HOLD : state.engaged ? TASK : null;
  }

  private play(tone: Tone): void {
    // Browsers keep a page silent until it has been touched once.
    if (!this.context && !navigator.userActivation.hasBeenActive) return;
    this.context ??= new AudioContext();
    let at_s = this.context.currentTime;
    for (const [frequency_hz, length_s] of tone) {
      const oscillator = this.context.createOscillator();
      const gain = this.context.createGain();
      oscillator.frequency.value = frequency_hz;
      gain.gain.setValueAtTime(VOLUME, at_s);
      gain.gain.exponentialRampToValueAtTime(0.001, at_s + length_s);
      oscillator.connect(gain).connect(this.context.destination);
      oscillator.start(at_s);
      oscillator.stop(at_s + length_s);
      at_s += length_s;
    }
  }
}
