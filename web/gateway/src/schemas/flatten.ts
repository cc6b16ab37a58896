// Flattening: what may be asked for and what comes back.
import { Type } from "@sinclair/typebox";
import type { Static } from "@sinclair/typebox";

import { Warning, closed, flag, index, indices, name, numbers, oneOf, optional } from "./base.js";
import { Energy, Repair, SurfaceMesh } from "./mesh.js";

const positive = (description: string) => optional(Type.Number({ description }));

export const DrawingOptions = closed({
  format: oneOf(["svg", "dxf", "pdf"]),
  millimetresPerUnit: positive("How many millimetres a unit of the mesh is. Default 1."),
  allowance: positive("Seam allowance in millimetres."),
  corners: optional(oneOf(["mitre", "square", "round"])),
  notches: flag("Pair the two sides of every seam."),
  sheetWidth: positive("Pack the pieces into a roll of this width, in millimetres."),
  paper: optional(
    Type.String({
      maxLength: 64,
      description: '"A4", "letter", "210x297"…: pages to print and join.',
    }),
  ),
  overlap: positive("What pages share with their neighbours, in millimetres."),
  margin: positive("What the printer does not reach, in millimetres."),
  interior: flag("Show the edges inside too."),
  plain: flag("Nothing besides the lines."),
});

const options = {
  method: optional(oneOf(["arap_edge", "arap_face", "lscm", "first_step", "abf"])),
  energy: optional(Energy),
  anchors: optional(oneOf(["center_edge", "far_boundary", "spectral"])),
  refine: optional(index("Local/global iterations at most. Default: until they converge.")),
  refineStop: optional(
    Type.Number({
      description: "Part of the energy below which two iterations in a row are the last.",
    }),
  ),
  injective: flag("No flipped triangle, or NOT_INJECTIVE."),
  seamEdges: optional(indices("Edges to cut, vertex pairs a b a b….")),
  autoCut: flag("Cut whatever is then no disk."),
  splitNonManifold: flag("Split what has more than two sides."),
  tolerateDegenerate: flag("Leave triangles without area out."),
  repair: optional(Repair),
  pins: optional(
    Type.Array(
      closed({
        vertex: index(),
        u: Type.Number(),
        v: Type.Number(),
        weight: optional(Type.Number({ description: "0: exactly." })),
      }),
    ),
  ),
  grainLines: optional(
    Type.Array(
      closed({ fromVertex: index(), toVertex: index(), angleDegrees: optional(Type.Number()) }),
    ),
  ),
  surfaceKey: optional(name("The server keeps the prepared surface under this name for a while.")),
  drawings: optional(Type.Array(DrawingOptions, { maxItems: 16 })),
  parts: optional(
    Type.Array(closed({ firstTriangle: index(), name: optional(Type.String()) }), {
      description: "What pieces are called. Default: as the file says.",
    }),
  ),
  firstStep: flag("Also answer the layout of the first step."),
  singularValues: flag("Also answer s1 and s2 of every triangle."),
  float64: flag("Positions in double precision."),
  includeMesh: flag("Also answer the mesh: of an uploaded file."),
};

/** The part `request` of a form. */
export const FlattenOptions = closed(options, { $id: "FlattenOptions" });
export type FlattenOptions = Static<typeof FlattenOptions>;
export const FlattenBody = closed({ mesh: SurfaceMesh, ...options });
export type FlattenBody = Static<typeof FlattenBody>;

const count = Type.Integer();
const measure = Type.Number();
export const Distortion = Type.Object({
  arapEnergy: measure,
  symmetricDirichlet: measure,
  areaRatio: measure,
  meanStretchPercent: measure,
  maxStretchPercent: measure,
  meanCompressionPercent: measure,
  maxCompressionPercent: measure,
  meanAngleDegrees: measure,
  maxAngleDegrees: measure,
  flipped: count,
  worstTriangle: count,
});

export const Layout = Type.Object(
  {
    uv: numbers("u v u v…, length 2·#U, in units of the surface."),
    uvVertex: indices(
      "For each flat position the vertex that it came from; the first #V are the vertices.",
    ),
    cornerUv: indices("For each triangle corner its flat position, length 3·#F."),
    weldedVertex: indices(
      "For each vertex the one that stands for it; empty where nothing was welded.",
    ),
    firstStepUv: numbers("When asked."),
    singularValues: numbers("s1 s2 per triangle, when asked."),
    distortion: Distortion,
    warnings: Type.Array(Warning),
    anchorVertices: indices("That fixed the first step."),
    charts: Type.Array(
      Type.Object({
        loops: Type.Array(indices("Flat positions along a boundary, the longest first.")),
        anchors: indices("Flat positions."),
        triangleCount: count,
        distortion: Distortion,
        boundaryCrossings: count,
        refinements: count,
        refineEnd: Type.Union([oneOf(["converged", "limit"]), Type.Null()], {
          description: "How they ended; null where none were asked for.",
        }),
      }),
    ),
    triangleChart: indices("Length #F."),
    cutEdges: indices("Vertex pairs: seams, then automatic cuts."),
    autoCutCount: count,
    leftOutTriangles: indices("Without area."),
    boundaryOverlaps: Type.Boolean(),
    drawings: Type.Array(
      Type.Object({
        format: Type.String(),
        mediaType: Type.String(),
        files: Type.Array(
          Type.Object({ page: Type.String(), data: Type.String({ description: "In base64." }) }),
        ),
        warnings: Type.Array(Warning),
      }),
    ),
    mesh: optional(SurfaceMesh),
    parts: optional(Type.Array(Type.Object({ firstTriangle: count, name: Type.String() }))),
    fileWarnings: optional(Type.Array(Warning)),
  },
  { $id: "Layout" },
);

export const Job = Type.Object({
  id: Type.String(),
  state: oneOf(["waiting", "running", "done", "failed", "cancelled"]),
  phase: Type.String({
    description: "While it runs: cutting, charts, layout, drawing or storing.",
  }),
  fraction: Type.Number({ description: "Of the work, 0 to 1." }),
  place: Type.Integer({ description: "How many jobs start before it." }),
  expectedMs: Type.Number({ description: "Until it ends." }),
  resultBytes: Type.Number(),
});
