/** The configuration's JSON schema as a flat list of fields. Pure. */

export type Value = number | boolean | string | null;
export type Json = { [key: string]: Json | Value | Value[] };

export interface Schema {
  $ref?: string;
  $defs?: Record<string, Schema>;
  type?: string;
  properties?: Record<string, Schema>;
  enum?: Value[];
  const?: Value;
  description?: string;
  default?: unknown;
  minimum?: number;
  maximum?: number;
  exclusiveMinimum?: number;
  exclusiveMaximum?: number;
}

export type FieldKind = "number" | "integer" | "boolean" | "choice" | "text";

export interface Field {
  /** From the root of the configuration, such as `teleop.intent.zones.l1_m`. */
  path: string;
  section: string;
  name: string;
  kind: FieldKind;
  choices: readonly string[];
  low: number | null;
  high: number | null;
  unit: string;
  /** What it is, and where its value comes from. */
  about: string;
  standard: Value | undefined;
}

const KINDS: Record<string, FieldKind> = { number: "number", integer: "integer", boolean: "boolean", string: "text" };
const UNIT = /\s*\[([^\]]+)\]/;

function resolved(schema: Schema, root: Schema): Schema {
  const name = schema.$ref?.split("/").at(-1);
  const target = name === undefined ? undefined : root.$defs?.[name];
  return target ? { ...target, ...schema } : schema;
}

/** Every field under a section, in the schema's order; what no input can show (lists, nothing at all) is left out. */
export function fieldsOf(root: Schema, section: string): Field[] {
  let schema = root;
  for (const part of section.split(".")) schema = resolved(schema.properties?.[part] ?? {}, root);
  return collect(schema, section, root);
}

function collect(schema: Schema, section: string, root: Schema): Field[] {
  const found: Field[] = [];
  for (const [name, entry] of Object.entries(schema.properties ?? {})) {
    const inner = resolved(entry, root);
    const path = `${section}.${name}`;
    if (inner.properties) found.push(...collect(inner, path, root));
    else {
      const field = leaf(inner, path, section, name);
      if (field) found.push(field);
    }
  }
  return found;
}

function leaf(schema: Schema, path: string, section: string, name: string): Field | null {
  const kind = schema.enum ? "choice" : KINDS[schema.type ?? ""];
  if (!kind) return null;
  const about = schema.description ?? "";
  return {
    path,
    section,
    name,
    kind,
    choices: (schema.enum ?? []).map(String),
    low: schema.minimum ?? schema.exclusiveMinimum ?? null,
    high: schema.maximum ?? schema.exclusiveMaximum ?? null,
    unit: UNIT.exec(about)?.[1] ?? "",
    about: about.replace(UNIT, ""),
    standard: schema.default as Value | undefined,
  };
}

/** The value at a path; undefined where there is none. */
export function valueAt(config: Json, path: string): Value | undefined {
  let at: unknown = config;
  for (const part of path.split(".")) at = (at as Json | undefined)?.[part];
  return at as Value | undefined;
}

/** A partial tree that holds only these values: what PATCH takes. */
export function treeOf(values: ReadonlyMap<string, Value>): Json {
  const tree: Json = {};
  for (const [path, value] of values) {
    const parts = path.split(".");
    const last = parts.pop() ?? path;
    let at = tree;
    for (const part of parts) at = (at[part] ??= {}) as Json;
    at[last] = value;
  }
  return tree;
}

/** The part of a refusal that speaks of each path; what speaks of none of them is under "". */
export function refusals(detail: string, paths: readonly string[]): Map<string, string> {
  const starts = paths
    .map((path) => ({ path, at: detail.indexOf(`${path}: `) }))
    .filter(({ at }) => at >= 0)
    .sort((a, b) => a.at - b.at);
  const found = new Map<string, string>();
  if (starts.length === 0) return found.set("", detail);
  starts.forEach(({ path, at }, i) => {
    const text = detail.slice(at + path.length + 2, starts[i + 1]?.at ?? detail.length);
    found.set(path, text.replace(/;\s*$/, ""));
  });
  return found;
}
