// Triangles of the plane: who holds a point, and where it is.

/** Weights of the three corners of a triangle, of sum 1. */
export type Weights = readonly [number, number, number];

export interface Hold {
  triangle: number;
  weights: Weights;
}

export interface Box {
  left: number;
  bottom: number;
  right: number;
  top: number;
}

/** Of x y x y…; a unit square where there is nothing. */
export function boxOf(points: ArrayLike<number>): Box {
  if (points.length === 0) return { left: 0, bottom: 0, right: 1, top: 1 };
  const box = { left: Infinity, bottom: Infinity, right: -Infinity, top: -Infinity };
  for (let i = 0; i < points.length; i += 2) {
    box.left = Math.min(box.left, points[i]);
    box.right = Math.max(box.right, points[i]);
    box.bottom = Math.min(box.bottom, points[i + 1]);
    box.top = Math.max(box.top, points[i + 1]);
  }
  return box;
}

/** The place that a hold has among these vertices. */
export function placeOf(
  hold: Hold,
  triangles: ArrayLike<number>,
  vertices: ArrayLike<number>,
): [number, number] {
  let x = 0;
  let y = 0;
  for (let k = 0; k < 3; ++k) {
    const vertex = triangles[3 * hold.triangle + k];
    x += hold.weights[k] * vertices[2 * vertex];
    y += hold.weights[k] * vertices[2 * vertex + 1];
  }
  return [x, y];
}

function weightsIn(
  triangle: number,
  x: number,
  y: number,
  triangles: ArrayLike<number>,
  vertices: ArrayLike<number>,
): Weights | undefined {
  const a = 2 * triangles[3 * triangle];
  const b = 2 * triangles[3 * triangle + 1];
  const c = 2 * triangles[3 * triangle + 2];
  const bx = vertices[b] - vertices[a];
  const by = vertices[b + 1] - vertices[a + 1];
  const cx = vertices[c] - vertices[a];
  const cy = vertices[c + 1] - vertices[a + 1];
  const area = bx * cy - by * cx;
  if (area === 0) return undefined;
  const px = x - vertices[a];
  const py = y - vertices[a + 1];
  const v = (px * cy - py * cx) / area;
  const w = (bx * py - by * px) / area;
  return [1 - v - w, v, w];
}

/**
 * The triangle on top that holds a point. `order` lists triangles back to front; without it the
 * last one is on top. O(#F).
 */
export function holdAt(
  x: number,
  y: number,
  triangles: ArrayLike<number>,
  vertices: ArrayLike<number>,
  order?: ArrayLike<number>,
): Hold | undefined {
  const count = triangles.length / 3;
  for (let i = count - 1; i >= 0; --i) {
    const triangle = order && order.length === count ? order[i] : i;
    const weights = weightsIn(triangle, x, y, triangles, vertices);
    if (weights && Math.min(...weights) >= -1e-9) return { triangle, weights: clamped(weights) };
  }
  return undefined;
}

const clamped = (weights: Weights): Weights => {
  const [a, b, c] = weights.map((weight) => Math.max(0, weight));
  const sum = a + b + c;
  return [a / sum, b / sum, c / sum];
};

/** The hold nearest to a point that lies outside: on the closest triangle's border. O(#F). */
export function nearestHold(
  x: number,
  y: number,
  triangles: ArrayLike<number>,
  vertices: ArrayLike<number>,
): Hold {
  const inside = holdAt(x, y, triangles, vertices);
  if (inside) return inside;
  let best: Hold = { triangle: 0, weights: [1, 0, 0] };
  let least = Infinity;
  for (let triangle = 0; triangle < triangles.length / 3; ++triangle) {
    for (let k = 0; k < 3; ++k) {
      const a = 2 * triangles[3 * triangle + k];
      const b = 2 * triangles[3 * triangle + ((k + 1) % 3)];
      const ex = vertices[b] - vertices[a];
      const ey = vertices[b + 1] - vertices[a + 1];
      const along = ((x - vertices[a]) * ex + (y - vertices[a + 1]) * ey) / (ex * ex + ey * ey);
      const t = Math.min(1, Math.max(0, along));
      const distance = Math.hypot(vertices[a] + t * ex - x, vertices[a + 1] + t * ey - y);
      if (!(distance < least)) continue;
      least = distance;
      const weights: [number, number, number] = [0, 0, 0];
      weights[k] = 1 - t;
      weights[(k + 1) % 3] = t;
      best = { triangle, weights };
    }
  }
  return best;
}
