// What is inside a picture: above 0 where it is opaque enough, or near what is.

export interface Picture {
  width: number;
  height: number;
  /** Of every pixel, 0 to 255, row by row from the top. */
  alpha: ArrayLike<number>;
}

export interface Field {
  width: number;
  height: number;
  values: Float32Array;
  /** The pixel (0, 0) of the picture is here in the grid. */
  margin: number;
}

/** `expansion` in pixels, 0 and up; `threshold` of the alpha, 1 to 255. */
export function fieldOf(picture: Picture, threshold: number, expansion: number): Field {
  const margin = Math.ceil(expansion) + 2;
  const width = picture.width + 2 * margin;
  const height = picture.height + 2 * margin;
  const values = new Float32Array(width * height).fill(-threshold + 0.5);
  for (let y = 0; y < picture.height; ++y) {
    for (let x = 0; x < picture.width; ++x) {
      values[(y + margin) * width + x + margin] =
        picture.alpha[y * picture.width + x] - (threshold - 0.5);
    }
  }
  if (expansion > 0) widen(values, width, height, expansion);
  return { width, height, values, margin };
}

// Above 0 within `expansion` of what was.
function widen(values: Float32Array, width: number, height: number, expansion: number): void {
  const squares = new Float64Array(values.length);
  // Larger than any distance on the grid, and small enough for differences of it to be exact.
  const far = 4 * (width * width + height * height);
  for (let i = 0; i < values.length; ++i) squares[i] = values[i] > 0 ? 0 : far;
  const column = new Float64Array(height);
  for (let x = 0; x < width; ++x) {
    for (let y = 0; y < height; ++y) column[y] = squares[y * width + x];
    const nearest = nearestSquares(column);
    for (let y = 0; y < height; ++y) squares[y * width + x] = nearest[y];
  }
  for (let y = 0; y < height; ++y) {
    const nearest = nearestSquares(squares.subarray(y * width, (y + 1) * width));
    for (let x = 0; x < width; ++x) {
      // A pixel reaches half a pixel from its centre. Never 0 itself, which is on neither side.
      values[y * width + x] = expansion + 0.5 - Math.sqrt(nearest[x]) || 1e-6;
    }
  }
}

// For every i the least over j of (i − j)² + squares[j]: the lower envelope of parabolas, O(n).
function nearestSquares(squares: Float64Array): Float64Array {
  const count = squares.length;
  const roots = new Int32Array(count);
  const from = new Float64Array(count + 1);
  const cross = (i: number, j: number): number =>
    (squares[i] + i * i - squares[j] - j * j) / (2 * (i - j));
  let last = 0;
  from[0] = -Infinity;
  for (let i = 1; i < count; ++i) {
    let start = cross(i, roots[last]);
    while (start <= from[last]) start = cross(i, roots[--last]);
    roots[++last] = i;
    from[last] = start;
  }
  const nearest = new Float64Array(count);
  for (let i = 0, k = 0; i < count; ++i) {
    while (k < last && from[k + 1] <= i) ++k;
    nearest[i] = (i - roots[k]) ** 2 + squares[roots[k]];
  }
  return nearest;
}
