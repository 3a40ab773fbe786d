/** A partial configuration as the TOML file that `teleop serve --config` reads. Pure. */

import type { Value } from "./schema";

function literal(value: Value): string {
  return typeof value === "string" ? JSON.stringify(value) : String(value);
}

/** values: path -> value; one table per section, in the order given. */
export function toml(values: ReadonlyMap<string, Value>): string {
  const tables = new Map<string, string[]>();
  for (const [path, value] of values) {
    if (value === null) continue; // TOML knows no null: the default is meant
    const cut = path.lastIndexOf(".");
    const table = path.slice(0, cut);
    const lines = tables.get(table) ?? [];
    tables.set(table, [...lines, `${path.slice(cut + 1)} = ${literal(value)}`]);
  }
  return [...tables].map(([table, lines]) => `[${table}]\n${lines.join("\n")}\n`).join("\n");
}

/** Offers a text as a file. */
export function download(name: string, text: string): void {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([text], { type: "application/toml" }));
  link.download = name;
  link.click();
  URL.revokeObjectURL(link.href);
}
