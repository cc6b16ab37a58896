// Fewer points for the same curves.
import type { Loop } from "./trace.js";

/**
 * A part of the points of a closed curve. No point of the curve is farther than `tolerance` from
 * the polygon that is left, which has at least three corners if the curve has.
 */
export function simplify(loop: Loop, tolerance: number): Loop {
  const count = loop.length / 2;
  if (count <= 3 || tolerance <= 0) return loop.slice();
  const keep = new Uint8Array(count);
  const far = farthest(loop, 0);
  keep[0] = keep[far] = 1;
  const open: [number, number][] = [
    [0, far],
    [far, count],
  ];
  for (let span = open.pop(); span; span = open.pop()) {
    const [first, last] = span;
    let worst = -1;
    let distance = tolerance;
    for (let i = first + 1; i < last; ++i) {
      const d = distanceToSegment(loop, i, first, last % count);
      if (d > distance) [worst, distance] = [i, d];
    }
    if (worst < 0) continue;
    keep[worst] = 1;
    open.push([first, worst], [worst, last]);
  }
  if (keep.reduce((sum, kept) => sum + kept, 0) < 3) keep[apart(loop, 0, far)] = 1;
  return loop.filter((_, i) => keep[i >> 1]);
}

function farthest(loop: Loop, from: number): number {
  let best = 0;
  let most = -1;
  for (let i = 0; i < loop.length / 2; ++i) {
    const d = Math.hypot(loop[2 * i] - loop[2 * from], loop[2 * i + 1] - loop[2 * from + 1]);
    if (d > most) [best, most] = [i, d];
  }
  return best;
}

function apart(loop: Loop, a: number, b: number): number {
  let best = 0;
  let most = -1;
  for (let i = 0; i < loop.length / 2; ++i) {
    const d = i === a || i === b ? -1 : distanceToSegment(loop, i, a, b);
    if (d > most) [best, most] = [i, d];
  }
  return best;
}

function distanceToSegment(loop: Loop, point: number, a: number, b: number): number {
  const [px, py] = [loop[2 * point] - loop[2 * a], loop[2 * point + 1] - loop[2 * a + 1]];
  const [ex, ey] = [loop[2 * b] - loop[2 * a], loop[2 * b + 1] - loop[2 * a + 1]];
  const length = ex * ex + ey * ey;
  const t = length > 0 ? Math.min(1, Math.max(0, (px * ex + py * ey) / length)) : 0;
  return Math.hypot(px - t * ex, py - t * ey);
}

/** Whether two sides of closed curves cross or touch, but where they are neighbours. */
export function doCross(loops: readonly Loop[]): boolean {
  const sides: { loop: number; index: number; count: number; at: number[] }[] = [];
  let length = 0;
  loops.forEach((points, loop) => {
    const count = points.length / 2;
    for (let index = 0; index < count; ++index) {
      const j = ((index + 1) % count) * 2;
      const at = [points[2 * index], points[2 * index + 1], points[j], points[j + 1]];
      length += Math.hypot(at[2] - at[0], at[3] - at[1]);
      sides.push({ loop, index, count, at });
    }
  });
  // Only sides that share a square of a grid can meet.
  const cell = Math.max(length / Math.max(1, sides.length), 1e-9);
  const grid = new Map<string, number[]>();
  for (let i = 0; i < sides.length; ++i) {
    const [ax, ay, bx, by] = sides[i].at;
    for (let x = low(ax, bx, cell); x <= high(ax, bx, cell); ++x) {
      for (let y = low(ay, by, cell); y <= high(ay, by, cell); ++y) {
        const key = `${x},${y}`;
        const others = grid.get(key) ?? [];
        for (const j of others) if (meet(sides[i], sides[j])) return true;
        others.push(i);
        grid.set(key, others);
      }
    }
  }
  return false;
}

const low = (a: number, b: number, cell: number): number => Math.floor(Math.min(a, b) / cell);
const high = (a: number, b: number, cell: number): number => Math.floor(Math.max(a, b) / cell);

interface Side {
  loop: number;
  index: number;
  count: number;
  at: number[];
}

function meet(a: Side, b: Side): boolean {
  const steps = Math.abs(a.index - b.index);
  if (a.loop === b.loop && (steps <= 1 || steps === a.count - 1)) return false;
  const turn = (s: number[], x: number, y: number): number =>
    Math.sign((s[2] - s[0]) * (y - s[1]) - (s[3] - s[1]) * (x - s[0]));
  const [a0, a1] = [turn(b.at, a.at[0], a.at[1]), turn(b.at, a.at[2], a.at[3])];
  const [b0, b1] = [turn(a.at, b.at[0], b.at[1]), turn(a.at, b.at[2], b.at[3])];
  if (a0 === 0 && a1 === 0) {
    const reach = (k: number): boolean =>
      Math.min(a.at[k], a.at[k + 2]) <= Math.max(b.at[k], b.at[k + 2]) &&
      Math.min(b.at[k], b.at[k + 2]) <= Math.max(a.at[k], a.at[k + 2]);
    return reach(0) && reach(1);
  }
  return a0 * a1 <= 0 && b0 * b1 <= 0;
}
