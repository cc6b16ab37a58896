// The document of the page: a surface and how it is to be laid flat. It is never changed but replaced.
import type { Edges, Surface } from "./surface.js";

export type Method = "arap_face" | "arap_edge" | "lscm" | "abf" | "first_step";
export const methods: readonly Method[] = ["arap_face", "arap_edge", "lscm", "abf", "first_step"];

/** A vertex that is held at a place of the layout, in units of the surface. */
export interface UvPin {
  vertex: number;
  u: number;
  v: number;
}

/** From one vertex to another the layout keeps this direction, in degrees counter-clockwise from the right. */
export interface Grain {
  from: number;
  to: number;
  angle: number;
}

export interface Pattern {
  readonly surface: Surface | null;
  readonly millimetresPerUnit: number;
  /** Numbers of edges, sorted. */
  readonly seams: readonly number[];
  readonly autoCut: boolean;
  /** Join twins, split what has more than two sides, leave out what has no area. */
  readonly mend: boolean;
  /** No triangle may be flipped. */
  readonly injective: boolean;
  readonly pins: readonly UvPin[];
  readonly grains: readonly Grain[];
  readonly method: Method;
  /** Beside it, to compare. */
  readonly other: Method | null;
}

export const emptyPattern: Pattern = {
  surface: null,
  millimetresPerUnit: 1,
  seams: [],
  autoCut: true,
  mend: false,
  injective: false,
  pins: [],
  grains: [],
  method: "arap_face",
  other: null,
};

/** What the gateway is asked, but for the surface. */
export function requestOf(
  pattern: Pattern,
  edges: Edges,
  method: Method,
  surfaceKey: string,
): Record<string, unknown> {
  const { seams, autoCut, mend, injective, pins, grains } = pattern;
  return {
    method,
    seamEdges: seams.flatMap((edge) => [edges.named[2 * edge], edges.named[2 * edge + 1]]),
    autoCut,
    injective,
    ...(mend && {
      repair: { weld: true, stitch: true, dropDuplicates: true },
      splitNonManifold: true,
      tolerateDegenerate: true,
    }),
    pins: pins.map(({ vertex, u, v }) => ({ vertex, u, v })),
    grainLines: grains.map(({ from, to, angle }) => ({
      fromVertex: from,
      toVertex: to,
      angleDegrees: angle,
    })),
    singularValues: true,
    surfaceKey,
  };
}

/** Whether the layout of the one is that of the other. */
export const sameLayout = (a: Pattern, b: Pattern): boolean =>
  a.surface === b.surface &&
  a.seams === b.seams &&
  a.autoCut === b.autoCut &&
  a.mend === b.mend &&
  a.injective === b.injective &&
  a.pins === b.pins &&
  a.grains === b.grains &&
  a.method === b.method &&
  a.other === b.other;

/** Adds the pin, or moves the one of its vertex. */
export const withPin = (pattern: Pattern, pin: UvPin): Pattern => ({
  ...pattern,
  pins: [...pattern.pins.filter((one) => one.vertex !== pin.vertex), pin].sort(
    (a, b) => a.vertex - b.vertex,
  ),
});

export const withoutPin = (pattern: Pattern, vertex: number): Pattern => ({
  ...pattern,
  pins: pattern.pins.filter((one) => one.vertex !== vertex),
});

/** What a length in units is in millimetres is likely wrong when a piece is that small or large. */
export const isUnlikely = (millimetres: number): boolean =>
  millimetres > 0 && (millimetres < 5 || millimetres > 10_000);

/** Units that models are drawn in, with their millimetres. */
export const units: readonly (readonly [string, number])[] = [
  ["mm", 1],
  ["cm", 10],
  ["m", 1000],
  ["in", 25.4],
];
