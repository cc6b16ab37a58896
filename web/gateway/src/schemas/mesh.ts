// Meshes of the plane and in space, and how they are registered.
import { Type } from "@sinclair/typebox";

import { Warning, closed, flag, indices, name, numbers, oneOf, optional } from "./base.js";

export const PlanarMesh = closed({
  vertices: numbers("x y x y…, length 2·#V, in any unit."),
  triangles: indices("i j k i j k…, length 3·#F, each below #V."),
});
export const SurfaceMesh = closed({
  vertices: numbers("x y z x y z…, length 3·#V, in any unit."),
  triangles: indices("i j k i j k…, length 3·#F, each below #V."),
});

export const Energy = closed({
  basis: optional(oneOf(["edge", "edge_as_published", "face", "vertex"])),
  weights: optional(oneOf(["uniform", "cotangent"])),
  rigidity: optional(numbers("How stiff every triangle is, length #F, above 0.")),
});

export const Repair = closed({
  weld: flag("Vertices within the tolerance of one another become one."),
  dropDuplicates: flag("Of triangles with the same corners one is kept."),
  stitch: flag("Border edges are split at border vertices that lie on them."),
  tolerance: optional(Type.Number({ description: "0 to 0.01 of the diagonal." })),
});

export const MeshBody = closed({
  id: optional(name("Default: one made of the content.")),
  mesh: PlanarMesh,
  energy: optional(Energy),
  repair: optional(Repair),
});

export const MeshInfo = Type.Object({
  id: Type.String(),
  contentHash: Type.String({ description: "SHA-256 of the mesh and its options." }),
  vertexCount: Type.Integer(),
  triangleCount: Type.Integer(),
  edgeCount: Type.Integer(),
  componentCount: Type.Integer(),
  boundaryLoopCount: Type.Integer(),
  area: Type.Number(),
  diagonal: Type.Number(),
  warnings: Type.Array(Warning),
  bytes: Type.Integer(),
});

export const OutlineBody = closed({
  outlines: Type.Array(numbers("x y x y…, at least three points, without repeating the first."), {
    description: "Holes are outlines inside others.",
  }),
  vertices: optional(
    Type.Integer({ minimum: 0, maximum: 4294967295, description: "About so many. Default 1000." }),
  ),
  tolerance: optional(
    Type.Number({ description: "By how much outlines may be simplified. Default 0: not at all." }),
  ),
  expansion: optional(Type.Number({ description: "By how much they grow outwards. Default 0." })),
});

export const OutlineAnswer = Type.Object({
  mesh: PlanarMesh,
  pieceCount: Type.Integer(),
  holeCount: Type.Integer(),
  smallestAngleDegrees: Type.Number(),
  outlineError: Type.Number({
    description: "How far the border is at most from that of what was asked for.",
  }),
});

export const SurfaceAnswer = Type.Object({
  format: oneOf(["obj", "ply", "stl", "glb"]),
  mesh: SurfaceMesh,
  parts: Type.Array(Type.Object({ firstTriangle: Type.Integer(), name: Type.String() }), {
    description: "Objects and groups, each from its first triangle to the next part.",
  }),
  warnings: Type.Array(Warning),
});
