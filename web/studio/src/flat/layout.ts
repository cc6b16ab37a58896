// A layout as the page shows it, and what can be said about it.
import type { Answer, Distortion } from "./net.js";
import type { Method } from "./pattern.js";
import { strainOf } from "./strain.js";
import type { Edges, NamedPart, Surface } from "./surface.js";

export interface Piece {
  /** Of the object or group that most of it is from; empty: none. Pieces of one name are numbered. */
  name: string;
  /** Within it, for what is written on it. */
  middle: readonly [u: number, v: number];
  triangles: number;
  distortion: Distortion;
  /** Of the flat piece, in units of the surface, along u and v. */
  width: number;
  height: number;
  /** Flat, and as it is on the surface, in square units. */
  area: number;
  areaOnSurface: number;
  left: number;
  bottom: number;
}

export interface Layout {
  method: Method;
  /** u v u v… */
  uv: Float64Array;
  uvVertex: Uint32Array;
  cornerUv: Uint32Array;
  pieceOf: Uint32Array;
  pieces: Piece[];
  /** In percent, for each triangle; and both principal ones. */
  strain: Float64Array;
  principal: Float64Array;
  /** Triangles that lie the other way round. */
  flipped: Set<number>;
  distortion: Distortion;
  /** Edges that were cut without being asked for. */
  autoCuts: number[];
  overlaps: boolean;
  warnings: string[];
}

function areaOf({ vertices, triangles }: Surface, triangle: number): number {
  const [a, b, c] = triangles.subarray(3 * triangle, 3 * triangle + 3);
  const side = (to: number, axis: number): number =>
    vertices[3 * to + axis] - vertices[3 * a + axis];
  const [x, y, z] = [side(b, 0), side(b, 1), side(b, 2)];
  const [u, v, w] = [side(c, 0), side(c, 1), side(c, 2)];
  return Math.hypot(y * w - z * v, z * u - x * w, x * v - y * u) / 2;
}

export function layoutOf(answer: Answer, method: Method, surface: Surface, edges: Edges): Layout {
  const uv = Float64Array.from(answer.uv);
  const cornerUv = Uint32Array.from(answer.cornerUv);
  const pieceOf = Uint32Array.from(answer.triangleChart);
  const principal = Float64Array.from(answer.singularValues, (value) => 100 * (value - 1));
  const count = pieceOf.length;
  const strain = Float64Array.from({ length: count }, (_, t) => {
    const [s1, s2] = [answer.singularValues[2 * t], answer.singularValues[2 * t + 1]];
    return s1 === 0 && s2 === 0 ? 0 : strainOf(s1, s2);
  });
  const boxes = answer.charts.map(() => [Infinity, Infinity, -Infinity, -Infinity]);
  const areas = answer.charts.map(() => [0, 0]);
  const flipped = new Set<number>();
  for (let t = 0; t < count; ++t) {
    const box = boxes[pieceOf[t]];
    const at = [0, 1, 2].map((k) => 2 * cornerUv[3 * t + k]);
    for (const i of at) {
      box[0] = Math.min(box[0], uv[i]);
      box[1] = Math.min(box[1], uv[i + 1]);
      box[2] = Math.max(box[2], uv[i]);
      box[3] = Math.max(box[3], uv[i + 1]);
    }
    const [a, b, c] = at;
    const twice =
      (uv[b] - uv[a]) * (uv[c + 1] - uv[a + 1]) - (uv[c] - uv[a]) * (uv[b + 1] - uv[a + 1]);
    if (twice < 0) flipped.add(t);
    areas[pieceOf[t]][0] += Math.abs(twice) / 2;
    areas[pieceOf[t]][1] += areaOf(surface, t);
  }
  const names = namesOf(pieceOf, boxes.length, surface.parts);
  const middles = middlesOf(uv, cornerUv, pieceOf, boxes);
  return {
    method,
    uv,
    uvVertex: Uint32Array.from(answer.uvVertex),
    cornerUv,
    pieceOf,
    pieces: answer.charts.map(({ triangleCount, distortion }, i) => ({
      name: names[i],
      middle: middles[i],
      triangles: triangleCount,
      distortion,
      left: boxes[i][0],
      bottom: boxes[i][1],
      width: boxes[i][2] - boxes[i][0],
      height: boxes[i][3] - boxes[i][1],
      area: areas[i][0],
      areaOnSurface: areas[i][1],
    })),
    strain,
    principal,
    flipped,
    distortion: answer.distortion,
    autoCuts: autoCutsOf(answer, edges),
    overlaps: answer.boundaryOverlaps,
    warnings: answer.warnings.map(({ message }) => message),
  };
}

