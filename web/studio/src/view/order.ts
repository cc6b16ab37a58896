// In which order triangles are drawn where no pin says it.

const orders = new WeakMap<Uint32Array, Uint32Array>();

/**
 * Back to front: piece by piece, each from its thickest place outwards, so that a limb that is pulled over the
 * body lies on it as a whole. Computed once for a mesh, O(#F).
 */
export function orderOf(triangles: Uint32Array): Uint32Array {
  let order = orders.get(triangles);
  if (!order) orders.set(triangles, (order = computed(triangles)));
  return order;
}

function computed(triangles: Uint32Array): Uint32Array {
  const count = triangles.length / 3;
  const neighbours = neighboursOf(triangles);
  const rim: number[] = [];
  for (let t = 0; t < count; ++t) if (neighbours[t].length < 3) rim.push(t);
  const fromRim = steps(rim, neighbours);
  // Thickest first; of equals the lowest, so that it is always the same.
  const cores = Array.from({ length: count }, (_, t) => t).sort(
    (a, b) => fromRim[b] - fromRim[a] || a - b,
  );
  const piece = new Int32Array(count).fill(-1);
  const outwards = new Int32Array(count);
  let pieces = 0;
  for (const core of cores) {
    if (piece[core] >= 0) continue;
    const fromCore = steps([core], neighbours);
    for (let t = 0; t < count; ++t) {
      if (fromCore[t] < 0) continue;
      piece[t] = pieces;
      outwards[t] = fromCore[t];
    }
    ++pieces;
  }
  // Pieces stay in the order of their first triangles.
  const firsts: number[] = [];
  for (let t = 0; t < count; ++t) firsts[piece[t]] ??= t;
  return Uint32Array.from(
    Array.from({ length: count }, (_, t) => t).sort(
      (a, b) => firsts[piece[a]] - firsts[piece[b]] || outwards[a] - outwards[b] || a - b,
    ),
  );
}

function neighboursOf(triangles: Uint32Array): number[][] {
  const count = triangles.length / 3;
  const neighbours: number[][] = Array.from({ length: count }, () => []);
  const sides = new Map<number, number>();
  // An edge as one number; exact for less than 2^26 vertices.
  const key = (a: number, b: number): number => Math.min(a, b) * 2 ** 26 + Math.max(a, b);
  for (let t = 0; t < count; ++t) {
    for (let k = 0; k < 3; ++k) {
      const edge = key(triangles[3 * t + k], triangles[3 * t + ((k + 1) % 3)]);
      const other = sides.get(edge);
      if (other === undefined) sides.set(edge, t);
      else {
        neighbours[t].push(other);
        neighbours[other].push(t);
      }
    }
  }
  return neighbours;
}

/** How many steps triangles are from the nearest of these; -1: they are not connected. */
function steps(from: readonly number[], neighbours: readonly number[][]): Int32Array {
  const far = new Int32Array(neighbours.length).fill(-1);
  let now = [...from];
  for (const t of now) far[t] = 0;
  for (let step = 1; now.length > 0; ++step) {
    const next: number[] = [];
    for (const t of now) {
      for (const other of neighbours[t]) {
        if (far[other] >= 0) continue;
        far[other] = step;
        next.push(other);
      }
    }
    now = next;
  }
  return far;
}
