// The surface that is to be laid flat, and how its triangles hang together.

export type Format = "obj" | "ply" | "stl" | "glb";

export interface NamedPart {
  firstTriangle: number;
  name?: string;
}

export interface Surface {
  readonly name: string;
  /** x y z x y z… */
  readonly vertices: Float64Array;
  readonly triangles: Uint32Array;
  readonly parts: readonly NamedPart[];
  /** The file that it is from: it goes to the server again as it is. */
  readonly file: File | null;
  /** Null for a sample. */
  readonly format: Format | null;
  /** What its reader has said. */
  readonly warnings: readonly string[];
}

/** Edges have numbers; their ends are points, places that twins of a vertex share where those are joined. */
export interface Edges {
  readonly count: number;
  /** Two points for each edge. */
  readonly ends: Uint32Array;
  /** The same as the server knows it: two vertices of one triangle. */
  readonly named: Uint32Array;
  /** Three for each triangle: the k-th goes from corner k to the next. */
  readonly ofTriangle: Uint32Array;
  /** How many triangles have it. */
  readonly sides: Uint8Array;
  readonly lengths: Float64Array;
  /** The point of each vertex: the lowest vertex at its place. */
  readonly pointOf: Uint32Array;
  /** Edges at point p are around[first[p]] to around[first[p + 1] - 1]. */
  readonly first: Uint32Array;
  readonly around: Uint32Array;
}

/** Twins at the very same place, as files have them along texture seams, are one point where `join`. */
function pointsOf(vertices: Float64Array, join: boolean): Uint32Array {
  const count = vertices.length / 3;
  const points = Uint32Array.from({ length: count }, (_, i) => i);
  if (!join) return points;
  const known = new Map<string, number>();
  for (let i = 0; i < count; ++i) {
    const key = `${vertices[3 * i]} ${vertices[3 * i + 1]} ${vertices[3 * i + 2]}`;
    const twin = known.get(key);
    if (twin === undefined) known.set(key, i);
    else points[i] = twin;
  }
  return points;
}

export function edgesOf(surface: Surface, join: boolean): Edges {
  const { vertices, triangles } = surface;
  const pointOf = pointsOf(vertices, join);
  const points = pointOf.length;
  const known = new Map<number, number>();
  const ends: number[] = [];
  const named: number[] = [];
  const sides: number[] = [];
  const ofTriangle = new Uint32Array(triangles.length);
  for (let corner = 0; corner < triangles.length; ++corner) {
    const next = corner % 3 === 2 ? corner - 2 : corner + 1;
    const [p, q] = [pointOf[triangles[corner]], pointOf[triangles[next]]];
    const key = Math.min(p, q) * points + Math.max(p, q);
    let edge = known.get(key);
    if (edge === undefined) {
      edge = sides.length;
      known.set(key, edge);
      ends.push(p, q);
      named.push(triangles[corner], triangles[next]);
      sides.push(0);
    }
    sides[edge] = Math.min(255, sides[edge] + 1);
    ofTriangle[corner] = edge;
  }
  const count = sides.length;
  const first = new Uint32Array(points + 1);
  for (const point of ends) first[point + 1]++;
  for (let i = 0; i < points; ++i) first[i + 1] += first[i];
  const around = new Uint32Array(ends.length);
  const filled = first.slice();
  ends.forEach((point, i) => (around[filled[point]++] = i >> 1));
  const lengths = Float64Array.from({ length: count }, (_, edge) =>
    distance(vertices, ends[2 * edge], ends[2 * edge + 1]),
  );
  return {
    count,
    ends: Uint32Array.from(ends),
    named: Uint32Array.from(named),
    ofTriangle,
    sides: Uint8Array.from(sides),
    lengths,
    pointOf,
    first,
    around,
  };
}

export const distance = (vertices: ArrayLike<number>, p: number, q: number): number =>
  Math.hypot(
    vertices[3 * p] - vertices[3 * q],
    vertices[3 * p + 1] - vertices[3 * q + 1],
    vertices[3 * p + 2] - vertices[3 * q + 2],
  );

export const otherEnd = (edges: Edges, edge: number, point: number): number =>
  edges.ends[2 * edge] === point ? edges.ends[2 * edge + 1] : edges.ends[2 * edge];

export const isBorder = (edges: Edges, edge: number): boolean => edges.sides[edge] === 1;

