// From pictures to outlines.
import assert from "node:assert/strict";
import { test } from "node:test";

import { fieldOf } from "../src/outline/field.js";
import type { Picture } from "../src/outline/field.js";
import { outlinesOf } from "../src/outline/outlines.js";
import { doCross, simplify } from "../src/outline/simplify.js";
import { areaOf, trace } from "../src/outline/trace.js";

const draw = (
  width: number,
  height: number,
  inside: (x: number, y: number) => boolean,
): Picture => ({
  width,
  height,
  alpha: Uint8Array.from({ length: width * height }, (_, i) =>
    inside((i % width) + 0.5, Math.floor(i / width) + 0.5) ? 255 : 0,
  ),
});
const options = { threshold: 128, tolerance: 0.5, expansion: 0 };
const disc = (cx: number, cy: number, r: number) => (x: number, y: number) =>
  Math.hypot(x - cx, y - cy) < r;

function distance(x: number, y: number, loop: number[]): number {
  let least = Infinity;
  for (let i = 0; i < loop.length; i += 2) {
    const j = (i + 2) % loop.length;
    const [ex, ey] = [loop[j] - loop[i], loop[j + 1] - loop[i + 1]];
    const along = ((x - loop[i]) * ex + (y - loop[i + 1]) * ey) / (ex * ex + ey * ey);
    const t = Math.min(1, Math.max(0, along));
    least = Math.min(least, Math.hypot(loop[i] + t * ex - x, loop[i + 1] + t * ey - y));
  }
  return least;
}

test("a disc is one loop, with y up and the area of the disc", () => {
  const { loops, dropped } = outlinesOf(draw(80, 60, disc(30, 20, 15)), options);
  assert.equal(loops.length, 1);
  assert.equal(dropped, 0);
  assert.ok(Math.abs(Math.abs(areaOf(loops[0])) - Math.PI * 225) < 30);
  for (let i = 0; i < loops[0].length; i += 2) {
    const r = Math.hypot(loops[0][i] - 30, loops[0][i + 1] - 40);
    assert.ok(Math.abs(r - 15) < 1.5, `a point at radius ${r}`);
  }
});

test("a ring has a hole, which runs the other way; two discs are two pieces", () => {
  const outer = disc(40, 40, 30);
  const inner = disc(40, 40, 12);
  const ring = outlinesOf(
    draw(80, 80, (x, y) => outer(x, y) && !inner(x, y)),
    options,
  ).loops;
  assert.equal(ring.length, 2);
  assert.ok(areaOf(ring[0]) * areaOf(ring[1]) < 0);
  const left = disc(20, 40, 12);
  const right = disc(60, 40, 12);
  const pair = outlinesOf(
    draw(80, 80, (x, y) => left(x, y) || right(x, y)),
    options,
  ).loops;
  assert.equal(pair.length, 2);
  assert.ok(areaOf(pair[0]) * areaOf(pair[1]) > 0);
});

test("what is simplified stays within the tolerance, and has fewer points the larger it is", () => {
  const wave = draw(
    200,
    100,
    (x, y) => Math.abs(y - 50 - 20 * Math.sin(x / 17)) < 14 && x > 5 && x < 195,
  );
  const field = fieldOf(wave, 128, 0);
  const [traced] = trace(field.values, field.width, field.height);
  let before = Infinity;
  for (const tolerance of [0.25, 0.5, 1, 2, 4]) {
    const loop = simplify(traced, tolerance);
    assert.ok(loop.length < before);
    before = loop.length;
    for (let i = 0; i < traced.length; i += 2) {
      assert.ok(distance(traced[i], traced[i + 1], loop) <= tolerance + 1e-9);
    }
  }
});

test("the error that is told holds, also where a large one would let the outline cross itself", () => {
  // A thin spiral: simplified by more than its width it would cross itself.
  const spiral = draw(160, 160, (x, y) => {
    const [r, a] = [Math.hypot(x - 80, y - 80), Math.atan2(y - 80, x - 80) + Math.PI];
    const turn = (r - 8) / 10 - a / (2 * Math.PI);
    return r > 8 && r < 70 && turn - Math.floor(turn) < 0.4;
  });
  const { loops, error } = outlinesOf(spiral, { ...options, tolerance: 12 });
  assert.ok(error < 12);
  assert.ok(!doCross(loops));
  const exact = outlinesOf(spiral, { ...options, tolerance: 0 }).loops;
  for (const loop of exact) {
    for (let i = 0; i < loop.length; i += 2) {
      const near = Math.min(...loops.map((one) => distance(loop[i], loop[i + 1], one)));
      assert.ok(near <= error + 1e-9);
    }
  }
});

test("expansion reaches as far as it says, and closes what is narrower", () => {
  const [plain] = outlinesOf(draw(100, 100, disc(50, 50, 20)), options).loops;
  const [wide] = outlinesOf(draw(100, 100, disc(50, 50, 20)), { ...options, expansion: 10 }).loops;
  const radius = (loop: number[]): number => Math.sqrt(Math.abs(areaOf(loop)) / Math.PI);
  assert.ok(Math.abs(radius(wide) - radius(plain) - 10) < 1);
  // Beyond the border of the picture too.
  const whole = outlinesOf(
    draw(30, 30, () => true),
    { ...options, expansion: 5 },
  ).loops[0];
  assert.ok(Math.min(...whole) < -4);
  const gap = draw(60, 60, (x, y) => disc(30, 30, 25)(x, y) && !disc(30, 30, 4)(x, y));
  assert.equal(outlinesOf(gap, options).loops.length, 2);
  assert.equal(outlinesOf(gap, { ...options, expansion: 6 }).loops.length, 1);
});

test("corners that touch are apart, specks are dropped and counted, nothing gives nothing", () => {
  const board = draw(40, 40, (x, y) => x < 20 === y < 20 && x > 4 && x < 36 && y > 4 && y < 36);
  const { loops } = outlinesOf(board, options);
  assert.equal(loops.length, 2);
  assert.ok(!doCross(loops));
  const specked = draw(60, 60, (x, y) => disc(30, 30, 15)(x, y) || (x < 3 && y < 3));
  assert.deepEqual(
    [outlinesOf(specked, options).loops.length, outlinesOf(specked, options).dropped],
    [1, 1],
  );
  assert.deepEqual(
    outlinesOf(
      draw(20, 20, () => false),
      options,
    ).loops,
    [],
  );
});

test("crossing sides are found, neighbours are not", () => {
  assert.ok(doCross([[0, 0, 4, 4, 4, 0, 0, 4]]));
  assert.ok(!doCross([[0, 0, 4, 0, 4, 4, 0, 4]]));
  assert.ok(
    doCross([
      [0, 0, 4, 0, 4, 4, 0, 4],
      [2, 2, 6, 2, 6, 6],
    ]),
  );
  assert.ok(
    doCross([
      [0, 0, 4, 0, 4, 4, 0, 4],
      [4, 1, 8, 1, 8, 3],
    ]),
  );
});
