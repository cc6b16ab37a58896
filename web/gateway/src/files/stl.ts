// STL, as text and in binary. Every triangle has corners of its own there: those with equal
// coordinates become one vertex, in the order of the file.
import { FileFault, SurfaceBuilder } from "./surface.js";
import type { FileLimits, Surface } from "./surface.js";
import { Lines, numberOf, quoted, wordsOf } from "./text.js";

const start = 84; // 80 bytes of any kind and the count
const triangleBytes = 50;

export const isBinaryStl = (bytes: Buffer): boolean =>
  bytes.length > start && bytes.length === start + triangleBytes * bytes.readUInt32LE(80);

// x y z of all corners, and where solids begin.
interface Soup {
  corners: Float64Array;
  lines: number[];
  solids: { triangle: number; name: string }[];
}

function binarySoup(bytes: Buffer, limits: FileLimits): Soup {
  if (bytes.length < start) throw new FileFault("The file is too short to be STL.");
  const count = bytes.readUInt32LE(80);
  const room = Math.floor((bytes.length - start) / triangleBytes);
  if (count > limits.triangles) {
    throw new FileFault(
      `The file has ${count} triangles; the gateway takes ${limits.triangles}.`,
      count <= room,
    );
  }
  if (bytes.length !== start + triangleBytes * count) {
    throw new FileFault(
      `byte 80: the header claims ${count} triangles, the file has room for ${room}.`,
    );
  }
  const corners = new Float64Array(9 * count);
  for (let t = 0, i = 0; t < count; t++) {
    for (let k = 0; k < 9; k++) {
      const at = start + triangleBytes * t + 12 + 4 * k;
      const value = bytes.readFloatLE(at);
      if (!Number.isFinite(value))
        throw new FileFault(`byte ${at}: ${value} is not a finite number.`);
      corners[i++] = value;
    }
  }
  return { corners, lines: [], solids: [] };
}

class TextReader {
  readonly #lines: Lines;
  readonly #most: number;
  #words: string[] = [];
  readonly #numbers: number[] = [];
  readonly #soup: Omit<Soup, "corners"> = { lines: [], solids: [] };

  constructor(bytes: Buffer, limits: FileLimits) {
    this.#lines = new Lines(bytes);
    this.#most = limits.triangles;
  }

  read(): Soup {
    for (let word = this.#next(); word !== undefined; word = this.#next()) {
      if (word.toLowerCase() !== "solid") throw this.#outOfPlace(word, "'solid'");
      this.#soup.solids.push({ triangle: this.#soup.lines.length, name: this.#words.join(" ") });
      this.#words = [];
      this.#solid();
    }
    return { ...this.#soup, corners: Float64Array.from(this.#numbers) };
  }

  #solid(): void {
    for (;;) {
      const word = this.#next();
      if (word?.toLowerCase() === "endsolid") break;
      if (word?.toLowerCase() !== "facet") throw this.#outOfPlace(word, "'facet' or 'endsolid'");
      this.#facet();
    }
    this.#words = []; // the name once more
  }

  #facet(): void {
    const line = this.#lines.number;
    let word = this.#next();
    if (word?.toLowerCase() === "normal") {
      // Three words of any kind: a program that finds no normal may write nan.
      for (let k = 0; k < 3; k++) this.#next();
      word = this.#next();
    }
    if (word?.toLowerCase() !== "outer") throw this.#outOfPlace(word, "'outer loop'");
    this.#expect("loop");
    for (let corner = 0; corner < 3; corner++) {
      this.#expect("vertex");
      for (let k = 0; k < 3; k++) {
        const number = this.#next();
        if (number === undefined) throw this.#outOfPlace(number, "a number");
        this.#numbers.push(numberOf(number, this.#lines.number));
      }
    }
    this.#expect("endloop");
    this.#expect("endfacet");
    this.#soup.lines.push(line);
    if (this.#soup.lines.length > this.#most) {
      throw new FileFault(
        `The file has more than ${this.#most} triangles, as many as the gateway takes.`,
        true,
      );
    }
  }

  #next(): string | undefined {
    while (this.#words.length === 0) {
      if (!this.#lines.next()) return undefined;
      this.#words = wordsOf(this.#lines.line);
    }
    return this.#words.shift();
  }

  #expect(wanted: string): void {
    const word = this.#next();
    if (word?.toLowerCase() !== wanted) throw this.#outOfPlace(word, `'${wanted}'`);
  }

  #outOfPlace(word: string | undefined, wanted: string): FileFault {
    const line = `line ${this.#lines.number}`;
    if (word === undefined)
      return new FileFault(`${line}: the text ends within a solid: ${wanted} is wanted.`);
    return new FileFault(`${line}: ${quoted(word)}: ${wanted} is wanted.`);
  }
}