export const isOnBorder = (edges: Edges, point: number): boolean => {
  for (let i = edges.first[point]; i < edges.first[point + 1]; ++i)
    if (isBorder(edges, edges.around[i])) return true;
  return false;
};

interface Extent {
  middle: number[];
  size: number[];
}
const extents = new WeakMap<Float64Array, Extent>();

/** The middle of the surface and how large it is along x, y and z. Asked again it is known. */
export function extentOf(vertices: Float64Array): Extent {
  let extent = extents.get(vertices);
  if (!extent) extents.set(vertices, (extent = measured(vertices)));
  return extent;
}

function measured(vertices: Float64Array): Extent {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < vertices.length; ++i) {
    low[i % 3] = Math.min(low[i % 3], vertices[i]);
    high[i % 3] = Math.max(high[i % 3], vertices[i]);
  }
  if (vertices.length === 0) return { middle: [0, 0, 0], size: [0, 0, 0] };
  return {
    middle: low.map((value, axis) => (value + high[axis]) / 2),
    size: low.map((value, axis) => high[axis] - value),
  };
}

/** x y z of each vertex, of length 1: the mean of its triangles, where large ones count for more. */
export function normalsOf({ vertices, triangles }: Surface): Float32Array {
  const normals = new Float32Array(vertices.length);
  for (let corner = 0; corner < triangles.length; corner += 3) {
    const a = 3 * triangles[corner];
    const b = 3 * triangles[corner + 1];
    const c = 3 * triangles[corner + 2];
    const side = (to: number, axis: number): number => vertices[to + axis] - vertices[a + axis];
    const x = side(b, 1) * side(c, 2) - side(b, 2) * side(c, 1);
    const y = side(b, 2) * side(c, 0) - side(b, 0) * side(c, 2);
    const z = side(b, 0) * side(c, 1) - side(b, 1) * side(c, 0);
    for (let k = 0; k < 3; ++k) {
      const vertex = 3 * triangles[corner + k];
      normals[vertex] += x;
      normals[vertex + 1] += y;
      normals[vertex + 2] += z;
    }
  }
  for (let i = 0; i < normals.length; i += 3) {
    const length = Math.hypot(normals[i], normals[i + 1], normals[i + 2]) || 1;
    for (let k = i; k < i + 3; ++k) normals[k] /= length;
  }
  return normals;
}

/** Where a surface has been hit. */
export interface Hit {
  triangle: number;
  /** Weights of its corners, of sum 1. */
  weights: readonly [number, number, number];
}

/** How far from a corner a click beside the surface still means it, in pixels. */
export const clickReach = 14;

/**
 * The corner that a click beside the surface means: the nearest within reach, and of those that are nearly so near
 * the one in front. `seen` says where a corner is in the view, and how far away.
 */
export function hitBeside(
  triangles: Iterable<number>,
  seen: (corner: number) => readonly [x: number, y: number, depth: number],
  x: number,
  y: number,
): Hit | null {
  let best = -1;
  let least = Infinity;
  for (const triangle of triangles) {
    for (let corner = 3 * triangle; corner < 3 * triangle + 3; ++corner) {
      const [vx, vy, depth] = seen(corner);
      const far = Math.hypot(vx - x, vy - y);
      if (far > clickReach) continue;
      const badness = far + 1e3 * depth;
      // The lowest of equals, in whichever order they are asked.
      if (badness < least || (badness === least && corner < best))
        [best, least] = [corner, badness];
    }
  }
  if (best < 0) return null;
  const weights = [0, 1, 2].map((k) => (k === best % 3 ? 1 : 0));
  return { triangle: Math.floor(best / 3), weights: weights as [number, number, number] };
}

/** The corner of the triangle that is nearest to the hit. */
export function nearestVertex({ triangles }: Surface, hit: Hit): number {
  const best = hit.weights.indexOf(Math.max(...hit.weights));
  return triangles[3 * hit.triangle + best];
}

/** The edge of the triangle that is nearest to the hit, by height above it. */
export function nearestEdge(edges: Edges, hit: Hit): number {
  // The height above an edge is the weight of the corner opposite times twice the area over the length.
  let best = 0;
  let least = Infinity;
  for (let k = 0; k < 3; ++k) {
    const edge = edges.ofTriangle[3 * hit.triangle + k];
    const height = hit.weights[(k + 2) % 3] / Math.max(edges.lengths[edge], Number.MIN_VALUE);
    if (height < least) [best, least] = [edge, height];
  }
  return best;
}
