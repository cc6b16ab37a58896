// Runs of numbers on the wire. proto3 packs them: one length, then the numbers one behind the
// other, floating point ones little-endian, integers as varints. Floating point runs become typed
// arrays without looking at a single number: views of the message where that can be, else copies.
import { endianness } from "node:os";

/** Numbers that a caller may give. They are copied: the caller's array may change at once. */
export type Numbers = Float64Array | Float32Array | readonly number[];
/** Indices that a caller may give: whole numbers from 0 to 4294967295. */
export type Indices = Uint32Array | Uint16Array | readonly number[];

const swaps = endianness() === "BE";

type Constructor<T> = {
  new (buffer: ArrayBufferLike, offset: number, length: number): T;
  BYTES_PER_ELEMENT: number;
};

// Of a run in a message that was decoded and is not read again. A view of where the bytes lie,
// moved by up to three bytes to their boundary: the tag and the length before a run of 128 bytes
// and more take as many, and have been read. Else a copy.
function view<T>(bytes: Uint8Array, type: Constructor<T>): T {
  const size = type.BYTES_PER_ELEMENT;
  if (bytes.length % size !== 0) {
    throw new RangeError(`${bytes.length} bytes are no run of numbers of ${size} bytes`);
  }
  const length = bytes.length / size;
  const shift = bytes.byteOffset % size;
  if (!swaps && (shift === 0 || (shift <= 3 && bytes.length >= 128))) {
    const start = bytes.byteOffset - shift;
    if (shift > 0) new Uint8Array(bytes.buffer, start, bytes.length + shift).copyWithin(0, shift);
    return new type(bytes.buffer, start, length);
  }
  const copy = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length);
  if (swaps && size === 2) Buffer.from(copy).swap16();
  if (swaps && size === 4) Buffer.from(copy).swap32();
  if (swaps && size === 8) Buffer.from(copy).swap64();
  return new type(copy, 0, length);
}

export const float32Run = (bytes: Uint8Array): Float32Array => view(bytes, Float32Array);
export const int16Run = (bytes: Uint8Array): Int16Array => view(bytes, Int16Array);
export const float64Run = (bytes: Uint8Array): Float64Array => view(bytes, Float64Array);

/** Unsigned numbers of 32 bits that were packed as varints. */
export function uint32Run(bytes: Uint8Array): Uint32Array {
  // Every number ends with the one of its bytes that has no continuation bit.
  let count = 0;
  for (let i = 0; i < bytes.length; i++) if (bytes[i]! < 0x80) count++;
  const numbers = new Uint32Array(count);
  let at = 0;
  for (let i = 0; i < count; i++) {
    let number = 0;
    let shift = 0;
    let byte: number;
    do {
      byte = bytes[at++]!;
      if (shift < 32) number |= (byte & 0x7f) << shift;
      shift += 7;
    } while (byte >= 0x80);
    numbers[i] = number >>> 0;
  }
  if (at !== bytes.length) throw new RangeError("a run of whole numbers ends in the middle of one");
  return numbers;
}

/** The bytes of doubles, little-endian; always a copy. */
export function packFloat64(numbers: Numbers): Uint8Array {
  const bytes = Buffer.from(Float64Array.from(numbers).buffer);
  return swaps ? bytes.swap64() : bytes;
}

/** Varints. RangeError, with the place, for what is no unsigned number of 32 bits. */
export function packUint32(numbers: Indices): Uint8Array {
  const bytes = new Uint8Array(numbers.length * 5);
  let length = 0;
  for (let i = 0; i < numbers.length; i++) {
    let rest = numbers[i]!;
    if (!isUint32(rest))
      throw new RangeError(`[${i}] is ${rest}, which is no whole number from 0 to 4294967295`);
    while (rest >= 0x80) {
      bytes[length++] = (rest & 0x7f) | 0x80;
      rest >>>= 7;
    }
    bytes[length++] = rest;
  }
  return bytes.subarray(0, length);
}

export const isUint32 = (value: number): boolean => value >>> 0 === value;

/** The first number that is not finite, or -1. */
export function firstNonFinite(numbers: Float32Array | Float64Array): number {
  // 0 times anything but a finite number is NaN. Four sums, so that they need not wait for one
  // another.
  let a = 0;
  let b = 0;
  let c = 0;
  let d = 0;
  const end = numbers.length & ~3;
  for (let i = 0; i < end; i += 4) {
    a += numbers[i]! * 0;
    b += numbers[i + 1]! * 0;
    c += numbers[i + 2]! * 0;
    d += numbers[i + 3]! * 0;
  }
  for (let i = end; i < numbers.length; i++) a += numbers[i]! * 0;
  if (a + b + c + d === 0) return -1;
  return numbers.findIndex((number) => !Number.isFinite(number));
}
