// Which triangles of a plane lie at a point: found in a grid, not by asking all of them.

/**
 * A grid of about as many cells as there are triangles, each with those whose box reaches into it. Built in
 * O(#F), for triangles of about the same size; those with a corner that is nowhere (NaN) are left out.
 */
export class Bins {
  readonly #corners: ArrayLike<number>;
  readonly #places: ArrayLike<number>;
  readonly #left: number;
  readonly #top: number;
  readonly #across: number;
  readonly #down: number;
  readonly #cell: number;
  readonly #first: Uint32Array;
  readonly #triangles: Uint32Array;

  /** `corners` are three for each triangle, `places` x and y of a corner. */
  constructor(corners: ArrayLike<number>, places: ArrayLike<number>) {
    [this.#corners, this.#places] = [corners, places];
    const count = corners.length / 3;
    const box = [Infinity, Infinity, -Infinity, -Infinity];
    for (let i = 0; i < places.length; i += 2) {
      const [x, y] = [places[i], places[i + 1]];
      if (x < box[0]) box[0] = x;
      if (y < box[1]) box[1] = y;
      if (x > box[2]) box[2] = x;
      if (y > box[3]) box[3] = y;
    }
    const [width, height] = [box[2] - box[0], box[3] - box[1]].map((one) => Math.max(0, one));
    const mean = Math.sqrt((width * height) / Math.max(1, count));
    this.#cell = Math.max(mean, (width + height) / Math.max(1, count), Number.MIN_VALUE);
    [this.#left, this.#top] = [box[0], box[1]];
    this.#across = count > 0 ? Math.floor(width / this.#cell) + 1 : 0;
    this.#down = count > 0 ? Math.floor(height / this.#cell) + 1 : 0;
    this.#first = new Uint32Array(this.#across * this.#down + 1);
    for (let t = 0; t < count; ++t) this.#cells(t, (cell) => this.#first[cell + 1]++);
    for (let i = 1; i < this.#first.length; ++i) this.#first[i] += this.#first[i - 1];
    this.#triangles = new Uint32Array(this.#first.at(-1) ?? 0);
    const filled = this.#first.slice();
    for (let t = 0; t < count; ++t) this.#cells(t, (cell) => (this.#triangles[filled[cell]++] = t));
  }

  #cells(triangle: number, act: (cell: number) => void): void {
    let left = Infinity;
    let top = Infinity;
    let right = -Infinity;
    let bottom = -Infinity;
    for (let k = 3 * triangle; k < 3 * triangle + 3; ++k) {
      const x = this.#places[2 * this.#corners[k]];
      const y = this.#places[2 * this.#corners[k] + 1];
      if (!(Number.isFinite(x) && Number.isFinite(y))) return;
      left = Math.min(left, x);
      right = Math.max(right, x);
      top = Math.min(top, y);
      bottom = Math.max(bottom, y);
    }
    const [from, to] = [this.#column(left), this.#column(right)];
    for (let row = this.#row(top); row <= this.#row(bottom); ++row)
      for (let column = from; column <= to; ++column) act(row * this.#across + column);
  }

  #column = (x: number): number =>
    Math.min(this.#across - 1, Math.max(0, Math.floor((x - this.#left) / this.#cell)));
  #row = (y: number): number =>
    Math.min(this.#down - 1, Math.max(0, Math.floor((y - this.#top) / this.#cell)));

  /** Triangles whose box may come as near to a point as that; some more than once. */
  near(x: number, y: number, reach: number): number[] {
    const found: number[] = [];
    if (this.#across === 0) return found;
    const [from, to] = [this.#column(x - reach), this.#column(x + reach)];
    for (let row = this.#row(y - reach); row <= this.#row(y + reach); ++row) {
      const base = row * this.#across;
      for (let i = this.#first[base + from]; i < this.#first[base + to + 1]; ++i)
        found.push(this.#triangles[i]);
    }
    return found;
  }

  /** Those that have the point, in the order of their numbers, with the weights of their corners. */
  at(x: number, y: number): { triangle: number; weights: [number, number, number] }[] {
    const hits: { triangle: number; weights: [number, number, number] }[] = [];
    const [corners, places] = [this.#corners, this.#places];
    for (const t of this.near(x, y, 0)) {
      const [a, b, c] = [2 * corners[3 * t], 2 * corners[3 * t + 1], 2 * corners[3 * t + 2]];
      const [ax, ay] = [places[a], places[a + 1]];
      const [bx, by] = [places[b] - ax, places[b + 1] - ay];
      const [cx, cy] = [places[c] - ax, places[c + 1] - ay];
      const area = bx * cy - cx * by;
      if (area === 0) continue;
      const wb = ((x - ax) * cy - cx * (y - ay)) / area;
      const wc = (bx * (y - ay) - (x - ax) * by) / area;
      if (wb >= 0 && wc >= 0 && wb + wc <= 1)
        hits.push({ triangle: t, weights: [1 - wb - wc, wb, wc] });
    }
    return hits;
  }
}
