// Handles and their compilation: places of a mesh that the caller moves, and where they should go.
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
import type { Handle as WireHandle } from "./gen/arap/v1/Handle.js";
import type { HandleSetInfoAnswer } from "./gen/arap/v1/HandleSetInfo.js";
import type { HandleTarget as WireTarget } from "./gen/arap/v1/HandleTarget.js";
import { OutsidePolicy } from "./gen/arap/v1/OutsidePolicy.js";
import type { OutsidePolicyAnswer } from "./gen/arap/v1/OutsidePolicy.js";
import type { DurationAnswer } from "./gen/google/protobuf/Duration.js";
import { warningsOf } from "./mesh.js";
import type { Warning } from "./mesh.js";
import { float32Run, uint32Run } from "./runs.js";
import { microseconds } from "./wire.js";

/** A point of the plane: x and y. */
export type Point = readonly [x: number, y: number];

/** Where a handle holds the rest mesh: exactly one of these. */
export type Anchor =
  | { vertex: number }
  | { triangle: number; barycentric: readonly [number, number, number] }
  | { position: Point };

/** A place of the mesh that the client moves. */
export type Handle = Anchor & {
  /** Unique in the set, 1 to 128 characters of A-Z a-z 0-9 . _ -. */
  id: string;
  /** Of the squared miss against the energy, 1e-6 to 1e12. Default 1e6. */
  weight?: number;
  /** Meet the target exactly. */
  hard?: boolean;
  /** Also hold the orientation and scale of the target. */
  oriented?: boolean;
  /** Hold every vertex within this rest distance rigidly. */
  areaRadius?: number;
  /** What to do with a position outside of the mesh. Default "error". */
  outside?: Names<OutsidePolicyAnswer, "OUTSIDE_POLICY_">;
  /** For the drawing order: higher is nearer. Default 0. */
  depth?: number;
  /** Rest distance over which the depth fades to 0; 0: it holds everywhere. */
  depthFalloff?: number;
};

/** Where a handle should go. */
export interface HandleTarget {
  id: string;
  x: number;
  y: number;
  /** Against the rest pose, in radians, for oriented handles. Default 0. */
  angle?: number;
  /** Against the rest pose, for oriented handles. Default 1. */
  scale?: number;
}

/** A handle as the server has placed it. */
export interface PlacedHandle {
  id: string;
  rest: Point;
  /** How far it was snapped, in units of the mesh. */
  snappedDistance: number;
  /** Its connected component. */
  component: number;
}

/** A handle set as a session holds it. */
export interface HandleSetInfo {
  id: string;
  meshId: string;
  /** In the order of `positions` of an update. */
  handles: PlacedHandle[];
  /** Constraint rows: the size of the dense system. */
  rowCount: number;
  /** Held beside the mesh. */
  bytes: number;
  warnings: Warning[];
  /** Per vertex, length 0 or #V. */
  depth: Float32Array;
  /** Triangles back to front, length 0 or #F. */
  drawOrder: Uint32Array;
  /** Grows by one with every edit. */
  revision: number;
  /** Components without a handle, which stay at rest. */
  restingComponents: number;
  /** Components with one distinct handle, which only translate. */
  translatingComponents: number;
}

/** The answer to compileHandles and editHandles. Times in microseconds. */
export interface Compilation {
  handleSet: HandleSetInfo;
  queueMicros: number;
  solveMicros: number;
}

function anchorToWire(handle: Handle, path: string): Partial<WireHandle> {
  if ("vertex" in handle) return { vertex: index(handle.vertex, `${path}.vertex`) };
  if ("triangle" in handle) {
    const triangle = index(handle.triangle, `${path}.triangle_point.triangle`);
    const barycentric = numberRun(handle.barycentric, `${path}.triangle_point.barycentric`);
    return { trianglePoint: { triangle, barycentric } };
  }
  if ("position" in handle) return { position: { x: handle.position[0], y: handle.position[1] } };
  throw badOption(
    path,
    `${path} has no anchor: give vertex, triangle and barycentric, or position.`,
  );
}

