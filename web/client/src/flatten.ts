// Flattening of surfaces: what to ask for, what comes back, and jobs of it that go on by
// themselves.
import {
  checkCount,
  checkFinite,
  checkIndices,
  checkNumbers,
  index,
  indexRun,
  present,
  runOf,
  toEnum,
} from "./checks.js";
import type { Names } from "./checks.js";
import { drawingsOf, drawingsToWire, partsToWire } from "./drawing.js";
import type { Drawing, DrawingOptions, NamedPart } from "./drawing.js";
import { badAnswer } from "./errors.js";
import type { DistortionAnswer } from "./gen/arap/v1/Distortion.js";
import type { FlatChartAnswer } from "./gen/arap/v1/FlatChart.js";
import { FlattenAnchors } from "./gen/arap/v1/FlattenAnchors.js";
import type { FlattenAnchorsAnswer } from "./gen/arap/v1/FlattenAnchors.js";
import { FlattenMethod } from "./gen/arap/v1/FlattenMethod.js";
import type { FlattenMethodAnswer } from "./gen/arap/v1/FlattenMethod.js";
import type { FlattenRequest } from "./gen/arap/v1/FlattenRequest.js";
import type { FlattenResponseAnswer } from "./gen/arap/v1/FlattenResponse.js";
import type { RefineEndAnswer } from "./gen/arap/v1/RefineEnd.js";
import { energyToWire, meshToWire, repairToWire, warningsOf } from "./mesh.js";
import type { EnergyOptions, RepairOptions, SurfaceMesh, Warning } from "./mesh.js";
import { float32Run, float64Run, uint32Run } from "./runs.js";
import type { Indices } from "./runs.js";
import { microseconds } from "./wire.js";

/** A vertex held at a place of the plane. */
export interface UvPin {
  vertex: number;
  u: number;
  v: number;
  /** 0, the default: exactly; else 1e-9 to 1e9, on the squared distance. */
  weight?: number;
}

/** A direction that an edge keeps. At most one per chart. */
export interface GrainLine {
  fromVertex: number;
  toVertex: number;
  /** Counter-clockwise from the u axis. */
  angleDegrees?: number;
}

/** How to flatten, and how to answer. */
export interface FlattenOptions {
  /** Default: both steps with FACE cells, or with the basis of `energy`. */
  method?: Names<FlattenMethodAnswer, "FLATTEN_METHOD_">;
  energy?: EnergyOptions;
  anchors?: Names<FlattenAnchorsAnswer, "FLATTEN_ANCHORS_">;
  /** Local/global iterations at most. Default for the ARAP methods: until converged, else 0. */
  refine?: number;
  /** Converged: two iterations in a row lower the energy by less than this part. Default 3e-5. */
  refineStop?: number;
  /** No flipped triangle, or NOT_INJECTIVE. */
  injective?: boolean;
  /** Edges to cut, vertex pairs a b a b…. */
  seamEdges?: Indices;
  /** Cut whatever is then no disk. */
  autoCut?: boolean;
  splitNonManifold?: boolean;
  tolerateDegenerate?: boolean;
  repair?: RepairOptions;
  pins?: readonly UvPin[];
  grainLines?: readonly GrainLine[];
  /** The server keeps the prepared surface under this name for a while. */
  surfaceKey?: string;
  /** Also answer the layout as files at true size, at most 16. */
  drawings?: readonly DrawingOptions[];
  /** What the pieces of drawings are called: as the part that most of their triangles are of. */
  parts?: readonly NamedPart[];
  /** Also answer the result of the first step. */
  firstStep?: boolean;
  /** Also answer s1 and s2 of every triangle. */
  singularValues?: boolean;
  /** Positions in double precision on the wire: a Float64Array. */
  float64?: boolean;
}

/** How far a mapping is from an isometry. */
export interface Distortion {
  /** 0 for an isometry. */
  arapEnergy: number;
  /** 4 for an isometry. */
  symmetricDirichlet: number;
  areaRatio: number;
  meanStretchPercent: number;
  maxStretchPercent: number;
  meanCompressionPercent: number;
  maxCompressionPercent: number;
  meanAngleDegrees: number;
  maxAngleDegrees: number;
  flipped: number;
  worstTriangle: number;
}

/** "converged": another iteration would bring less than refineStop; "limit": of `refine`. */
export type RefineEnd = Names<RefineEndAnswer, "REFINE_END_">;

/** A connected piece of the layout. Indices are flat positions. */
export interface FlatChart {
  /** Boundaries in order, the longest first. */
  loops: Uint32Array[];
  anchors: Uint32Array;
  triangleCount: number;
  distortion: Distortion;
  boundaryCrossings: number;
  /** Local/global iterations that were taken. */
  refinements: number;
  /** How they ended; null where none were asked for, and from servers that do not say. */
  refineEnd: RefineEnd | null;
}

