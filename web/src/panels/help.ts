/** Keys and gestures on one sheet. */

import { h } from "../dom";
import { type Key, titled, translated } from "../i18n";

const KEYS: readonly (readonly [string, Key])[] = [
  ["key.space", "help.space"],
  ["Shift + R", "help.reset"],
  ["E", "help.engage"],
  ["P", "help.pause"],
  ["← →", "help.seek"],
  ["[ ]", "help.speed"],
  ["V", "help.image"],
  ["M", "help.mirror"],
  ["F", "help.follow"],
  ["T", "help.theme"],
  ["L", "help.language"],
  ["S", "help.sound"],
  ["?", "help.help"],
];
const GESTURES: readonly Key[] = ["help.gesture.engage", "help.gesture.stop", "help.gesture.hands"];

export function helpDialog(): HTMLDialogElement {
  const close = titled(h("button", { class: "button round", type: "button" }, "×"), "button.close");
  const keys = h("dl", { class: "keys" });
  for (const [key, meaning] of KEYS) {
    const cap = key === "key.space" ? translated(h("kbd"), "key.space") : h("kbd", {}, key);
    keys.append(h("dt", {}, cap), translated(h("dd"), meaning));
  }
  const gestures = h("ul", {}, ...GESTURES.map((gesture) => translated(h("li"), gesture)));
  const dialog = h("dialog", { class: "sheet" }, h("header", {}, translated(h("h2"), "panel.help"), close), keys, gestures);
  close.addEventListener("click", () => dialog.close());
  return dialog;
}
