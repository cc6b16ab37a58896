// Meshes for tests.
export interface Grid {
  vertices: Float64Array;
  triangles: Uint32Array;
}

/** Columns × rows vertices one apart, in the plane, or in space by `height`. */
export function grid(
  columns: number,
  rows: number,
  height?: (x: number, y: number) => number,
): Grid {
  const dimension = height ? 3 : 2;
  const vertices = new Float64Array(columns * rows * dimension);
  const triangles: number[] = [];
  for (let y = 0; y < rows; y++) {
    for (let x = 0; x < columns; x++) {
      const vertex = y * columns + x;
      vertices.set(height ? [x, y, height(x, y)] : [x, y], vertex * dimension);
      if (x + 1 < columns && y + 1 < rows) {
        triangles.push(
          vertex,
          vertex + 1,
          vertex + columns,
          vertex + 1,
          vertex + columns + 1,
          vertex + columns,
        );
      }
    }
  }
  return { vertices, triangles: Uint32Array.from(triangles) };
}

/** The largest distance between two lists of points in the plane. */
export function farthest(a: ArrayLike<number>, b: ArrayLike<number>): number {
  if (a.length !== b.length) return Infinity;
  let worst = 0;
  for (let i = 0; i < a.length; i += 2)
    worst = Math.max(worst, Math.hypot(a[i]! - b[i]!, a[i + 1]! - b[i + 1]!));
  return worst;
}
