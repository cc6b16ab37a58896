// Positions in every encoding, and of some vertices, from the real server.
import assert from "node:assert/strict";
import { test } from "node:test";

import type { Client, PositionOptions, Session, Shape } from "@arapd/client";

import { failure, nextShape } from "./support/events.js";
import { grid } from "./support/meshes.js";
import { serve } from "./support/server.js";

const timeout = 120_000;
// Where 32-bit floats are half a unit apart.
const far = 5_400_000;
const side = 9;

async function puppet(client: Client): Promise<Session> {
  const session = await client.createSession();
  const mesh = grid(side, side);
  await session.registerMesh(
    { ...mesh, vertices: mesh.vertices.map((coordinate) => coordinate + far) },
    { id: "m" },
  );
  await session.compileHandles("h", "m", [
    { id: "l", vertex: 0 },
    { id: "r", vertex: side - 1 },
  ]);
  return session;
}
const targets = [
  { id: "l", x: far, y: far },
  { id: "r", x: far + 8.25, y: far + 2.5 },
];

// How far positions may be from the exact ones.
const encodings: [string, PositionOptions, number][] = [
  ["relative floats", { relativeToOrigin: true }, 1e-6],
  ["relative floats as bytes", { relativeToOrigin: true, encoding: "float32_le" }, 1e-6],
  ["integers", { encoding: "int16_le" }, 12 / 65534],
  ["floats as bytes", { encoding: "float32_le" }, 0.5],
  ["floats", { encoding: "float32" }, 0.5],
];

function farthest(shape: Shape, exact: ArrayLike<number>): number {
  assert.equal(shape.positions.length, exact.length);
  return Math.max(
    ...Array.from(shape.positions, (coordinate, i) => Math.abs(coordinate - exact[i]!)),
  );
}

test("far from 0 positions are where they are in every encoding", { timeout }, () =>
  serve(async (client) => {
    const session = await puppet(client);
    const exact = await session.deform("h", targets, { float64: true });
    for (const [name, options, error] of encodings) {
      const shapes = [await session.deform("h", targets, options)];
      const frame = { positions: targets.flatMap(({ x, y }) => [x, y]) };
      for await (const shape of session.deformTrack("h", ["l", "r"], [frame, frame], options))
        shapes.push(shape);
      const stream = await session.openStream("h", options);
      stream.send({ targets });
      shapes.push(await nextShape(stream));
      stream.cancel();
      assert.equal(shapes.length, 4);
      for (const shape of shapes) {
        assert.ok(shape.positionError <= error, `${name}: ${shape.positionError}`);
        assert.ok(farthest(shape, exact.positions) <= shape.positionError, name);
      }
    }
  }),
);

test("some vertices, in the order that was asked for, or those of the boundary", { timeout }, () =>
  serve(async (client) => {
    const session = await puppet(client);
    const { positions } = await session.deform("h", targets, { float64: true });
    const boundary = Array.from({ length: side * side }, (_, vertex) => vertex).filter(
      (v) => [0, side - 1].includes(v % side) || [0, side - 1].includes(Math.floor(v / side)),
    );
    const parts: [PositionOptions, number[]][] = [
      [{ vertexSubset: [70, 3, 40] }, [70, 3, 40]],
      [{ boundaryOnly: true }, boundary],
    ];
    for (const [options, vertices] of parts) {
      const expected = vertices.flatMap((v) => [positions[2 * v]!, positions[2 * v + 1]!]);
      const stream = await session.openStream("h", { ...options, float64: true });
      assert.deepEqual(Array.from(stream.vertices!), vertices);
      stream.send({ targets });
      const streamed = await nextShape(stream);
      stream.cancel();
      const frame = { positions: targets.flatMap(({ x, y }) => [x, y]) };
      const tracked: Shape[] = [];
      const track = session.deformTrack("h", ["l", "r"], [frame, frame], {
        ...options,
        float64: true,
      });
      for await (const shape of track) tracked.push(shape);
      const whole = await session.deform("h", targets, { ...options, float64: true });
      for (const shape of [streamed, ...tracked, whole]) {
        assert.deepEqual(Array.from(shape.vertices!), vertices);
        assert.deepEqual(Array.from(shape.positions), expected);
      }
    }
    await failure(session.deform("h", targets, { vertexSubset: [81] }), "INDEX_OUT_OF_RANGE");
    await failure(
      session.deform("h", targets, { encoding: "int16_le", float64: true }),
      "INVALID_OPTION",
    );
  }),
);
