/** The operator's choices on this machine: theme, language, sound, picture, distance. */

import type { Language } from "./i18n";
import type { ImageChoice } from "./wire";

export interface Preferences {
  theme: "dark" | "light";
  language: Language;
  sound: boolean;
  mirror: boolean;
  image: ImageChoice;
  head: boolean;
  /** The forest's body parts over the picture. */
  parts: boolean;
  /** Every joint's confidence as a number. */
  numbers: boolean;
  /** Large letters for an operator who stands far away. */
  far: boolean;
}

const KEY = "greenhouse-console";

function defaults(): Preferences {
  return {
    theme: window.matchMedia("(prefers-color-scheme: light)").matches ? "light" : "dark",
    language: navigator.language.startsWith("zh") ? "zh" : "en",
    sound: true,
    mirror: true,
    image: "depth",
    head: false,
    parts: false,
    numbers: false,
    far: false,
  };
}

function read(): Preferences {
  const text = localStorage.getItem(KEY);
  if (text === null) return defaults();
  try {
    return { ...defaults(), ...(JSON.parse(text) as Partial<Preferences>) };
  } catch (error) {
    if (!(error instanceof SyntaxError)) throw error;
    return defaults(); // damaged storage: start anew
  }
}

export const prefs: Preferences = read();

export function savePrefs(): void {
  localStorage.setItem(KEY, JSON.stringify(prefs));
}
