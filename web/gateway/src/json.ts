// JSON of answers: typed arrays become arrays, numbers of single precision as short as they can be.

// Nine digits name every number of single precision.
const short = (value: number): string => String(Number(value.toPrecision(9)));

/** The text of a value. Numbers have to be finite, as those of the client are. */
export function toJson(value: unknown): string {
  if (value instanceof Float32Array) return `[${Array.from(value, short).join()}]`;
  if (ArrayBuffer.isView(value)) return `[${(value as Float64Array).join()}]`;
  if (Array.isArray(value)) return `[${value.map(toJson).join()}]`;
  if (typeof value !== "object" || value === null || value instanceof Date) {
    return JSON.stringify(value) ?? "null";
  }
  const entries = Object.entries(value).filter(([, inner]) => inner !== undefined);
  return `{${entries.map(([name, inner]) => `${JSON.stringify(name)}:${toJson(inner)}`).join()}}`;
}
