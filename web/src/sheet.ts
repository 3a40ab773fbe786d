/** A sheet over the panels that never covers the banner: the emergency stop stays in reach. */

import { h } from "./dom";
import { type Key, titled, translated } from "./i18n";

export class Sheet {
  readonly element: HTMLDialogElement;
  private readonly close_: HTMLButtonElement;

  constructor(title: Key, ...content: HTMLElement[]) {
    this.close_ = titled(h("button", { class: "button round", type: "button" }, "×"), "button.close");
    this.close_.addEventListener("click", () => this.close());
    this.element = h("dialog", { class: "sheet" }, h("header", {}, translated(h("h2"), title), this.close_), ...content);
    window.addEventListener("keydown", (event) => event.key === "Escape" && this.close());
  }

  open(): void {
    // One sheet at a time.
    for (const other of document.querySelectorAll<HTMLDialogElement>("dialog.sheet[open]")) if (other !== this.element) other.close();
    // Not modal: a modal dialog would make the stop button deaf.
    if (!this.element.open) this.element.show();
    this.close_.focus();
  }

  close(): void {
    // A closed sheet's input keeps the focus until the browser draws again; keys pressed meanwhile would be lost in it.
    if (this.element.contains(document.activeElement)) (document.activeElement as HTMLElement).blur();
    this.element.close();
  }

  toggle(): void {
    if (this.element.open) this.close();
    else this.open();
  }
}
