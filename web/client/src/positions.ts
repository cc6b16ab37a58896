// The positions of a shape: how they may be asked to travel, and what comes of them.
import {
  checkCount,
  checkFinite,
  checkIndices,
  checkNumbers,
  indexRun,
  runOf,
  toEnum,
} from "./checks.js";
import type { MeshSize, Names } from "./checks.js";
import { badAnswer } from "./errors.js";
import type { DeformOptions as WireOptions } from "./gen/arap/v1/DeformOptions.js";
import { PositionEncoding } from "./gen/arap/v1/PositionEncoding.js";
import type { PositionEncodingAnswer } from "./gen/arap/v1/PositionEncoding.js";
import type { ShapeAnswer } from "./gen/arap/v1/Shape.js";
import type { Point } from "./handles.js";
import { float32Run, float64Run, int16Run, uint32Run } from "./runs.js";
import type { Indices } from "./runs.js";

/** Which positions are answered, and how they travel. */
export interface PositionOptions {
  /** In double precision. */
  float64?: boolean;
  /**
   * In single precision relative to an origin that every shape states. Without it floats lose far
   * from 0 what lies between two of them, a quarter of a unit at 5,400,000; with it nothing.
   * Implied by "int16_le", without effect with float64.
   */
  relativeToOrigin?: boolean;
  /**
   * Default "float32". "int16_le" has half the size and is off by at most half of `scale`. Not with
   * float64. The two others cost the same here.
   */
  encoding?: Names<PositionEncodingAnswer, "POSITION_ENCODING_">;
  /** Of the vertices on the boundary alone. */
  boundaryOnly?: boolean;
  /** Of these vertices alone, in this order. */
  vertexSubset?: Indices;
}

/** Positions of a shape. */
export interface Positions {
  /**
   * x y x y… of the vertices in units of the mesh, wherever their origin is: a Float32Array, or a
   * Float64Array where float64 or an origin was asked for.
   */
  readonly positions: Float32Array | Float64Array;
  /**
   * The numbers that travelled: relative to the origin, and with "int16_le" in units of `scale`.
   */
  readonly local: Float32Array | Float64Array | Int16Array;
  /** 0, 0 unless one was asked for. */
  readonly origin: Point;
  /** 1 but with "int16_le". */
  readonly scale: number;
  /** Which vertices the positions are of, in their order; null: all. */
  readonly vertices: Uint32Array | null;
  /** How far a coordinate may be off by its way over the wire, in units of the mesh. */
  readonly positionError: number;
}

export const positionOptionsToWire = (options: PositionOptions): WireOptions => ({
  float64: options.float64 ?? false,
  relativeToOrigin: options.relativeToOrigin ?? false,
  ...(options.encoding && {
    encoding: toEnum(PositionEncoding, "POSITION_ENCODING_", options.encoding, "options.encoding"),
  }),
  boundaryOnly: options.boundaryOnly ?? false,
  vertexSubset: indexRun(options.vertexSubset ?? [], "options.vertex_subset"),
});

/** The vertices that all shapes of an answer are of; null: all. */
export function verticesOf(
  bytes: Uint8Array,
  options: PositionOptions,
  mesh: MeshSize | undefined,
): Uint32Array | null {
  const vertices = runOf(bytes, uint32Run, "vertices");
  const { vertexSubset = [], boundaryOnly = false } = options;
  if (vertexSubset.length > 0) {
    if (
      vertices.length !== vertexSubset.length ||
      vertices.some((vertex, i) => vertex !== vertexSubset[i])
    ) {
      throw badAnswer("The server answered other vertices than were asked for.");
    }
  } else if (!boundaryOnly) {
    checkCount(vertices.length, 0, "vertices of a part");
    return null;
  }
  if (vertices.length === 0) throw badAnswer("The server answered no vertices of the boundary.");
  if (boundaryOnly && vertices.some((vertex, i) => i > 0 && vertex <= vertices[i - 1]!)) {
    throw badAnswer("The server answered vertices of the boundary out of order.");
  }
  if (mesh) checkIndices(vertices, mesh.vertices, "vertex");
  return vertices;
}