/**
 * A flat surface, true to size. #U ≥ #V flat positions: vertices have copies along cuts. Times in
 * microseconds.
 */
export interface FlatSurface {
  /** u v u v…, length 2·#U, in the units of the input. A Float64Array where float64 was asked. */
  uv: Float32Array | Float64Array;
  /**
   * For each flat position the input vertex that it came from, length #U; the first #V are the
   * vertices in order.
   */
  uvVertex: Uint32Array;
  /** For each triangle corner its flat position, length 3·#F. */
  cornerUv: Uint32Array;
  /** For each vertex the one that stands for it, length #V; empty where nothing was welded. */
  weldedVertex: Uint32Array;
  /** u v u v… after the first step, when asked. */
  firstStepUv: Float64Array;
  /** s1 s2 s1 s2… per triangle, when asked. */
  singularValues: Float32Array;
  distortion: Distortion;
  warnings: Warning[];
  anchorVertices: Uint32Array;
  /** By their lowest triangle. */
  charts: FlatChart[];
  /** Length #F. */
  triangleChart: Uint32Array;
  /** Vertex pairs a b a b…: seams, then automatic cuts. */
  cutEdges: Uint32Array;
  /** How many of the cut edges, at the end, were chosen by autoCut. */
  autoCutCount: number;
  leftOutTriangles: Uint32Array;
  boundaryOverlaps: boolean;
  /** One for each that was asked for, in their order. */
  drawings: Drawing[];
  surfaceCached: boolean;
  queueMicros: number;
  solveMicros: number;
}

export function flattenToWire(mesh: SurfaceMesh, options: FlattenOptions): FlattenRequest {
  const { method, anchors } = options;
  return {
    mesh: meshToWire(mesh),
    ...(options.energy && { energy: energyToWire(options.energy) }),
    ...(options.refine !== undefined && { refine: index(options.refine, "refine") }),
    includeFirstStep: options.firstStep ?? false,
    includeSingularValues: options.singularValues ?? false,
    float64: options.float64 ?? false,
    seamEdges: indexRun(options.seamEdges ?? [], "seam_edges"),
    ...(method && { method: toEnum(FlattenMethod, "FLATTEN_METHOD_", method, "method") }),
    ...(anchors && { anchors: toEnum(FlattenAnchors, "FLATTEN_ANCHORS_", anchors, "anchors") }),
    ...(options.refineStop !== undefined && { refineStop: options.refineStop }),
    injective: options.injective ?? false,
    autoCut: options.autoCut ?? false,
    splitNonManifold: options.splitNonManifold ?? false,
    tolerateDegenerate: options.tolerateDegenerate ?? false,
    pins: (options.pins ?? []).map((pin, i) => ({
      ...pin,
      vertex: index(pin.vertex, `pins[${i}].vertex`),
    })),
    grainLines: (options.grainLines ?? []).map((line, i) => ({
      fromVertex: index(line.fromVertex, `grain_lines[${i}].from_vertex`),
      toVertex: index(line.toVertex, `grain_lines[${i}].to_vertex`),
      angleDegrees: line.angleDegrees ?? 0,
    })),
    surfaceKey: options.surfaceKey ?? "",
    drawings: drawingsToWire(options.drawings ?? []),
    parts: partsToWire(options.parts ?? []),
    ...(options.repair && { repair: repairToWire(options.repair) }),
  };
}

function distortionOf(answer: DistortionAnswer | null, triangles: number): Distortion {
  const { scale: _, ...distortion } = present(answer, "the distortion");
  checkNumbers(Object.values(distortion), "a distortion");
  checkIndices([distortion.worstTriangle], Math.max(triangles, 1), "triangle");
  return distortion;
}

// What a newer server may say is as if it said nothing.
const refineEnds: Readonly<Record<string, RefineEnd>> = {
  REFINE_END_CONVERGED: "converged",
  REFINE_END_LIMIT: "limit",
};

function chartOf(chart: FlatChartAnswer, positions: number, triangles: number): FlatChart {
  const loops = chart.loops.map((loop) => runOf(loop.uvIndices, uint32Run, "a boundary"));
  const anchors = runOf(chart.anchors, uint32Run, "anchors");
  for (const indices of [...loops, anchors]) checkIndices(indices, positions, "the flat position");
  if (chart.triangleCount > triangles) {
    throw badAnswer(
      `The server answered a chart of ${chart.triangleCount} triangles; the mesh has ${triangles}.`,
    );
  }
  const { triangleCount, boundaryCrossings, refinements } = chart;
  const distortion = distortionOf(chart.distortion, triangles);
  const refineEnd = refineEnds[chart.refineEnd] ?? null;
  return { loops, anchors, triangleCount, distortion, boundaryCrossings, refinements, refineEnd };
}