/** The names of pieces, as the server's drawings have them. */
export function namesOf(
  pieceOf: ArrayLike<number>,
  pieces: number,
  parts: readonly NamedPart[],
): string[] {
  const known = [...new Set(["", ...parts.map(({ name }) => name ?? "")])];
  const numbers = parts.map(({ name }) => known.indexOf(name ?? ""));
  const votes = Array.from({ length: pieces }, () => new Map<number, number>());
  let part = -1;
  for (let t = 0; t < pieceOf.length; ++t) {
    while (part + 1 < parts.length && parts[part + 1].firstTriangle <= t) ++part;
    const number = part < 0 ? 0 : numbers[part];
    const votesOf = votes[pieceOf[t]];
    votesOf.set(number, (votesOf.get(number) ?? 0) + 1);
  }
  // Of equals the one that comes first in the file.
  const elected = votes.map((one) => {
    const [best] = [...one].sort((a, b) => b[1] - a[1] || a[0] - b[0]);
    return best ? known[best[0]] : "";
  });
  const counts = new Map<string, number>();
  for (const name of elected) counts.set(name, (counts.get(name) ?? 0) + 1);
  const alone = (name: string): boolean => name !== "" && counts.get(name) === 1;
  const taken = new Set(elected.filter(alone));
  const last = new Map<string, number>();
  return elected.map((name) => {
    if (name === "" || alone(name)) return name;
    let own: string;
    do {
      last.set(name, (last.get(name) ?? 0) + 1);
      own = `${name} ${last.get(name)}`;
    } while (taken.has(own));
    taken.add(own);
    return own;
  });
}

// The middle of the triangle that is nearest to the middle of each piece's box.
function middlesOf(
  uv: Float64Array,
  cornerUv: Uint32Array,
  pieceOf: Uint32Array,
  boxes: readonly number[][],
): [number, number][] {
  const middles: [number, number][] = boxes.map(() => [0, 0]);
  const least = boxes.map(() => Infinity);
  for (let t = 0; t < pieceOf.length; ++t) {
    const [a, b, c] = [2 * cornerUv[3 * t], 2 * cornerUv[3 * t + 1], 2 * cornerUv[3 * t + 2]];
    const [u, v] = [(uv[a] + uv[b] + uv[c]) / 3, (uv[a + 1] + uv[b + 1] + uv[c + 1]) / 3];
    const [left, bottom, right, top] = boxes[pieceOf[t]];
    const far = Math.hypot(u - (left + right) / 2, v - (bottom + top) / 2);
    if (far >= least[pieceOf[t]]) continue;
    least[pieceOf[t]] = far;
    middles[pieceOf[t]] = [u, v];
  }
  return middles;
}

function autoCutsOf(answer: Answer, edges: Edges): number[] {
  const cuts: number[] = [];
  const from = answer.cutEdges.length - 2 * answer.autoCutCount;
  for (let i = from; i < answer.cutEdges.length; i += 2) {
    const [p, q] = [0, 1].map((k) => edges.pointOf[answer.cutEdges[i + k]]);
    for (let j = edges.first[p]; j < edges.first[p + 1]; ++j) {
      const edge = edges.around[j];
      if (edges.ends[2 * edge] === q || edges.ends[2 * edge + 1] === q) cuts.push(edge);
    }
  }
  return cuts;
}

/** The flat positions of a vertex, one for each side of a cut. */
export function copiesOf(layout: Layout, vertex: number): number[] {
  const copies: number[] = [];
  layout.uvVertex.forEach((one, flat) => {
    if (one === vertex) copies.push(flat);
  });
  return copies;
}

/** Where a vertex is held: the lowest of its flat positions, which has its number. */
export const flatOf = (layout: Layout, vertex: number): [number, number] => [
  layout.uv[2 * vertex],
  layout.uv[2 * vertex + 1],
];
