// The surfaces that the page brings along, made for it.
import { words } from "../words.js";
import type { Surface } from "./surface.js";

type Point = readonly [number, number, number];

// A grid of `across` × `along` cells, each of two triangles; `round` closes it across.
function grid(
  across: number,
  along: number,
  round: boolean,
  place: (s: number, t: number) => Point,
): { vertices: Float64Array; triangles: Uint32Array } {
  const width = round ? across : across + 1;
  const vertices: number[] = [];
  for (let j = 0; j <= along; ++j)
    for (let i = 0; i < width; ++i) vertices.push(...place(i / across, j / along));
  const triangles: number[] = [];
  for (let j = 0; j < along; ++j) {
    for (let i = 0; i < across; ++i) {
      const [a, b] = [j * width + i, j * width + ((i + 1) % width)];
      const [c, d] = [a + width, b + width];
      // Diagonals lean to both sides in turn, so that neither is preferred.
      if ((i + j) % 2 === 0) triangles.push(a, c, b, b, c, d);
      else triangles.push(a, c, d, a, d, b);
    }
  }
  return { vertices: Float64Array.from(vertices), triangles: Uint32Array.from(triangles) };
}

const smooth = (t: number): number => {
  const x = Math.min(1, Math.max(0, t));
  return x * x * (3 - 2 * x);
};
const mix = (a: number, b: number, t: number): number => a + (b - a) * t;

/** A sleeve for a bent arm, in millimetres: a tube from the shoulder to the wrist. */
function sleeve(): ReturnType<typeof grid> {
  return grid(40, 34, true, (s, t) => {
    const angle = 2 * Math.PI * s;
    // Above the arm it reaches higher than under it.
    const cap = 120 * (0.5 + 0.5 * Math.cos(angle)) ** 1.4 * (1 - t) ** 1.6;
    const down = 560 * t - cap;
    const radius = mix(68, 36, smooth(t * 1.05));
    const bend = Math.max(0, down - 250) / 310;
    return [
      1.12 * radius * Math.cos(angle),
      280 - down + 8 * bend * bend,
      radius * Math.sin(angle) + 58 * bend * bend,
    ];
  });
}

/** Half of the front of a fitted top, in millimetres. */
function top(): ReturnType<typeof grid> {
  return grid(28, 44, false, (s, t) => {
    const height = 560 * t;
    // From the middle of the front to the side, as lengths round the body.
    const neck = 78 * smooth((t - 0.82) / 0.18) ** 0.7;
    const waist = 1 - 0.16 * Math.exp(-(((t - 0.36) / 0.2) ** 2));
    const side = mix(232 * waist, 172, smooth((t - 0.68) / 0.2));
    const length = mix(neck, side, s);
    const angle = length / 150;
    const bust = 34 * Math.exp(-(((length - 92) / 58) ** 2) - ((height - 395) / 78) ** 2);
    const slope = 38 * s * smooth((t - 0.8) / 0.2);
    return [
      (158 + bust) * Math.sin(angle),
      height - slope - 280,
      (112 + bust) * Math.cos(angle) * (1 - 0.12 * smooth((t - 0.75) / 0.25)),
    ];
  });
}

/** A plank of a small boat between chine and sheer, in metres: it twists towards the stem. */
function plank(): ReturnType<typeof grid> {
  return grid(60, 12, false, (s, t) => {
    const stem = smooth((s - 0.45) / 0.55);
    const half = 0.62 * Math.sqrt(1 - s ** 2.6) + 0.02;
    const low: Point = [3.6 * s, 0.08 + 0.34 * stem, half * mix(0.78, 0.25, stem)];
    const high: Point = [3.6 * s + 0.35 * stem * s, 0.56 + 0.2 * s * s, half];
    const belly = 0.025 * Math.sin(Math.PI * t) * (1 - stem);
    return [
      mix(low[0], high[0], t) - 1.9,
      mix(low[1], high[1], t) - 0.4 - belly,
      mix(low[2], high[2], t) + belly,
    ];
  });
}

export interface Sample {
  name: string;
  hint: string;
  millimetresPerUnit: number;
  make: () => Surface;
}

const makers: readonly (readonly [() => ReturnType<typeof grid>, number])[] = [
  [sleeve, 1],
  [top, 1],
  [plank, 1000],
];

export const samples: readonly Sample[] = makers.map(([shape, millimetresPerUnit], i) => ({
  name: words.flat.samples[i],
  hint: words.flat.sampleHints[i],
  millimetresPerUnit,
  make: () => ({
    name: words.flat.samples[i],
    ...shape(),
    parts: [{ firstTriangle: 0, name: words.flat.samples[i] }],
    file: null,
    format: null,
    warnings: [],
  }),
}));