type Field = "positions" | "positions64" | "packedPositions";

// The field that the positions are in; nothing is in the others.
function fieldOf(shape: ShapeAnswer, options: PositionOptions): Field {
  const packed = options.encoding === "float32_le" || options.encoding === "int16_le";
  const wanted = options.float64 ? "positions64" : packed ? "packedPositions" : "positions";
  for (const field of ["positions", "positions64", "packedPositions"] as const) {
    if (field !== wanted && shape[field].length > 0) {
      throw badAnswer(
        "The server answered a shape in another precision or encoding than was asked.",
      );
    }
  }
  return wanted;
}

function localOf(shape: ShapeAnswer, options: PositionOptions): Positions["local"] {
  const field = fieldOf(shape, options);
  if (options.float64) return runOf(shape[field], float64Run, "positions");
  if (options.encoding === "int16_le") return runOf(shape[field], int16Run, "positions");
  return runOf(shape[field], float32Run, "positions");
}

function originOf(shape: ShapeAnswer, options: PositionOptions): Point | undefined {
  const origin = runOf(shape.origin, float64Run, "an origin");
  const asked =
    options.encoding === "int16_le" || (options.relativeToOrigin === true && !options.float64);
  if (!asked && origin.length > 0) {
    throw badAnswer(
      "The server answered a shape relative to an origin for which it was not asked.",
    );
  }
  if (!asked) return undefined;
  // Of a server that has never heard of origins: the coordinates themselves.
  if (origin.length === 0 && options.encoding !== "int16_le") return undefined;
  if (origin.length !== 2)
    throw badAnswer("The server answered a shape without the origin that it is relative to.");
  checkNumbers([origin[0]!, origin[1]!], "an origin");
  return [origin[0]!, origin[1]!];
}

// What costs a pass over the numbers is found out when somebody asks for it.
function made(
  local: Positions["local"],
  origin: Point | undefined,
  scale: number,
  vertices: Uint32Array | null,
): Positions {
  let absolute: Positions["positions"] | undefined;
  let error: number | undefined;
  const place = (number: number, i: number): number => number * scale + origin![i % 2]!;
  const largest = (): number => {
    let most = 0;
    for (const number of local) most = Math.max(most, Math.abs(number));
    return most;
  };
  return {
    get positions() {
      if (!origin && !(local instanceof Int16Array)) return local;
      return (absolute ??= Float64Array.from(local, place));
    },
    local,
    origin: origin ?? [0, 0],
    scale,
    vertices,
    get positionError() {
      if (local instanceof Float64Array) return 0;
      return (error ??= local instanceof Int16Array ? scale / 2 : largest() / 2 ** 24);
    },
  };
}

/** The positions of a shape that were asked for. `vertices` as verticesOf has them. */
export function positionsOf(
  shape: ShapeAnswer,
  options: PositionOptions,
  mesh: MeshSize | undefined,
  vertices: Uint32Array | null,
): Positions {
  const local = localOf(shape, options);
  if (local.length % 2 !== 0) throw badAnswer("The server answered half a position.");
  if (local.length === 0) throw badAnswer("The server answered an empty shape.");
  const due = vertices?.length ?? mesh?.vertices;
  if (due !== undefined && local.length !== 2 * due) {
    const having = vertices ? `${due} were asked for` : `the mesh has ${due}`;
    throw badAnswer(`The server answered a shape of ${local.length / 2} vertices; ${having}.`);
  }
  if (!(local instanceof Int16Array)) checkFinite(local, 2, "the position of vertex");
  const origin = originOf(shape, options);
  checkNumbers([shape.scale], "a scale");
  return made(local, origin, local instanceof Int16Array ? shape.scale : 1, vertices);
}
