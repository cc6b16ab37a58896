// Deformed meshes: what to ask for and what comes back.
import {
  checkCount,
  checkId,
  checkIndices,
  checkNumbers,
  index,
  numberRun,
  present,
  runOf,
  toEnum,
} from "./checks.js";
import type { MeshSize, Names } from "./checks.js";
import { badAnswer, badOption } from "./errors.js";
import { DeformMode } from "./gen/arap/v1/DeformMode.js";
import type { DeformModeAnswer } from "./gen/arap/v1/DeformMode.js";
import type { DeformOptions as WireOptions } from "./gen/arap/v1/DeformOptions.js";
import type { PickResultAnswer } from "./gen/arap/v1/PickResult.js";
import type { ShapeAnswer } from "./gen/arap/v1/Shape.js";
import type { Point } from "./handles.js";
import { positionOptionsToWire, positionsOf } from "./positions.js";
import type { PositionOptions, Positions } from "./positions.js";
import { float64Run, uint32Run } from "./runs.js";
import type { Numbers } from "./runs.js";

/** How to deform, and how to answer. */
export interface ShapeOptions extends PositionOptions {
  /** What to minimise. Default "rigid". */
  mode?: Names<DeformModeAnswer, "DEFORM_MODE_">;
  /** Iterations of the second step from its own result. Default 0. */
  refine?: number;
  /** Also answer the ids of flipped triangles, of shapes that are measured. */
  flippedIds?: boolean;
  /**
   * Which shapes of a stream or track are measured: the first, and every n-th after one that was.
   * Default 1: all; 0: none. Measuring takes the server about a quarter of a frame.
   */
  measureEvery?: number;
}

/** Where a point of a deformed shape was at rest. */
export interface Pick {
  /** The highest depth, then the lowest index, where triangles overlap. */
  triangle: number;
  /** In units of the mesh. */
  rest: Point;
  barycentric: readonly [number, number, number];
}

/** A deformed mesh and how good it is. Its arrays are yours to keep and change. */
export interface Shape extends Positions {
  /** Of the update that it answers, or the frame's index. */
  sequence: number;
  /** Updates that newer ones replaced since the last answer. */
  replaced: number;
  /**
   * Else flippedCount, flippedIds, energy, meanStretch and maxStretch say nothing: see
   * ShapeOptions.measureEvery.
   */
  measured: boolean;
  /** Triangles whose orientation is reversed. */
  flippedCount: number;
  /** Their ids, when asked. */
  flippedIds: Uint32Array;
  /** Largest distance between a handle and its target, in units of the mesh. */
  worstHandleError: number;
  /** Empty without handles. */
  worstHandleId: string;
  energy: number;
  /** Area-weighted mean over triangles of the larger of s1 and 1/s2. */
  meanStretch: number;
  maxStretch: number;
  /** That the update waited for a worker. */
  queueMicros: number;
  /** That it took to compute. */
  solveMicros: number;
  /** One per picked point; null where nothing lies. */
  picks: (Pick | null)[];
  /** Of the handle set that made this shape. */
  handleSetRevision: number;
}

/** At most so many points of a message are picked. */
const maxPicks = 1024;

export const shapeOptionsToWire = (options: ShapeOptions): WireOptions => ({
  ...(options.mode && { mode: toEnum(DeformMode, "DEFORM_MODE_", options.mode, "options.mode") }),
  refine: index(options.refine ?? 0, "options.refine"),
  ...positionOptionsToWire(options),
  includeFlippedIds: options.flippedIds ?? false,
  ...(options.measureEvery !== undefined && {
    measureEvery: index(options.measureEvery, "options.measure_every"),
  }),
});

export function picksToWire(points: Numbers, field: string): Uint8Array {
  if (points.length % 2 !== 0)
    throw badOption(field, `${field} has ${points.length} numbers, an odd count.`);
  return numberRun(points, field);
}

