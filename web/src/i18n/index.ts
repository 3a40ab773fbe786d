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

/** Gives an element a text that follows the language. */
export function translated<E extends Element>(element: E, key: Key): E {
  element.setAttribute("data-i18n", key);
  element.textContent = t(key);
  return element;
}

/** Gives an element a name for pointer and screen reader that follows the language. */
export function titled<E extends Element>(element: E, key: Key): E {
  element.setAttribute("data-i18n-title", key);
  element.setAttribute("title", t(key));
  element.setAttribute("aria-label", t(key));
  return element;
}

export function setLanguage(next: Language): void {
  current = next;
  document.documentElement.lang = next === "zh" ? "zh-CN" : "en";
  document.title = t("title");
  for (const element of document.querySelectorAll("[data-i18n]")) {
    element.textContent = t(element.getAttribute("data-i18n") as Key);
  }
  for (const element of document.querySelectorAll("[data-i18n-placeholder]")) {
    const text = t(element.getAttribute("data-i18n-placeholder") as Key);
    element.setAttribute("placeholder", text);
    element.setAttribute("aria-label", text);
  }
  for (const element of document.querySelectorAll("[data-i18n-title]")) {
    const text = t(element.getAttribute("data-i18n-title") as Key);
    element.setAttribute("title", text);
    element.setAttribute("aria-label", text);
  }
}
