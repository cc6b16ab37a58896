// Seams as sets of edges: paths, loops, and runs that hang together.
import { distance, isBorder, isOnBorder, otherEnd } from "./surface.js";
import type { Edges, Surface } from "./surface.js";

/** A heap of points by key. */
class Queue {
  #points: number[] = [];
  #keys: number[] = [];

  get isEmpty(): boolean {
    return this.#points.length === 0;
  }

  push(point: number, key: number): void {
    let i = this.#points.length;
    while (i > 0) {
      const parent = (i - 1) >> 1;
      if (this.#keys[parent] <= key) break;
      this.#points[i] = this.#points[parent];
      this.#keys[i] = this.#keys[parent];
      i = parent;
    }
    this.#points[i] = point;
    this.#keys[i] = key;
  }

  /** The one with the lowest key. */
  pop(): number {
    const top = this.#points[0];
    const point = this.#points.pop()!;
    const key = this.#keys.pop()!;
    const count = this.#points.length;
    if (count === 0) return top;
    let i = 0;
    for (;;) {
      let child = 2 * i + 1;
      if (child >= count) break;
      if (child + 1 < count && this.#keys[child + 1] < this.#keys[child]) ++child;
      if (this.#keys[child] >= key) break;
      this.#points[i] = this.#points[child];
      this.#keys[i] = this.#keys[child];
      i = child;
    }
    this.#points[i] = point;
    this.#keys[i] = key;
    return top;
  }
}

/** The edges of the shortest way from one point to the other, in order; none where there is no way. */
export function shortestPath(
  { vertices }: Surface,
  edges: Edges,
  from: number,
  to: number,
): number[] {
  if (from === to) return [];
  const points = edges.pointOf.length;
  const lengths = new Float64Array(points).fill(Infinity);
  const by = new Int32Array(points).fill(-1);
  const done = new Uint8Array(points);
  const queue = new Queue();
  lengths[from] = 0;
  queue.push(from, 0);
  while (!queue.isEmpty) {
    const point = queue.pop();
    if (point === to) break;
    if (done[point]) continue;
    done[point] = 1;
    for (let i = edges.first[point]; i < edges.first[point + 1]; ++i) {
      const edge = edges.around[i];
      const next = otherEnd(edges, edge, point);
      const there = lengths[point] + edges.lengths[edge];
      if (there >= lengths[next]) continue;
      lengths[next] = there;
      by[next] = edge;
      // No way on is shorter than the straight one: what leads away from the end comes last.
      queue.push(next, there + distance(vertices, next, to));
    }
  }
  const path: number[] = [];
  for (let at = to; at !== from; at = otherEnd(edges, by[at], at)) {
    if (by[at] < 0) return [];
    path.push(by[at]);
  }
  return path.reverse();
}

const leastCosine = 0.5; // A line that turns by more than 60 degrees has ended.

// The edge at `point` that goes on most nearly as `edge` came.
function straightOn(surface: Surface, edges: Edges, edge: number, point: number): number {
  const { vertices } = surface;
  const towards = (p: number, q: number): number[] => {
    const d = [0, 1, 2].map((axis) => vertices[3 * q + axis] - vertices[3 * p + axis]);
    const length = Math.hypot(...d) || 1;
    return d.map((value) => value / length);
  };
  const came = towards(otherEnd(edges, edge, point), point);
  let best = -1;
  let most = leastCosine;
  for (let i = edges.first[point]; i < edges.first[point + 1]; ++i) {
    const next = edges.around[i];
    if (next === edge || isBorder(edges, next)) continue;
    const goes = towards(point, otherEnd(edges, next, point));
    const cosine = came[0] * goes[0] + came[1] * goes[1] + came[2] * goes[2];
    if (cosine > most) [best, most] = [next, cosine];
  }
  return best;
}

/**
 * The line through an edge that goes on as straight as the edges let it, both ways, until it meets itself or the
 * border, or turns sharply.
 */
export function loopThrough(surface: Surface, edges: Edges, edge: number): number[] {
  if (isBorder(edges, edge)) return [];
  const loop = new Set([edge]);
  const met = new Set([edges.ends[2 * edge], edges.ends[2 * edge + 1]]);
  for (const start of [edges.ends[2 * edge + 1], edges.ends[2 * edge]]) {
    let at = start;
    let by = edge;
    while (!isOnBorder(edges, at)) {
      by = straightOn(surface, edges, by, at);
      if (by < 0 || loop.has(by)) break;
      loop.add(by);
      at = otherEnd(edges, by, at);
      if (met.has(at)) break;
      met.add(at);
    }
  }
  return [...loop];
}

/** All of them in, or, when all are in already, all of them out. Sorted. */
export function toggled(seams: readonly number[], some: readonly number[]): number[] {
  const set = new Set(seams);
  const add = some.some((edge) => !set.has(edge));
  for (const edge of some) {
    if (add) set.add(edge);
    else set.delete(edge);
  }
  return [...set].sort((a, b) => a - b);
}

export interface Run {
  edges: number[];
  length: number;
}

/** Seams that hang together, the longest first. */
export function runsOf(edges: Edges, seams: readonly number[]): Run[] {
  const left = new Set(seams);
  const runs: Run[] = [];
  for (const seam of seams) {
    if (!left.delete(seam)) continue;
    const run: Run = { edges: [], length: 0 };
    for (const waiting = [seam]; waiting.length > 0; ) {
      const edge = waiting.pop()!;
      run.edges.push(edge);
      run.length += edges.lengths[edge];
      for (const point of [edges.ends[2 * edge], edges.ends[2 * edge + 1]]) {
        for (let i = edges.first[point]; i < edges.first[point + 1]; ++i)
          if (left.delete(edges.around[i])) waiting.push(edges.around[i]);
      }
    }
    runs.push(run);
  }
  return runs.sort((a, b) => b.length - a.length);
}
