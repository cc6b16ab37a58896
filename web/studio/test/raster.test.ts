// Triangles as pixels, drawn by the page itself.
import assert from "node:assert/strict";
import { test } from "node:test";

import { Raster, packed } from "../src/view/raster.js";
import type { Image } from "../src/view/raster.js";

// A picture whose pixels all differ, with all kinds of alpha.
function picture(width: number, height: number, alpha: (i: number) => number): Image {
  const pixels = Uint32Array.from({ length: width * height }, (_, i) => {
    const a = alpha(i);
    const part = (value: number): number => Math.floor((((value * 37) % 256) * a) / 255);
    return packed(part(i), part(i + 5), part(3 * i), a);
  });
  return { width, height, pixels };
}

const square = (size: number): number[] => [0, 0, size, 0, size, size, 0, size];
const halves = [0, 1, 2, 0, 2, 3];

test("a picture that lies where it was is the picture", () => {
  const image = picture(16, 16, (i) => (i % 5 === 0 ? 0 : i % 3 === 0 ? 128 : 255));
  const raster = new Raster(16, 16);
  raster.textured(halves, square(16), square(16), image, null);
  assert.deepEqual(raster.pixels, image.pixels);
  assert.deepEqual(raster.box, [0, 0, 16, 16]);
  raster.clear();
  assert.deepEqual(raster.box, [0, 0, 0, 0]);
});

test("neighbours leave no gap and cover no pixel twice, wherever their corners are", () => {
  // A grid of crooked triangles that fills the whole square, painted half transparent.
  const cells = 9;
  const size = 64;
  let seed = 1;
  const chance = (): number => (seed = (seed * 48271) % 2147483647) / 2147483647;
  const places: number[] = [];
  for (let j = 0; j <= cells; ++j) {
    for (let i = 0; i <= cells; ++i) {
      const inside = (k: number): number => (k > 0 && k < cells ? chance() - 0.5 : 0);
      const step = size / cells;
      places.push((i + 0.6 * inside(i)) * step, (j + 0.6 * inside(j)) * step);
    }
  }
  const corners: number[] = [];
  for (let j = 0; j < cells; ++j) {
    for (let i = 0; i < cells; ++i) {
      const a = j * (cells + 1) + i;
      // Whichever way round a triangle is, and whichever corner comes first.
      corners.push(a, a + 1, a + cells + 2, a + cells + 2, a, a + cells + 1);
    }
  }
  const grey = packed(100, 60, 20, 128);
  const image: Image = { width: 4, height: 4, pixels: new Uint32Array(16).fill(grey) };
  const raster = new Raster(size, size);
  raster.textured(
    corners,
    places,
    places.map((value) => value / 16),
    image,
    null,
  );
  assert.ok(raster.pixels.every((pixel) => pixel === grey));
});

test("colours of triangles, tints and strength", () => {
  const red = packed(255, 0, 0);
  const raster = new Raster(8, 8);
  raster.flat(halves, square(8), [red, packed(0, 0, 255)]);
  assert.equal(raster.pixels[6], red);
  assert.equal(raster.pixels[6 * 8], packed(0, 0, 255));
  const clear: Image = { width: 2, height: 2, pixels: new Uint32Array(4) };
  // Nothing but the tint, also where the picture is transparent; half of it shows what is below.
  const tone = { tint: [0, 255, 0] as const, part: 2, strength: 0.5 };
  raster.textured(halves, square(8), square(2), clear, { ...tone, strength: 1 });
  assert.ok(raster.pixels.every((pixel) => pixel === packed(0, 255, 0)));
  raster.flat(halves, square(8), [red, red]);
  raster.textured(halves, square(8), square(2), clear, tone);
  const [r, g, b, a] = raster.bytes;
  assert.ok(Math.abs(r - 128) <= 2 && Math.abs(g - 128) <= 2 && b === 0 && a === 255);
  // A tint in part keeps the rest of the picture's colour.
  const white: Image = { width: 2, height: 2, pixels: new Uint32Array(4).fill(0xffffffff) };
  raster.textured(halves, square(8), square(2), white, { ...tone, part: 0.25, strength: 1 });
  assert.deepEqual([...raster.bytes.slice(0, 4)], [191, 255, 191, 255]);
});

test("what is outside is left out, lines too, and half transparent colours leave as a canvas takes them", () => {
  const raster = new Raster(8, 8);
  const far = [-1e6, -50, 1e6, -40, 3, 1e5];
  raster.flat([0, 1, 2], far, [packed(9, 9, 9)]);
  raster.flat([0, 1, 2], [NaN, 0, 8, 8, 0, 8], [packed(9, 9, 9)]);
  raster.lines([0, 1, 1, 2], far, packed(64, 64, 64, 128));
  assert.deepEqual(raster.box, [0, 0, 8, 8]);
  raster.clear();
  raster.lines([0, 1], [0, 4.5, 8, 4.5], packed(64, 32, 0, 128));
  raster.finish();
  assert.deepEqual([...raster.bytes.slice(4 * 33, 4 * 34)], [128, 64, 0, 128]);
  assert.equal(raster.pixels.filter((pixel) => pixel !== 0).length, 8);
});
