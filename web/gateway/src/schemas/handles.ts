// Handles, shapes, and what is said on a stream.
import { Type } from "@sinclair/typebox";
import type { Static, TSchema } from "@sinclair/typebox";

import { Warning, closed, flag, index, indices, name, numbers, oneOf, optional } from "./base.js";

// Of so many numbers; what a draft of JSON Schema calls a tuple is not what the next one calls it.
const some = <T extends readonly number[]>(count: number) =>
  Type.Unsafe<T>({ type: "array", items: { type: "number" }, minItems: count, maxItems: count });
const Point = some<[number, number]>(2);
const Barycentric = some<[number, number, number]>(3);

export const Handle = closed(
  {
    id: name(),
    vertex: optional(index()),
    triangle: optional(index()),
    barycentric: optional(Barycentric),
    position: optional(Point),
    weight: optional(Type.Number()),
    hard: flag("Meet the target exactly."),
    oriented: flag("Also hold the orientation and scale of the target."),
    areaRadius: optional(
      Type.Number({ description: "Hold what is within this rest distance rigidly." }),
    ),
    outside: optional(oneOf(["error", "snap"])),
    depth: optional(Type.Number()),
    depthFalloff: optional(Type.Number()),
  },
  {
    oneOf: [
      { required: ["vertex"] },
      { required: ["triangle", "barycentric"] },
      { required: ["position"] },
    ],
  },
);
const Handles = Type.Array(Handle, { maxItems: 100_000 });

export const Target = closed({
  id: name(),
  x: Type.Number(),
  y: Type.Number(),
  angle: optional(Type.Number({ description: "In radians, for oriented handles." })),
  scale: optional(Type.Number({ description: "For oriented handles." })),
});

export const HandleSetBody = closed({ id: name(), meshId: name(), handles: Handles });
export const EditBody = closed({
  remove: optional(Type.Array(name(), { maxItems: 100_000 })),
  add: optional(Handles),
});

export const HandleSetInfo = Type.Object({
  id: Type.String(),
  meshId: Type.String(),
  handles: Type.Array(
    Type.Object({
      id: Type.String(),
      rest: Point,
      snappedDistance: Type.Number(),
      component: Type.Integer(),
    }),
    { description: "In the order of `positions` of an update." },
  ),
  rowCount: Type.Integer(),
  bytes: Type.Number(),
  warnings: Type.Array(Warning),
  depth: numbers("Per vertex, or empty."),
  drawOrder: indices("Triangles back to front, or empty."),
  revision: Type.Integer(),
  restingComponents: Type.Integer(),
  translatingComponents: Type.Integer(),
});

const mode = optional(oneOf(["rigid", "similarity", "baseline"]));
const shapeOptions = {
  mode,
  refine: optional(index("Iterations of the second step.")),
  flippedIds: flag("Also answer which triangles are flipped, of shapes that are measured."),
  measureEvery: optional(
    index("Which shapes are measured: the first, and every n-th after one that was; 0: none."),
  ),
  boundaryOnly: flag("Positions of the vertices on the boundary alone."),
  vertexSubset: optional(indices("Positions of these vertices alone, in this order.")),
};

export const DeformBody = closed({
  targets: Type.Array(Target, { description: "One for every handle, in any order." }),
  pickPoints: optional(numbers("Deformed points x y x y… to map back to rest.")),
  ...shapeOptions,
  float64: flag("Positions in double precision."),
});

const Pick = Type.Union([
  Type.Object({
    triangle: Type.Integer(),
    rest: Point,
    barycentric: Barycentric,
  }),
  Type.Null(),
]);
export const ShapeAnswer = Type.Object({
  positions: numbers("x y x y…, in units of the mesh."),
  vertices: Type.Union([indices("Which ones the positions are of."), Type.Null()]),
  measured: Type.Boolean({
    description: "Else flippedCount, flippedIds, energy, meanStretch and maxStretch are left out.",
  }),
  flippedCount: optional(Type.Integer()),
  flippedIds: optional(indices("When asked.")),
  worstHandleError: Type.Number(),
  worstHandleId: Type.String(),
  energy: optional(Type.Number()),
  meanStretch: optional(Type.Number()),
  maxStretch: optional(Type.Number()),
  picks: Type.Array(Pick),
  handleSetRevision: Type.Integer(),
});

const trackOptions = {
  ...shapeOptions,
  encoding: optional(oneOf(["float32", "int16"], "Of binary answers. Default float32.")),
  float64: flag("Positions in double precision, of answers in NDJSON."),
};

export const TrackBody = closed({
  handles: Type.Array(name(), {
    maxItems: 100_000,
    description: "Every handle of the set once: the columns of the frames.",
  }),
  frames: Type.Array(
    closed({
      positions: numbers("x y x y…, a target for each of the handles."),
      angles: optional(numbers("In radians, one for each or none.")),
      scales: optional(numbers("One for each or none.")),
    }),
    { minItems: 1, maxItems: 1_000_000 },
  ),
  ...trackOptions,
});

const orNull = <T>(schema: TSchema) => Type.Unsafe<T | null>({ anyOf: [schema, { type: "null" }] });

/** TRACK.json of arapctl, which may have more than is used here. */
export const TrackFile = Type.Object(
  {
    handles: Type.Array(Type.Object({ name: optional(name()), rest: Point }), {
      maxItems: 100_000,
      description: "Those of the handle set: the columns of the frames.",
    }),
    frames: Type.Array(
      Type.Object({
        targets: Type.Array(orNull<[number, number]>(Point), {
          description: "One for each of the handles; null: it keeps its last one.",
        }),
        angles: optional(Type.Array(orNull<number>(Type.Number()))),
        scales: optional(Type.Array(orNull<number>(Type.Number()))),
      }),
      { minItems: 1, maxItems: 1_000_000 },
    ),
    edits: optional(Type.Array(Type.Unknown(), { description: "None." })),
    ...trackOptions,
  },
  { description: "A TRACK.json of arapctl as it is. The handles are those of the set already." },
);

const sequence = optional(Type.Integer({ minimum: 1, maximum: 4294967295 }));
const type = <const T extends string>(value: T) => Type.Literal(value);

/** What a page says on a socket, by its type. */
export const messages = {
  open: closed({
    type: type("open"),
    handleSet: name(),
    encoding: optional(oneOf(["float32", "int16"])),
    delivery: optional(oneOf(["latest", "every"])),
    window: optional(Type.Integer({ minimum: 0, maximum: 64 })),
    ...shapeOptions,
  }),
  update: closed({
    type: type("update"),
    sequence,
    targets: optional(Type.Array(Target)),
    positions: optional(numbers("All handles in the order of the set.")),
    pickPoints: optional(numbers("Deformed points x y x y….")),
    measure: flag("Measure the shape whatever measureEvery says, or a newer one in its place."),
  }),
  edit: closed({ type: type("edit"), sequence, ...EditBody.properties }),
  ping: closed({
    type: type("ping"),
    nonce: optional(Type.Integer({ minimum: 0, maximum: 2 ** 53 - 1 })),
  }),
  seen: closed({ type: type("seen"), sequence: Type.Integer({ minimum: 0, maximum: 4294967295 }) }),
  close: closed({ type: type("close") }),
};
export type Open = Static<(typeof messages)["open"]>;
export type Said = {
  [Name in keyof typeof messages]: Static<(typeof messages)[Name]>;
}[keyof typeof messages];
