// The positions of a shape, however they travel.
import assert from "node:assert/strict";
import { test } from "node:test";

import { positionsOf, verticesOf } from "../dist/positions.js";
import type { PositionOptions } from "../dist/positions.js";
import { packUint32 } from "../dist/runs.js";
import { failure } from "./support/events.js";

const none = Buffer.alloc(0);
const bytes = (array: Float32Array | Float64Array | Int16Array): Buffer =>
  Buffer.from(array.buffer);
const floats = bytes(Float32Array.of(1, 2, 3, 4));
const doubles = bytes(Float64Array.of(1, 2, 3, 4));
const integers = bytes(Int16Array.of(-32767, 0, 32767, 2));
const middle = bytes(Float64Array.of(5e6, -7));
const mesh = { vertices: 2, triangles: 1 };

type Answer = Parameters<typeof positionsOf>[0];
const answer = (fields: Partial<Answer>): Answer =>
  ({
    positions: none,
    positions64: none,
    packedPositions: none,
    origin: none,
    scale: 0,
    ...fields,
  }) as Answer;

test("positions are where they are, whatever travelled", () => {
  const cases: [PositionOptions, Partial<Answer>, number[], number[]][] = [
    [{}, { positions: floats }, [1, 2, 3, 4], [1, 2, 3, 4]],
    [
      { float64: true, relativeToOrigin: true },
      { positions64: doubles },
      [1, 2, 3, 4],
      [1, 2, 3, 4],
    ],
    [{ encoding: "float32_le" }, { packedPositions: floats }, [1, 2, 3, 4], [1, 2, 3, 4]],
    [
      { relativeToOrigin: true },
      { positions: floats, origin: middle },
      [5e6 + 1, -5, 5e6 + 3, -3],
      [1, 2, 3, 4],
    ],
    [
      { encoding: "float32_le", relativeToOrigin: true },
      { packedPositions: floats, origin: middle },
      [5e6 + 1, -5, 5e6 + 3, -3],
      [1, 2, 3, 4],
    ],
    [
      { encoding: "int16_le" },
      { packedPositions: integers, origin: middle, scale: 0.5 },
      [5e6 - 16383.5, -7, 5e6 + 16383.5, -6],
      [-32767, 0, 32767, 2],
    ],
  ];
  for (const [options, fields, positions, local] of cases) {
    const shape = positionsOf(answer(fields), options, mesh, null);
    assert.deepEqual(Array.from(shape.positions), positions);
    assert.deepEqual(Array.from(shape.local), local);
    assert.deepEqual({ ...shape }.positions, shape.positions, "a copy of the shape has them too");
    const double = options.float64 || shape.origin[0] !== 0;
    assert.ok(
      double ? shape.positions instanceof Float64Array : shape.positions instanceof Float32Array,
    );
  }
});

test("a server that has never heard of origins answers the coordinates themselves", () => {
  const shape = positionsOf(answer({ positions: floats }), { relativeToOrigin: true }, mesh, null);
  assert.deepEqual(Array.from(shape.positions), [1, 2, 3, 4]);
  assert.deepEqual(shape.origin, [0, 0]);
});

test("how far positions may be off is told", () => {
  const error = (options: PositionOptions, fields: Partial<Answer>): number =>
    positionsOf(answer(fields), options, mesh, null).positionError;
  assert.equal(error({}, { positions: floats }), 4 / 2 ** 24);
  assert.equal(
    error({ relativeToOrigin: true }, { positions: floats, origin: middle }),
    4 / 2 ** 24,
  );
  assert.equal(error({ float64: true }, { positions64: doubles }), 0);
  assert.equal(
    error({ encoding: "int16_le" }, { packedPositions: integers, origin: middle, scale: 0.5 }),
    0.25,
  );
});

test("positions that were not asked for so are refused", async () => {
  const cases: [PositionOptions, Partial<Answer>, RegExp][] = [
    [{}, { positions: floats, origin: middle }, /an origin for which it was not asked/],
    [{}, { packedPositions: floats }, /another precision or encoding/],
    [
      { encoding: "int16_le" },
      { positions: floats, origin: middle },
      /another precision or encoding/,
    ],
    [{ encoding: "int16_le" }, { packedPositions: integers, scale: 1 }, /without the origin/],
    [
      { relativeToOrigin: true },
      { positions: floats, origin: middle.subarray(8) },
      /without the origin/,
    ],
    [
      { relativeToOrigin: true },
      { positions: floats, origin: bytes(Float64Array.of(NaN, 0)) },
      /an origin.*finite/,
    ],
    [
      { encoding: "int16_le" },
      { packedPositions: integers, origin: middle, scale: NaN },
      /a scale.*finite/,
    ],
    [
      { encoding: "int16_le" },
      { packedPositions: integers.subarray(1), origin: middle },
      /cannot be read/,
    ],
    [{}, { positions: floats.subarray(8) }, /1 vertices; the mesh has 2/],
  ];
  for (const [options, fields, sentence] of cases) {
    const error = await failure(() => positionsOf(answer(fields), options, mesh, null), "INTERNAL");
    assert.match(error.message, sentence);
  }
});

test("some vertices are those that were asked for", async () => {
  const large = { vertices: 9, triangles: 8 };
  const told = (vertices: number[], options: PositionOptions) =>
    verticesOf(packUint32(vertices), options, large);
  assert.equal(told([], {}), null);
  assert.deepEqual(Array.from(told([7, 3], { vertexSubset: [7, 3] })!), [7, 3]);
  assert.deepEqual(Array.from(told([0, 1, 8], { boundaryOnly: true })!), [0, 1, 8]);
  await failure(() => told([0], {}), "INTERNAL");
  await failure(() => told([3, 7], { vertexSubset: [7, 3] }), "INTERNAL");
  await failure(() => told([], { vertexSubset: [7, 3] }), "INTERNAL");
  await failure(() => told([], { boundaryOnly: true }), "INTERNAL");
  await failure(() => told([1, 0], { boundaryOnly: true }), "INTERNAL");
  await failure(() => told([0, 9], { boundaryOnly: true }), "INTERNAL");
  const shape = positionsOf(
    answer({ positions: floats }),
    { vertexSubset: [7, 3] },
    large,
    Uint32Array.of(7, 3),
  );
  assert.deepEqual(Array.from(shape.vertices!), [7, 3]);
  await failure(
    () => positionsOf(answer({ positions: floats }), {}, large, Uint32Array.of(7)),
    "INTERNAL",
  );
});
