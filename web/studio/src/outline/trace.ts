// Where a field on a grid is zero: marching squares.

/** A closed curve: x y x y…, the first point is not repeated. */
export type Loop = number[];

/**
 * The curves around what is above 0, all in one direction, and those around its holes in the other.
 * Corners that meet only diagonally are apart, so that curves neither cross nor
 * touch. The grid's border has to be below 0. Coordinates are those of the grid. O(size of the grid).
 */
export function trace(field: Float32Array, width: number, height: number): Loop[] {
  // A curve enters a cell through one edge and leaves through another. An edge is named by its
  // left or upper end: level ones first, then upright ones.
  const upright = width * height;
  const next = new Int32Array(2 * upright).fill(-1);
  for (let y = 0; y + 1 < height; ++y) {
    for (let x = 0; x + 1 < width; ++x) {
      const at = y * width + x;
      const cell =
        (field[at] > 0 ? 1 : 0) |
        (field[at + 1] > 0 ? 2 : 0) |
        (field[at + width + 1] > 0 ? 4 : 0) |
        (field[at + width] > 0 ? 8 : 0);
      if (cell === 0 || cell === 15) continue;
      const top = at;
      const bottom = at + width;
      const left = upright + at;
      const right = upright + at + 1;
      // Around each inside corner from the edge before it to the edge after it.
      const pairs: Record<number, number[]> = {
        1: [top, left],
        2: [right, top],
        3: [right, left],
        4: [bottom, right],
        5: [top, left, bottom, right],
        6: [bottom, top],
        7: [bottom, left],
        8: [left, bottom],
        9: [top, bottom],
        10: [right, top, left, bottom],
        11: [right, bottom],
        12: [left, right],
        13: [top, right],
        14: [left, top],
      };
      const links = pairs[cell];
      for (let i = 0; i < links.length; i += 2) next[links[i]] = links[i + 1];
    }
  }
  const loops: Loop[] = [];
  for (let start = 0; start < next.length; ++start) {
    if (next[start] < 0) continue;
    const loop: Loop = [];
    for (let edge = start; next[edge] >= 0; ) {
      const level = edge < upright;
      const at = level ? edge : edge - upright;
      const a = field[at];
      const b = field[level ? at + 1 : at + width];
      const t = Math.min(0.999, Math.max(0.001, a / (a - b)));
      loop.push((at % width) + (level ? t : 0), Math.floor(at / width) + (level ? 0 : t));
      const after = next[edge];
      next[edge] = -1;
      edge = after;
    }
    loops.push(loop);
  }
  return loops;
}

/** Twice the area is signed by the direction. */
export function areaOf(loop: Loop): number {
  let twice = 0;
  for (let i = 0; i < loop.length; i += 2) {
    const j = (i + 2) % loop.length;
    twice += loop[i] * loop[j + 1] - loop[j] * loop[i + 1];
  }
  return twice / 2;
}
