// A surface as a file has it, and the builder that all readers fill. Memory is bounded by limits
// that are checked before anything grows.
import { cutPolygon, maxConcaveCorners } from "./polygon.js";

export type FileFormat = "obj" | "ply" | "stl" | "glb";

export interface FileWarning {
  kind: string;
  count: number;
  /** Faces, counted from 0. */
  elements: number[];
  message: string;
}

export interface Surface {
  format: FileFormat;
  /** x y z x y z…, length 3·#V. */
  vertices: Float64Array;
  /** Length 3·#F. */
  triangles: Uint32Array;
  /** Each from its first triangle to the next part; none of them empty. */
  parts: { firstTriangle: number; name: string }[];
  warnings: FileWarning[];
}

export interface FileLimits {
  vertices: number;
  triangles: number;
}

/** A text of a file without what ends lines or means something to a terminal. */
export const harmless = (text: string): string =>
  // eslint-disable-next-line no-control-regex
  text.replace(/[\u0000-\u001f\u007f-\u009f\u2028\u2029\u202a-\u202e]/g, "_");

/** What is wrong with a file: a sentence that names the place. */
export class FileFault extends Error {
  override readonly name = "FileFault";

  constructor(
    message: string,
    /** Whether it is only too large. */
    readonly tooLarge = false,
  ) {
    super(harmless(message));
  }
}

// An array of numbers that grows.
class Growing<T extends Float64Array | Uint32Array> {
  #numbers: T;
  length = 0;
  constructor(readonly make: (length: number) => T) {
    this.#numbers = make(1024);
  }
  push(value: number): void {
    if (this.length === this.#numbers.length) {
      const larger = this.make(2 * this.length);
      larger.set(this.#numbers);
      this.#numbers = larger;
    }
    this.#numbers[this.length++] = value;
  }
  get all(): T {
    return this.#numbers.subarray(0, this.length) as T;
  }
  taken(): T {
    return this.#numbers.slice(0, this.length) as T;
  }
}

const mostElements = 16;

export class SurfaceBuilder {
  readonly #limits: FileLimits;
  readonly #vertices = new Growing((length) => new Float64Array(length));
  readonly #triangles = new Growing((length) => new Uint32Array(length));
  // A face that waits until its vertices are known, as #corners, corners…; and where it is.
  readonly #faces = new Growing((length) => new Uint32Array(length));
  readonly #lines = new Growing((length) => new Uint32Array(length));
  readonly #parts: { firstFace: number; name: string }[] = [];
  readonly #warnings = new Map<string, FileWarning>();
  #faceCount = 0;

  constructor(limits: FileLimits) {
    this.#limits = limits;
  }

  get vertexCount(): number {
    return this.#vertices.length / 3;
  }
  get faceCount(): number {
    return this.#faceCount;
  }

  vertex(x: number, y: number, z: number): number {
    const index = this.vertexCount;
    if (index >= this.#limits.vertices) this.tooMany("vertices", this.#limits.vertices);
    this.#vertices.push(x);
    this.#vertices.push(y);
    this.#vertices.push(z);
    return index;
  }

  /** `line` is 0 where there are no lines. Corners may be of vertices that are still to come. */
  face(corners: ArrayLike<number>, line = 0): void {
    if (this.#faces.length - this.#faceCount + corners.length > 4 * this.#limits.triangles) {
      this.tooMany("triangles", this.#limits.triangles);
    }
    this.#faces.push(corners.length);
    for (let i = 0; i < corners.length; i++) this.#faces.push(corners[i]!);
    this.#lines.push(line);
    this.#faceCount++;
  }

  /** From this face on, by default the next one, the file speaks of a part of this name. */
  part(name: string, face = this.#faceCount): void {
    const last = this.#parts.at(-1);
    if (last?.firstFace === face) last.name = name;
    else if (last?.name !== name) this.#parts.push({ firstFace: face, name });
  }

  warn(kind: string, message: string, element?: number): void {
    const known = this.#warnings.get(kind);
    const warning = known ?? { kind, count: 0, elements: [], message };
    warning.count++;
    if (element !== undefined && warning.elements.length < mostElements)
      warning.elements.push(element);
    this.#warnings.set(kind, warning);
  }

  tooMany(what: string, limit: number): never {
    throw new FileFault(
      `The file has more than ${limit} ${what}, as many as the gateway takes.`,
      true,
    );
  }

  /** Cuts the faces into triangles. `what` names the place of a face in a sentence. */
  finish(format: FileFormat): Surface {
    const vertices = this.#vertices.taken();
    const faces = this.#faces.all;
    const parts: Surface["parts"] = [];
    let part = 0;
    for (let face = 0, at = 0; face < this.#faceCount; face++) {
      const count = faces[at]!;
      const corners = faces.subarray(at + 1, at + 1 + count);
      at += 1 + count;
      while (this.#parts[part]?.firstFace === face) {
        parts.push({ firstTriangle: this.#triangles.length / 3, name: this.#parts[part++]!.name });
      }
      this.#cut(vertices, corners, face);
      if (this.#triangles.length > 3 * this.#limits.triangles)
        this.tooMany("triangles", this.#limits.triangles);
    }
    if (this.#triangles.length === 0) throw new FileFault("The file has no faces.");
    if (!parts.some((one) => one.name !== "")) parts.length = 0;
    return {
      format,
      vertices,
      triangles: this.#triangles.taken(),
      parts: mostParts(parts, this.#triangles.length / 3),
      warnings: [...this.#warnings.values()],
    };
  }

  #cut(vertices: Float64Array, corners: Uint32Array, face: number): void {
    const line = this.#lines.all[face]!;
    const place = line > 0 ? `line ${line}` : `face ${face}`;
    const found = corners.findIndex((corner) => corner >= this.vertexCount);
    if (found >= 0) {
      throw new FileFault(
        `${place}: the face names vertex ${corners[found]! + 1}, but there are ${this.vertexCount}.`,
      );
    }
    const how = cutPolygon(vertices, corners, (a, b, c) => {
      this.#triangles.push(a);
      this.#triangles.push(b);
      this.#triangles.push(c);
    });
    if (how === "too_long") {
      throw new FileFault(
        `${place}: a concave face has ${corners.length} corners, more than ${maxConcaveCorners}.`,
      );
    }
    if (how === "unclear") {
      this.warn(
        "unclear_polygons",
        "Faces that cross themselves or have no area were cut from their first corner.",
        face,
      );
    }
  }
}

const mostNames = 100_000;
// Parts that hold triangles; a name with a line end or another control character has none.
function mostParts(parts: Surface["parts"], triangles: number): Surface["parts"] {
  return parts
    .filter((part, i) => part.firstTriangle < (parts[i + 1]?.firstTriangle ?? triangles))
    .slice(0, mostNames)
    .map(({ firstTriangle, name }) => ({ firstTriangle, name: plainName(name) }));
}
/** A name that stays on its line. */
export const plainName = (name: string): string => harmless(name).slice(0, 256);
