// Meshes and their registration. Nothing but lengths is checked on this side: the server checks,
// and names what is wrong.
import {
  checkCount,
  checkFinite,
  checkId,
  checkIndices,
  checkNumbers,
  indexRun,
  numberRun,
  present,
  runOf,
  toEnum,
} from "./checks.js";
import type { Names } from "./checks.js";
import { badAnswer } from "./errors.js";
import { Basis as WireBasis } from "./gen/arap/v1/Basis.js";
import { EdgeWeights as WireWeights } from "./gen/arap/v1/EdgeWeights.js";
import type { BasisAnswer } from "./gen/arap/v1/Basis.js";
import type { EdgeWeightsAnswer } from "./gen/arap/v1/EdgeWeights.js";
import type { EnergyOptions as WireEnergy } from "./gen/arap/v1/EnergyOptions.js";
import type { MeshInfoAnswer } from "./gen/arap/v1/MeshInfo.js";
import type { MeshOutlineResponseAnswer } from "./gen/arap/v1/MeshOutlineResponse.js";
import type { RepairOptions as WireRepair } from "./gen/arap/v1/RepairOptions.js";
import type { WarningAnswer } from "./gen/arap/v1/Warning.js";
import { float64Run, uint32Run } from "./runs.js";
import type { Indices, Numbers } from "./runs.js";
import { microseconds } from "./wire.js";

/** Triangles in the plane. */
export interface PlanarMesh {
  /** x y x y…, length 2·#V, in any unit. */
  vertices: Numbers;
  /** i j k i j k…, length 3·#F, each below #V. Clockwise ones are turned round, with a warning. */
  triangles: Indices;
}

/** Triangles in space. */
export interface SurfaceMesh {
  /** x y z x y z…, length 3·#V, in any unit. */
  vertices: Numbers;
  /** i j k i j k…, length 3·#F, each below #V. */
  triangles: Indices;
}

/** What a cell of the energy is: the piece of the mesh that has one rotation. */
export type Basis = Names<BasisAnswer, "BASIS_">;
/** How much an edge counts. */
export type EdgeWeights = Names<EdgeWeightsAnswer, "EDGE_WEIGHTS_">;

export interface EnergyOptions {
  /** Default "edge"; for flattening that of the method. */
  basis?: Basis;
  /** Default "uniform"; for flattening "cotangent". */
  weights?: EdgeWeights;
  /** How stiff every triangle is, length #F, above 0 and at most 1e6. Default 1 everywhere. */
  rigidity?: Numbers;
}

/**
 * What is mended of a mesh first; every answer speaks of the vertices and triangles that were sent.
 */
export interface RepairOptions {
  /** Vertices within the tolerance of one another become one. */
  weld?: boolean;
  /** Of triangles with the same corners the lowest is kept. */
  dropDuplicates?: boolean;
  /** Border edges are split at border vertices within the tolerance. */
  stitch?: boolean;
  /** In units of the mesh, 0 to 0.01 of its diagonal. Default 1e-6 of the diagonal. */
  tolerance?: number;
}

/** Something that was repaired or ignored; never an error. */
export interface Warning {
  /** What it is, for example "unreferenced_vertices". */
  kind: string;
  count: number;
  /** The first few ids, at most 16. */
  elements: Uint32Array;
  message: string;
}

/** A mesh as a session holds it. */
export interface MeshInfo {
  id: string;
  /** SHA-256 of the mesh and its options, in hexadecimal; equal meshes share their factors. */
  contentHash: string;
  vertexCount: number;
  triangleCount: number;
  edgeCount: number;
  componentCount: number;
  boundaryLoopCount: number;
  /** Squared units of the mesh. */
  area: number;
  /** Of the bounding box, units of the mesh. */
  diagonal: number;
  warnings: Warning[];
  /** Held by the factors and tables. */
  bytes: number;
}

/** The answer to registerMesh. Times in microseconds. */
export interface Registration {
  mesh: MeshInfo;
  /** Whether the factors were there already. */
  shared: boolean;
  queueMicros: number;
  solveMicros: number;
}

