/** Keys and gestures on one sheet. */

import { h } from "../dom";
import { type Key, translated } from "../i18n";
import { Sheet } from "../sheet";

const KEYS: readonly (readonly [string, Key])[] = [
  ["key.space", "help.space"],
  ["Shift + R", "help.reset"],
  ["E", "help.engage"],
  ["P", "help.pause"],
  ["← →", "help.seek"],
  ["[ ]", "help.speed"],
  [".", "help.step"],
  ["O", "help.loop"],
  ["R", "help.record"],
  ["B", "help.recordings"],
  ["V", "help.image"],
  ["N", "help.parts"],
  ["C", "help.numbers"],
  ["H", "help.head"],
  ["M", "help.mirror"],
  ["F", "help.follow"],
  ["G", "help.pick"],
  ["D", "help.far"],
  ["K", "help.calibrate"],
  [",", "help.settings"],
  ["T", "help.theme"],
  ["L", "help.language"],
  ["S", "help.sound"],
  ["?", "help.help"],
];
const GESTURES: readonly Key[] = ["help.gesture.engage", "help.gesture.stop", "help.gesture.hands", "help.gesture.pick"];

export function helpSheet(): Sheet {
  const keys = h("dl", { class: "keys" });
  for (const [key, meaning] of KEYS) {
    const cap = key === "key.space" ? translated(h("kbd"), "key.space") : h("kbd", {}, key);
    keys.append(h("dt", {}, cap), translated(h("dd"), meaning));
  }
  const gestures = h("ul", {}, ...GESTURES.map((gesture) => translated(h("li"), gesture)));
  return new Sheet("panel.help", keys, gestures);
}
