/** Strings of the console in the chosen language; static text changes in place when the language does. */

import { en } from "./en";
import { zh } from "./zh";

export type Key = keyof typeof en;
export type Language = "en" | "zh";

const tables: Record<Language, Record<Key, string>> = { en, zh };
let current: Language = "en";

export function language(): Language {
  return current;
}

/** The text of a key, `{name}` replaced by the values given. */
export function t(key: Key, values?: Record<string, string | number>): string {
  const text = tables[current][key];
  if (!values) return text;
  return text.replace(/\{(\w+)\}/g, (_, name: string) => String(values[name] ?? ""));
}

/** The text of a key made at run time, such as `reason.stop.estop`; null when there is none. */
export function lookup(key: string): string | null {
  return Object.hasOwn(en, key) ? tables[current][key as Key] : null;
}

/** Plain words for a reason code; an unknown code is shown as it is. */
export function reasonText(code: string): string {
  return lookup(`reason.${code}`) ?? code;
}

/** Words of an event's detail: names of modes, zones and liquids are translated, what somebody wrote is left alone. */
export function detailText(reason: string, detail: string): string {
  const parts = detail.split(" -> ");
  // a zone and the mode that it begins share some names
  const zones = reason === "mode.zone_entered" && parts.every((part) => lookup(`zone.${part}`) !== null);
  const families = zones ? ["zone"] : ["mode", "zone", "liquid", "hand"];
  // what the robot says beside the name of a fruit is English; in Chinese the reason has its own words
  if (current === "zh" && /^(pick|assist)\./.test(reason)) return detail.split(": ")[0] ?? detail;
  const word = (code: string) => families.map((family) => lookup(`${family}.${code}`)).find((found) => found !== null) ?? code;
  return parts.map(word).join(" → ");
}

/** Elements whose words follow the language, also those that are not in the page just now. */
const followers = new Set<WeakRef<Element>>();
const TEXT = "data-i18n";
const TITLE = "data-i18n-title";
const HINT = "data-i18n-placeholder";

function follow(element: Element, attribute: string, key: Key): void {
  if (![TEXT, TITLE, HINT].some((name) => element.hasAttribute(name))) followers.add(new WeakRef(element));
  element.setAttribute(attribute, key);
  label(element);
}

function label(element: Element): void {
  const text = element.getAttribute(TEXT) as Key | null;
  if (text) element.textContent = t(text);
  const title = element.getAttribute(TITLE) as Key | null;
  if (title) element.setAttribute("title", t(title));
  const hint = element.getAttribute(HINT) as Key | null;
  if (hint) element.setAttribute("placeholder", t(hint));
  const name = title ?? hint;
  if (name) element.setAttribute("aria-label", t(name));
}

/** Gives an element a text that follows the language. */
export function translated<E extends Element>(element: E, key: Key): E {
  follow(element, TEXT, key);
  return element;
}

/** Gives an element a name for pointer and screen reader that follows the language. */
export function titled<E extends Element>(element: E, key: Key): E {
  follow(element, TITLE, key);
  return element;
}

/** Gives an input a hint that follows the language. */
export function hinted<E extends Element>(element: E, key: Key): E {
  follow(element, HINT, key);
  return element;
}

export function setLanguage(next: Language): void {
  current = next;
  document.documentElement.lang = next === "zh" ? "zh-CN" : "en";
  document.title = t("title");
  for (const reference of followers) {
    const element = reference.deref();
    if (element) label(element);
    else followers.delete(reference);
  }
}
