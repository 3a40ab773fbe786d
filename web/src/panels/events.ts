/** What happened, newest first, in plain words. */

import { h } from "../dom";
import { fruitWords } from "../fruit";
import { detailText, reasonText, t } from "../i18n";
import { type Panel, frame } from "../panel";
import type { EventMessage } from "../wire";

const KEPT = 80;

export class EventsPanel implements Panel {
  readonly element: HTMLElement;
  private readonly list = h("ol", { class: "events", tabindex: 0 });
  private readonly kept: EventMessage[] = [];

  constructor() {
    this.element = frame("events", "panel.events", this.list).element;
    this.restyle();
  }

  event(event: EventMessage): void {
    if (this.kept.some((old) => old.t === event.t && old.reason === event.reason)) return; // told again on reconnecting
    if (this.kept.length === 0) this.list.replaceChildren();
    this.kept.push(event);
    if (this.kept.length > KEPT) {
      this.kept.shift();
      this.list.lastElementChild?.remove();
    }
    this.list.prepend(entry(event));
  }

  restyle(): void {
    this.list.replaceChildren(...this.kept.map(entry).reverse());
    if (this.kept.length === 0) this.list.append(h("li", { class: "nothing" }, t("events.empty")));
  }
}

function entry(event: EventMessage): HTMLElement {
  const family = event.reason.split(".")[0] ?? event.kind;
  const text = h("span", {}, reasonText(event.reason));
  if (event.detail) text.append(" ", h("small", {}, fruitWords(detailText(event.reason, event.detail))));
  return h("li", { "data-family": family, "data-reason": event.reason }, h("time", {}, timeOfDay(event.t)), text);
}

/** Local wall-clock time of a Unix time stamp. */
function timeOfDay(unix_s: number): string {
  return new Date(1000 * unix_s).toLocaleTimeString("en-GB");
}
