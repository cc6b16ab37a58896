// What every answer is checked for before it is handed out: lengths, indices, ids, finite numbers.
// An answer that does not fit what was asked for is an ArapError with the reason INTERNAL.
import { isName } from "./channel.js";
import { badAnswer, badOption } from "./errors.js";
import { firstNonFinite, isUint32, packFloat64, packUint32 } from "./runs.js";
import type { Indices, Numbers } from "./runs.js";

/** How large a mesh is. */
export interface MeshSize {
  vertices: number;
  triangles: number;
}

export function checkFinite(
  numbers: Float32Array | Float64Array,
  dimension: number,
  what: string,
): void {
  const at = firstNonFinite(numbers);
  if (at >= 0)
    throw badAnswer(
      `The server answered ${what} ${Math.floor(at / dimension)} that is not finite.`,
    );
}

export function checkNumbers(numbers: readonly number[], what: string): void {
  if (!numbers.every(Number.isFinite))
    throw badAnswer(`The server answered a number of ${what} that is not finite.`);
}

/** `what` says what there are so many of, `expected` of them being right. */
export function checkCount(count: number, expected: number, what: string): void {
  if (count !== expected) throw badAnswer(`The server answered ${count} ${what}, not ${expected}.`);
}

export function checkIndices(indices: ArrayLike<number>, limit: number, what: string): void {
  for (let i = 0; i < indices.length; i++) {
    if (indices[i]! >= limit) {
      throw badAnswer(`The server answered ${what} ${indices[i]}, but there are only ${limit}.`);
    }
  }
}

/** The id that was asked for, or any when that is empty. */
export function checkId(id: string, asked: string, what: string): void {
  if (asked === "" ? isName(id) : id === asked) return;
  const than = asked === "" ? ", which is no id" : `, not ${JSON.stringify(asked)}`;
  throw badAnswer(`The server answered the ${what} ${JSON.stringify(id)}${than}.`);
}

/** The message of an answer, which has to be there. */
export function present<T>(message: T | null | undefined, what: string): T {
  if (message == null) throw badAnswer(`The server answered without ${what}.`);
  return message;
}

/** What a run of an answer holds. */
export function runOf<T>(bytes: Uint8Array, read: (bytes: Uint8Array) => T, what: string): T {
  try {
    return read(bytes);
  } catch (error) {
    throw badAnswer(
      `The server answered ${what} that cannot be read: ${(error as Error).message}.`,
    );
  }
}

/** An index or a count that is sent. INVALID_OPTION for what is none. */
export function index(value: number, field: string): number {
  if (isUint32(value)) return value;
  throw badOption(field, `${field} is ${value}, which is no whole number from 0 to 4294967295.`);
}

/** A run of indices that is sent. */
export function indexRun(numbers: Indices, field: string): Uint8Array {
  try {
    return packUint32(numbers);
  } catch (error) {
    throw badOption(field, `${field}${(error as Error).message}.`);
  }
}

/** A run of coordinates that is sent. */
export function numberRun(numbers: Numbers, field: string): Uint8Array {
  if (ArrayBuffer.isView(numbers) || Array.isArray(numbers)) return packFloat64(numbers);
  throw badOption(field, `${field} has to be a typed array or an array of numbers.`);
}

type Name<Enum extends string, Prefix extends string> = Enum extends `${Prefix}${infer Rest}`
  ? Exclude<Lowercase<Rest>, "unspecified">
  : never;
/**
 * The names of an enumeration of the wire, without prefix and in lower case: "BASIS_EDGE" is
 * "edge".
 */
export type Names<Enum, Prefix extends string> = Name<Extract<Enum, string>, Prefix>;

/** The value on the wire of a name; INVALID_OPTION for what is no name. */
export function toEnum<Value extends string>(
  values: Readonly<Record<string, Value>>,
  prefix: string,
  name: string | undefined,
  field: string,
): Value {
  const value = values[`${prefix}${(name ?? "unspecified").toUpperCase()}`];
  if (value !== undefined && name !== "unspecified") return value;
  const names = Object.keys(values).map((key) => key.slice(prefix.length).toLowerCase());
  const known = names.filter((known) => known !== "unspecified").join(", ");
  throw badOption(field, `${field} is ${JSON.stringify(name)}, which is none of ${known}.`);
}
