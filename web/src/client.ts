/** The key by which the server knows this tab again, also after a reload. A secret: others see only an id made of it. */

const STORED = "greenhouse-client";
const BYTES = 18;

function made(): string {
  const bytes = crypto.getRandomValues(new Uint8Array(BYTES));
  const key = btoa(String.fromCharCode(...bytes)).replaceAll("+", "-").replaceAll("/", "_");
  sessionStorage.setItem(STORED, key);
  return key;
}

export const clientKey: string = sessionStorage.getItem(STORED) ?? made();
