// Values that are made up, the same ones for the same seed.
import { glb, plyBytes, stlBytes } from "./files.js";
import type { Json } from "./gateway.js";

/** Another one is ARAP_WEB_SEED. */
export const seed = Number(process.env["ARAP_WEB_SEED"] ?? 20_090_131);

/** Numbers of a sequence that the seed decides. */
export class Dice {
  #state: number;
  constructor(state: number) {
    this.#state = state >>> 0;
  }
  /** 0 to below `limit`. */
  below(limit: number): number {
    this.#state = (Math.imul(this.#state, 1_664_525) + 1_013_904_223) >>> 0;
    return Math.floor((this.#state / 2 ** 32) * limit);
  }
  of<T>(choices: readonly T[]): T {
    return choices[this.below(choices.length)]!;
  }
}

const oddNumbers = [0, -0, 1, -1, 0.5, 2 ** 31, 2 ** 32, -(2 ** 53), 1e-320, 1e300, 4294967295];
export const oddTexts = [
  "",
  "h",
  "m",
  "l",
  "none",
  "no name",
  "../..",
  "%2e%2e",
  "\u0000",
  "é".repeat(200),
  "__proto__",
  "constructor",
  "A4",
  "edge",
];

/** A value of any kind, not deep. */
export function anything(dice: Dice, depth = 0): unknown {
  switch (dice.below(depth > 2 ? 5 : 8)) {
    case 0:
      return null;
    case 1:
      return dice.below(2) === 0;
    case 2:
    case 3:
      return dice.of(oddNumbers);
    case 4:
      return dice.of(oddTexts);
    case 5:
      return Array.from({ length: dice.below(6) }, () => dice.of(oddNumbers));
    case 6:
      return Array.from({ length: dice.below(4) }, () => anything(dice, depth + 1));
    default:
      return Object.fromEntries(
        Array.from({ length: dice.below(4) }, () => [
          dice.of([...oddTexts, "id", "x", "vertex"]),
          anything(dice, depth + 1),
        ]),
      );
  }
}

/** A copy in which something, somewhere, is another value, missing, or too much. */
export function bent(value: Json, dice: Dice): Json {
  if (typeof value !== "object" || value === null || dice.below(6) === 0) return anything(dice);
  if (Array.isArray(value)) {
    const copy: Json[] = [...value];
    const at = dice.below(copy.length + 1);
    if (dice.below(4) === 0) copy.splice(at, 1 + dice.below(3));
    else if (at < copy.length) copy[at] = bent(copy[at], dice);
    else copy.push(copy.length > 0 ? copy[0] : anything(dice));
    return copy;
  }
  const copy: Json = { ...value };
  const keys = Object.keys(copy);
  const key = keys.length > 0 ? dice.of(keys) : "x";
  if (dice.below(5) === 0) delete copy[key];
  else if (dice.below(8) === 0) copy[dice.of(oddTexts)] = anything(dice);
  else copy[key] = bent(copy[key], dice);
  return copy;
}

export function bentBytes(bytes: Buffer, dice: Dice): Buffer {
  const copy = Buffer.from(bytes);
  for (let i = dice.below(4); i >= 0 && copy.length > 0; i--)
    copy[dice.below(copy.length)] = dice.below(256);
  switch (dice.below(6)) {
    case 0:
      return copy.subarray(0, dice.below(copy.length));
    case 1:
      return Buffer.concat([copy, copy.subarray(dice.below(copy.length))]);
    default:
      return copy;
  }
}

const words = [
  "v",
  "f",
  "o",
  "g",
  "vt",
  "0",
  "1",
  "-1",
  "1/2",
  "1//3",
  "1e400",
  "nan",
  "\\\n",
  "\n",
  "\n",
  "#",
  "solid",
  "facet",
  "ply",
  "end_header\n",
  "element",
  "vertex",
  "list",
  "\u2028",
];
/** A text of words that mean something in files. */
export const made = (dice: Dice): Buffer =>
  Buffer.from(Array.from({ length: dice.below(80) }, () => dice.of(words)).join(" "));

const corner = [0, 0, 0, 1, 0, 0, 0, 1, 0];
/** A file of each kind. */
export const files = [
  Buffer.from(
    "# a\no x\nv 0 0 0\nv 1 0 0\nv 1 1 0.5\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1 4/1\nf -4 -3 -2\n",
  ),
  Buffer.from(
    "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n",
  ),
  stlBytes(corner),
  plyBytes(true),
  plyBytes(false),
  Buffer.from(
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
  ),
  glb({ positions: corner, indices: [0, 1, 2] }),
  glb({ positions: corner, nodes: [{ children: [1] }, { mesh: 0, rotation: [0, 0, 1, 0] }] }),
];