/** What becomes of outlines before they are filled. Lengths are in the unit of the outlines. */
export interface OutlineOptions {
  /** About so many. Default 1000. */
  vertices?: number;
  /** By how much they may be simplified. Default 0: every point is kept. */
  tolerance?: number;
  /** By how much they grow outwards. Default 0. */
  expansion?: number;
}

/** The answer to meshOutline: a mesh to register. Times in microseconds. */
export interface OutlineMesh {
  mesh: { vertices: Float64Array; triangles: Uint32Array };
  pieceCount: number;
  holeCount: number;
  smallestAngleDegrees: number;
  /** How far its border is at most from that of what was asked for. */
  outlineError: number;
  queueMicros: number;
  solveMicros: number;
}

export const meshToWire = (
  mesh: PlanarMesh | SurfaceMesh,
): { vertices: Uint8Array; triangles: Uint8Array } => ({
  vertices: numberRun(mesh.vertices, "mesh.vertices"),
  triangles: indexRun(mesh.triangles, "mesh.triangles"),
});

export function energyToWire(energy: EnergyOptions): WireEnergy {
  return {
    ...(energy.basis && { basis: toEnum(WireBasis, "BASIS_", energy.basis, "energy.basis") }),
    ...(energy.weights && {
      weights: toEnum(WireWeights, "EDGE_WEIGHTS_", energy.weights, "energy.weights"),
    }),
    ...(energy.rigidity && { rigidity: numberRun(energy.rigidity, "energy.rigidity") }),
  };
}

export const repairToWire = (repair: RepairOptions): WireRepair => ({
  weld: repair.weld ?? false,
  dropDuplicates: repair.dropDuplicates ?? false,
  stitch: repair.stitch ?? false,
  ...(repair.tolerance !== undefined && { tolerance: repair.tolerance }),
});

export const warningsOf = (warnings: readonly WarningAnswer[]): Warning[] =>
  warnings.map(({ kind, count, elements, message }) => ({
    kind,
    count,
    message,
    elements: runOf(elements, uint32Run, "the elements of a warning"),
  }));

/**
 * The mesh of that id (any when it is empty); with as many vertices and triangles as were sent, if
 * they were.
 */
export function meshInfoOf(answer: MeshInfoAnswer | null, id: string, sent?: PlanarMesh): MeshInfo {
  const mesh = present(answer, "the mesh");
  checkId(mesh.meshId, id, "mesh");
  if (sent) {
    checkCount(mesh.vertexCount, sent.vertices.length / 2, "vertices");
    checkCount(mesh.triangleCount, sent.triangles.length / 3, "triangles");
  }
  checkNumbers([mesh.area, mesh.diagonal], "a mesh");
  return {
    id: mesh.meshId,
    contentHash: mesh.contentHash,
    vertexCount: mesh.vertexCount,
    triangleCount: mesh.triangleCount,
    edgeCount: mesh.edgeCount,
    componentCount: mesh.componentCount,
    boundaryLoopCount: mesh.boundaryLoopCount,
    area: mesh.area,
    diagonal: mesh.diagonal,
    warnings: warningsOf(mesh.warnings),
    bytes: mesh.bytes,
  };
}

/** Counter-clockwise triangles of the plane. */
export function outlineMeshOf(answer: MeshOutlineResponseAnswer): OutlineMesh {
  const mesh = present(answer.mesh, "the mesh");
  const vertices = runOf(mesh.vertices, float64Run, "vertices");
  const triangles = runOf(mesh.triangles, uint32Run, "triangles");
  if (vertices.length % 2 !== 0 || triangles.length % 3 !== 0 || triangles.length === 0) {
    throw badAnswer("The server answered a mesh whose arrays break their rules.");
  }
  checkFinite(vertices, 2, "the vertex");
  checkIndices(triangles, vertices.length / 2, "vertex");
  checkNumbers([answer.smallestAngleDegrees, answer.outlineError], "a mesh");
  return {
    mesh: { vertices, triangles },
    pieceCount: answer.pieceCount,
    holeCount: answer.holeCount,
    smallestAngleDegrees: answer.smallestAngleDegrees,
    outlineError: answer.outlineError,
    queueMicros: microseconds(answer.queueTime),
    solveMicros: microseconds(answer.solveTime),
  };
}