// Each corner of the layout is a copy of the vertex that it has in the mesh, or of the one that
// stands for it.
function checkCorners(flat: FlatSurface, mesh: SurfaceMesh): void {
  for (let corner = 0; corner < flat.cornerUv.length; corner++) {
    const vertex = mesh.triangles[corner]!;
    const wanted = flat.weldedVertex[vertex] ?? vertex;
    if (flat.uvVertex[flat.cornerUv[corner]!] === wanted) continue;
    const where = `corner ${corner % 3} of triangle ${Math.floor(corner / 3)}`;
    throw badAnswer(`The server answered a layout in which ${where} is not its vertex.`);
  }
}

function checkLayout(flat: FlatSurface, mesh: SurfaceMesh, options: FlattenOptions): void {
  const vertices = mesh.vertices.length / 3;
  const triangles = mesh.triangles.length / 3;
  const positions = flat.uv.length / 2;
  if (positions < vertices || positions % 1 !== 0) {
    throw badAnswer(`The server answered ${positions} flat positions for ${vertices} vertices.`);
  }
  checkCount(flat.uvVertex.length, positions, "vertices of flat positions");
  checkIndices(flat.uvVertex, vertices, "vertex");
  for (let vertex = 0; vertex < vertices; vertex++) {
    if (flat.uvVertex[vertex] !== vertex) {
      throw badAnswer(`The server answered flat position ${vertex} out of its place.`);
    }
  }
  const welded = options.repair?.weld === true && flat.weldedVertex.length > 0;
  checkCount(flat.weldedVertex.length, welded ? vertices : 0, "welded vertices");
  checkIndices(flat.weldedVertex, vertices, "vertex");
  checkCount(flat.cornerUv.length, 3 * triangles, "corners of flat triangles");
  checkCorners(flat, mesh);
  checkFinite(flat.uv, 2, "the flat position");
  checkCount(
    flat.firstStepUv.length,
    options.firstStep ? 2 * positions : 0,
    "numbers after the first step",
  );
  checkFinite(flat.firstStepUv, 2, "the first step's position");
  checkCount(
    flat.singularValues.length,
    options.singularValues ? 2 * triangles : 0,
    "singular values",
  );
  checkFinite(flat.singularValues, 2, "the singular values of triangle");
  checkCount(flat.triangleChart.length, triangles, "triangles with a chart");
  checkIndices(flat.triangleChart, flat.charts.length, "chart");
  checkIndices(flat.cutEdges, vertices, "vertex");
  if (flat.cutEdges.length % 2 !== 0 || flat.autoCutCount > flat.cutEdges.length / 2) {
    throw badAnswer(
      `The server answered ${flat.autoCutCount} automatic cuts of ${flat.cutEdges.length / 2}.`,
    );
  }
  checkIndices(flat.leftOutTriangles, triangles, "triangle");
  checkIndices(flat.anchorVertices, vertices, "vertex");
}

/** A layout of that mesh with all that was asked for. */
export function flatSurfaceOf(
  answer: FlattenResponseAnswer,
  mesh: SurfaceMesh,
  options: FlattenOptions,
): FlatSurface {
  const other = options.float64 ? answer.uv : answer.uv64;
  if (other.length > 0)
    throw badAnswer("The server answered a layout in another precision than was asked.");
  const indices = (bytes: Uint8Array): Uint32Array => runOf(bytes, uint32Run, "indices");
  const uv = options.float64
    ? runOf(answer.uv64, float64Run, "positions")
    : runOf(answer.uv, float32Run, "positions");
  const triangles = mesh.triangles.length / 3;
  const flat: FlatSurface = {
    uv,
    uvVertex: indices(answer.uvVertex),
    cornerUv: indices(answer.cornerUv),
    weldedVertex: indices(answer.weldedVertex),
    firstStepUv: runOf(answer.firstStepUv, float64Run, "positions"),
    singularValues: runOf(answer.singularValues, float32Run, "singular values"),
    distortion: distortionOf(answer.distortion, triangles),
    warnings: warningsOf(answer.warnings),
    anchorVertices: indices(answer.anchorVertices),
    charts: answer.charts.map((chart) => chartOf(chart, uv.length / 2, triangles)),
    triangleChart: indices(answer.triangleChart),
    cutEdges: indices(answer.cutEdges),
    autoCutCount: answer.autoCutCount,
    leftOutTriangles: indices(answer.leftOutTriangles),
    boundaryOverlaps: answer.boundaryOverlaps,
    drawings: drawingsOf(answer.drawings, options.drawings ?? []),
    surfaceCached: answer.surfaceCached,
    queueMicros: microseconds(answer.queueTime),
    solveMicros: microseconds(answer.solveTime),
  };
  checkLayout(flat, mesh, options);
  return flat;
}