/** What a shape was asked to be. */
export interface ShapeQuestion {
  options: ShapeOptions;
  /** When it is known. */
  mesh: MeshSize | undefined;
  /** Which its positions are of; null: all. */
  vertices: Uint32Array | null;
  /** As many as were asked; undefined when that is not known any more. */
  picks: number | undefined;
  /** Whether it has to be measured. */
  measured: boolean;
}

/**
 * Counts which shapes of a stream or track have to be measured: the first, and every n-th after one
 * that was.
 */
export class MeasureCount {
  readonly #every: number;
  #unmeasured: number; // shapes since the last that was measured

  constructor(options: ShapeOptions) {
    this.#every = options.measureEvery ?? 1;
    this.#unmeasured = this.#every - 1;
  }
  /** Whether the next shape has to be. */
  isDue(): boolean {
    return this.#every > 0 && this.#unmeasured + 1 >= this.#every;
  }
  answered(unmeasured: boolean): void {
    this.#unmeasured = unmeasured ? this.#unmeasured + 1 : 0;
  }
}

function pickOf(pick: PickResultAnswer, mesh: MeshSize | undefined): Pick | null {
  if (!pick.hit) return null;
  if (mesh) checkIndices([pick.triangle], mesh.triangles, "triangle");
  const weights = runOf(pick.barycentric, float64Run, "weights");
  checkCount(weights.length, 3, "weights of a pick");
  const rest = present(pick.rest, "the place of a pick");
  const barycentric = [weights[0]!, weights[1]!, weights[2]!] as const;
  checkNumbers([rest.x, rest.y, ...barycentric], "a pick");
  return { triangle: pick.triangle, rest: [rest.x, rest.y], barycentric };
}

function flippedOf(shape: ShapeAnswer, asked: ShapeQuestion): Uint32Array {
  const flipped = runOf(shape.flippedIds, uint32Run, "flipped triangles");
  if (!asked.options.flippedIds) checkCount(flipped.length, 0, "flipped triangles");
  if (asked.mesh) {
    checkIndices(flipped, asked.mesh.triangles, "triangle");
    if (flipped.length > asked.mesh.triangles) {
      throw badAnswer("The server answered more flipped triangles than there are triangles.");
    }
  }
  return flipped;
}

function checkMeasures(shape: ShapeAnswer, asked: ShapeQuestion): void {
  checkNumbers(
    [shape.worstHandleError, shape.energy, shape.meanStretch, shape.maxStretch],
    "the quality of a shape",
  );
  if (!shape.unmeasured) return;
  if (asked.measured)
    throw badAnswer("The server answered a shape without the measures that were asked for.");
  if (
    shape.flippedCount !== 0 ||
    shape.flippedIds.length > 0 ||
    shape.energy !== 0 ||
    shape.meanStretch !== 0 ||
    shape.maxStretch !== 0
  )
    throw badAnswer("The server answered measures of a shape that it says it has not measured.");
}

export function shapeOf(answer: ShapeAnswer | null | undefined, asked: ShapeQuestion): Shape {
  const shape = present(answer, "the shape");
  const positions = positionsOf(shape, asked.options, asked.mesh, asked.vertices);
  checkMeasures(shape, asked);
  if (shape.worstHandleId !== "") checkId(shape.worstHandleId, "", "handle");
  checkCount(shape.picks.length, asked.picks ?? Math.min(shape.picks.length, maxPicks), "picks");
  return Object.assign(positions, {
    sequence: shape.sequence,
    replaced: shape.replaced,
    measured: !shape.unmeasured,
    flippedCount: shape.flippedCount,
    flippedIds: flippedOf(shape, asked),
    worstHandleError: shape.worstHandleError,
    worstHandleId: shape.worstHandleId,
    energy: shape.energy,
    meanStretch: shape.meanStretch,
    maxStretch: shape.maxStretch,
    queueMicros: shape.queueMicros,
    solveMicros: shape.solveMicros,
    picks: shape.picks.map((pick) => pickOf(pick, asked.mesh)),
    handleSetRevision: shape.handleSetRevision,
  });
}