/** For each corner the first one with the same coordinates; a table with open places. */
function firstTwins(corners: Float64Array): Uint32Array {
  const count = corners.length / 3;
  let size = 16;
  while (size < 2 * count) size *= 2;
  const table = new Uint32Array(size); // a corner, from 1
  const bits = new Uint32Array(new Float64Array(1).buffer);
  const number = new Float64Array(bits.buffer);
  const first = new Uint32Array(count);
  for (let corner = 0; corner < count; corner++) {
    let hash = 0;
    for (let k = 0; k < 3; k++) {
      number[0] = corners[3 * corner + k]! + 0; // -0 is 0
      hash = Math.imul(hash ^ bits[0]!, 0x85ebca6b);
      hash = Math.imul(hash ^ (hash >>> 13) ^ bits[1]!, 0xc2b2ae35);
    }
    let at = (hash ^ (hash >>> 16)) & (size - 1);
    for (; table[at] !== 0; at = (at + 1) & (size - 1)) {
      const other = table[at]! - 1;
      if ([0, 1, 2].every((k) => corners[3 * other + k] === corners[3 * corner + k])) break;
    }
    if (table[at] === 0) table[at] = corner + 1;
    first[corner] = table[at]! - 1;
  }
  return first;
}

function joined({ corners, lines, solids }: Soup, limits: FileLimits): Surface {
  const builder = new SurfaceBuilder(limits);
  const first = firstTwins(corners);
  const numbers = new Uint32Array(first.length); // of a vertex, from 1
  let solid = 0;
  for (let t = 0; 3 * t < first.length; t++) {
    const [a, b, c] = first.subarray(3 * t, 3 * t + 3);
    if (a === b || b === c || c === a) {
      const place = lines[t] === undefined ? `triangle ${t}` : `line ${lines[t]}`;
      builder.warn(
        "empty_triangles",
        `${place}: triangles with two equal corners are left out.`,
        t,
      );
      continue;
    }
    while (solid < solids.length && solids[solid]!.triangle <= t)
      builder.part(solids[solid++]!.name);
    const face = [a!, b!, c!].map((corner) => {
      if (numbers[corner] === 0) {
        const [x, y, z] = corners.subarray(3 * corner, 3 * corner + 3);
        numbers[corner] = builder.vertex(x!, y!, z!) + 1;
      }
      return numbers[corner]! - 1;
    });
    builder.face(face, lines[t] ?? 0);
  }
  const total = 3 * builder.faceCount;
  if (builder.vertexCount < total) {
    builder.warn(
      "joined_corners",
      `Corners with equal coordinates are one vertex: ${total} corners, ${builder.vertexCount} vertices.`,
    );
  }
  return builder.finish("stl");
}

export function readStl(bytes: Buffer, limits: FileLimits): Surface {
  const isText =
    /^\s*solid/i.test(bytes.toString("latin1", 0, 64)) && !bytes.subarray(0, 1024).includes(0);
  const soup =
    isText && !isBinaryStl(bytes)
      ? new TextReader(bytes, limits).read()
      : binarySoup(bytes, limits);
  return joined(soup, limits);
}
