/** Small helpers over the DOM; nothing here knows the application. */

type Child = Node | string;
type Attributes = Record<string, string | number | boolean>;

function fill(element: Element, attributes: Attributes, children: Child[]): void {
  for (const [name, value] of Object.entries(attributes)) {
    if (value === true) element.setAttribute(name, "");
    else if (value !== false) element.setAttribute(name, String(value));
  }
  element.append(...children);
}

/** Creates an HTML element. */
export function h<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  attributes: Attributes = {},
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  fill(element, attributes, children);
  return element;
}

/** Creates an SVG element. */
export function s<K extends keyof SVGElementTagNameMap>(
  tag: K,
  attributes: Attributes = {},
  ...children: Child[]
): SVGElementTagNameMap[K] {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
  fill(element, attributes, children);
  return element;
}

/** Text that touches the DOM only when it changes; panels call `set` on every frame. */
export class Text {
  private last = "";
  constructor(readonly element: Element) {}

  set(text: string): void {
    if (text === this.last) return;
    this.last = text;
    this.element.textContent = text;
  }
}

/** Attribute that touches the DOM only when it changes. */
export class Attribute {
  private last: string | null = null;
  constructor(
    private readonly element: Element,
    private readonly name: string,
  ) {}

  set(value: string): void {
    if (value === this.last) return;
    this.last = value;
    this.element.setAttribute(this.name, value);
  }
}

/** Makes a canvas as large as its box, in device pixels; true when its size changed (and its content was lost). */
export function fitCanvas(canvas: HTMLCanvasElement, max_ratio = 2): boolean {
  const ratio = Math.min(window.devicePixelRatio || 1, max_ratio);
  const width = Math.max(1, Math.round(canvas.clientWidth * ratio));
  const height = Math.max(1, Math.round(canvas.clientHeight * ratio));
  if (canvas.width === width && canvas.height === height) return false;
  canvas.width = width;
  canvas.height = height;
  return true;
}

/** So many root font sizes in pixels. */
export function rem(count: number): number {
  return count * Number.parseFloat(getComputedStyle(document.documentElement).fontSize);
}

/** Value of a CSS custom property of the page, such as `--accent`. */
export function cssColor(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}
