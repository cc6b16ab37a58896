// Validation: what a schema refuses, told with its place. Nothing is changed on the way: no text
// becomes a number, and what an object does not know is refused.
import { Ajv } from "ajv";
import type { ErrorObject, ValidateFunction } from "ajv";

import { Problem } from "./problems.js";

const ajv = new Ajv({ strict: false, allErrors: false, coerceTypes: false, strictNumbers: true });
const compiled = new WeakMap<object, ValidateFunction>();

// "/handles/3/weight" is handles[3].weight.
function fieldOf({ instancePath, params }: ErrorObject): string {
  const inner = params as { additionalProperty?: string; missingProperty?: string };
  const extra = inner.additionalProperty ?? inner.missingProperty;
  const parts = instancePath.split("/").slice(1);
  if (extra !== undefined) parts.push(extra);
  return parts
    .map((part) => part.replaceAll("~1", "/").replaceAll("~0", "~").slice(0, 128))
    .reduce(
      (path, part) =>
        /^\d+$/.test(part) ? `${path}[${part}]` : path === "" ? part : `${path}.${part}`,
      "",
    );
}

function sentenceOf(error: ErrorObject, field: string, what: string): string {
  const place = field === "" ? what : field;
  const { allowedValues } = error.params as { allowedValues?: readonly unknown[] };
  switch (error.keyword) {
    case "additionalProperties":
      return `${place}: there is no such property.`;
    case "required":
      return `${place} is missing.`;
    case "enum":
      return `${place} has to be one of ${(allowedValues ?? []).join(", ")}.`;
    case "oneOf":
      return `${place} has to have exactly one of vertex, triangle with barycentric, or position.`;
    default:
      return `${place} ${error.message ?? "does not fit the schema"}.`;
  }
}

/** MALFORMED, with the field, for what the schema refuses. `what` is what the whole is called. */
export function check(schema: object, value: unknown, what = "The body"): void {
  let validate = compiled.get(schema);
  if (!validate) compiled.set(schema, (validate = ajv.compile(schema)));
  if (validate(value)) return;
  const errors = validate.errors ?? [];
  // Inside alternatives the last one is about the whole.
  const error = errors.find(({ keyword }) => keyword === "oneOf") ?? errors[0];
  if (!error) throw new Problem("MALFORMED", `${what} does not fit the schema.`);
  const field = fieldOf(error);
  throw new Problem("MALFORMED", sentenceOf(error, field, what), { field });
}