export const handlesToWire = (handles: readonly Handle[], field = "handles"): WireHandle[] =>
  handles.map((handle, i) => ({
    handleId: handle.id,
    ...anchorToWire(handle, `${field}[${i}]`),
    ...(handle.weight !== undefined && { weight: handle.weight }),
    hard: handle.hard ?? false,
    oriented: handle.oriented ?? false,
    areaRadius: handle.areaRadius ?? 0,
    ...(handle.outside && {
      outside: toEnum(OutsidePolicy, "OUTSIDE_POLICY_", handle.outside, `${field}[${i}].outside`),
    }),
    depth: handle.depth ?? 0,
    depthFalloff: handle.depthFalloff ?? 0,
  }));

export const targetsToWire = (targets: readonly HandleTarget[]): WireTarget[] =>
  targets.map(({ id, x, y, angle, scale }) => ({
    handleId: id,
    x,
    y,
    angleRadians: angle ?? 0,
    ...(scale !== undefined && { scale }),
  }));

/**
 * The set of this id; `meshId` unless that is empty; and behind other handles those of `last`, or
 * just those.
 */
export interface SetQuestion {
  id: string;
  meshId?: string;
  last?: readonly Handle[];
  all?: boolean;
}

function placedOf(set: HandleSetInfoAnswer, asked: SetQuestion): PlacedHandle[] {
  const seen = new Set<string>();
  const handles = set.handles.map((handle): PlacedHandle => {
    checkId(handle.handleId, "", "handle");
    if (seen.has(handle.handleId))
      throw badAnswer(`The server answered the handle "${handle.handleId}" twice.`);
    seen.add(handle.handleId);
    const rest = present(handle.rest, "the place of a handle");
    checkNumbers([rest.x, rest.y, handle.snappedDistance], "a handle");
    const { handleId: id, snappedDistance, component } = handle;
    return { id, rest: [rest.x, rest.y], snappedDistance, component };
  });
  const last = asked.last ?? [];
  if (handles.length < last.length || (asked.all && handles.length !== last.length)) {
    throw badAnswer(
      `The server answered a set of ${handles.length} handles; ${last.length} were sent.`,
    );
  }
  const first = handles.length - last.length;
  last.forEach((handle, i) => checkId(handles[first + i]!.id, handle.id, "handle"));
  return handles;
}

export function handleSetOf(
  answer: HandleSetInfoAnswer | null,
  asked: SetQuestion,
  sizeOf: (meshId: string) => MeshSize | undefined,
): HandleSetInfo {
  const set = present(answer, "the handle set");
  checkId(set.handleSetId, asked.id, "handle set");
  checkId(set.meshId, asked.meshId ?? "", "mesh");
  const handles = placedOf(set, asked);
  const depth = runOf(set.depth, float32Run, "depths");
  checkNumbers(Array.from(depth), "the depths");
  const drawOrder = runOf(set.drawOrder, uint32Run, "a drawing order");
  checkIndices(drawOrder, drawOrder.length, "triangle");
  if (new Set(drawOrder).size !== drawOrder.length) {
    throw badAnswer("The server answered a drawing order that does not have every triangle once.");
  }
  const mesh = sizeOf(set.meshId);
  if (mesh && depth.length > 0) checkCount(depth.length, mesh.vertices, "depths");
  if (mesh && drawOrder.length > 0)
    checkCount(drawOrder.length, mesh.triangles, "triangles in drawing order");
  return {
    id: set.handleSetId,
    meshId: set.meshId,
    handles,
    rowCount: set.rowCount,
    bytes: set.bytes,
    warnings: warningsOf(set.warnings),
    depth,
    drawOrder,
    revision: set.revision,
    restingComponents: set.restingComponents,
    translatingComponents: set.translatingComponents,
  };
}

/** Compiling and editing answer alike. */
export interface CompilationAnswer {
  handleSet: HandleSetInfoAnswer | null;
  queueTime: DurationAnswer | null;
  solveTime: DurationAnswer | null;
}

export const compilationOf = (
  answer: CompilationAnswer,
  asked: SetQuestion,
  sizeOf: (meshId: string) => MeshSize | undefined,
): Compilation => ({
  handleSet: handleSetOf(answer.handleSet, asked, sizeOf),
  queueMicros: microseconds(answer.queueTime),
  solveMicros: microseconds(answer.solveTime),
});
