/** What every part of the screen looks like to the application: an element, fed with messages. */

import { h } from "./dom";
import { type Key, translated } from "./i18n";
import type { EventMessage, Hello, State } from "./wire";

export interface Panel {
  readonly element: HTMLElement;
  hello?(hello: Hello): void;
  /** Called once per painted frame with the newest state. */
  state?(state: State, now_ms: number): void;
  event?(event: EventMessage): void;
  /** The theme or the language changed: redraw what is not CSS. */
  restyle?(): void;
}

/** A titled frame for a panel's content. */
export function frame(name: string, title: Key, ...content: HTMLElement[]): { element: HTMLElement; tools: HTMLElement } {
  const tools = h("div", { class: "head-tools" });
  const heading = translated(h("h2"), title);
  const element = h("section", { class: `panel panel-${name}` }, h("header", {}, heading, tools), ...content);
  return { element, tools };
}
