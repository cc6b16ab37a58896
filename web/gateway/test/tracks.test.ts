// Tracks: all shapes of a motion in one answer.
import assert from "node:assert/strict";
import { test } from "node:test";
import { setTimeout as delay } from "node:timers/promises";

import { Server } from "../../client/test/support/server.js";
import { ask, hold, json, onStage, problem } from "./support/gateway.js";
import type { Json } from "./support/gateway.js";
import { frameOf } from "./support/page.js";
import { puppet } from "./support/puppet.js";

const timeout = 240_000;
const handles = ["l", "r"];
const frames = (count: number): Json[] =>
  Array.from({ length: count }, (_, i) => ({ positions: [0, 0, 8 + i / 4, i / 2] }));

async function lines(response: Response): Promise<Json[]> {
  assert.equal(response.status, 200);
  assert.match(response.headers.get("content-type") ?? "", /^application\/x-ndjson/);
  const text = await response.text();
  assert.ok(text.endsWith("\n"));
  return text
    .trimEnd()
    .split("\n")
    .map((line) => JSON.parse(line) as Json);
}

/** Frames one behind the other, as docs/web.md lays them out. */
function split(bytes: Buffer): Buffer[] {
  const parts: Buffer[] = [];
  for (let at = 0; at < bytes.length; ) {
    const each = bytes.readUInt8(at + 1) === 1 ? 4 : 8;
    const length = 16 + each * bytes.readUInt32LE(at + 8) + bytes.readUInt32LE(at + 12);
    parts.push(bytes.subarray(at, at + length));
    at += length;
  }
  return parts;
}

test("a track is the shapes of its frames, in order", { timeout }, () =>
  onStage(async ({ url, client }) => {
    const session = await puppet(url);
    const path = `${url}/v1/sessions/${session}/handle-sets/h`;
    const body = { handles, frames: frames(20), flippedIds: true, refine: 1 };
    const shapes = await lines(await ask(`${path}/track`, { body: { ...body, float64: true } }));
    assert.deepEqual(
      shapes.map(({ frame }) => frame as number),
      [...Array(20).keys()],
    );
    for (const i of [0, 7, 19]) {
      const targets = handles.map((id, k) => ({
        id,
        x: body.frames[i].positions[2 * k],
        y: body.frames[i].positions[2 * k + 1],
      }));
      const asked = { targets, refine: 1, flippedIds: true, float64: true };
      const { frame: _, ...shape } = shapes[i];
      assert.deepEqual(shape, await json(`${path}/deform`, { body: asked }));
    }

    // The columns are named: their order is the caller's.
    const swapped = {
      handles: ["r", "l"],
      frames: body.frames.map(({ positions: [a, b, c, d] }: Json) => ({ positions: [c, d, a, b] })),
      refine: 1,
      float64: true,
    };
    const again = await lines(await ask(`${path}/track`, { body: swapped }));
    assert.deepEqual(
      again.map(({ positions }) => positions),
      shapes.map(({ positions }) => positions),
    );

    for (const encoding of ["float32", "int16"] as const) {
      const headers = { accept: "application/octet-stream" };
      const answer = await ask(`${path}/track`, { body: { ...body, encoding }, headers });
      assert.equal(answer.headers.get("content-type"), "application/octet-stream");
      const parts = split(Buffer.from(await answer.arrayBuffer())).map(frameOf);
      assert.deepEqual(
        parts.map(({ sequence }) => sequence),
        [...Array(20).keys()],
      );
      for (const { sequence, encoding: one, positions, facts } of parts) {
        assert.equal(one, encoding);
        positions.forEach((value, k) =>
          assert.ok(Math.abs(value - shapes[sequence].positions[k]) <= facts.positionError + 1e-6),
        );
      }
    }
    // Nothing of it is left over.
    const info = await client.attachSession(session).get();
    assert.deepEqual(info.handleSetIds, ["h"]);
  }),
);

test("a TRACK.json of arapctl is taken as it is", { timeout }, () =>
  onStage(async ({ url }) => {
    const session = await puppet(url);
    const path = `${url}/v1/sessions/${session}/handle-sets/h/track`;
    const file = {
      mesh: "sheet.obj",
      w: 1000,
      handles: [
        { name: "r", rest: [8, 0], triangle: 3, bary: [0, 1, 0], hard: true },
        { name: "l", rest: [0, 0], vertex: 0 },
      ],
      frames: [
        { i: 0, kind: "rest", targets: [[8, 1], null] },
        {
          i: 1,
          kind: "wave",
          targets: [
            [9, 2],
            [1, 0],
          ],
        },
        { i: 2, kind: "wave", targets: [null, [2, 0]] },
      ],
      edits: [],
    };
    const plain = {
      handles: ["r", "l"],
      frames: [
        [8, 1, 0, 0],
        [9, 2, 1, 0],
        [9, 2, 2, 0],
      ].map((positions) => ({ positions })),
    };
    const more = { float64: true, refine: 1 };
    const taken = await lines(await ask(path, { body: { ...file, ...more } }));
    assert.deepEqual(taken, await lines(await ask(path, { body: { ...plain, ...more } })));

    // Angles and scales, null too: of handles that hold them.
    const turned = [
      { id: "l", vertex: 0, oriented: true },
      { id: "r", vertex: 8 },
    ];
    const sets = `${url}/v1/sessions/${session}/handle-sets`;
    await json(sets, { body: { id: "t", meshId: "m", handles: turned } }, 201);
    const at = `${sets}/t/track`;
    const [a, b, c] = file.frames;
    const angles = {
      ...file,
      frames: [{ ...a, angles: [0, 0.5] }, { ...b, angles: [0, null] }, c],
    };
    const same = plain.frames.map((frame, i) => ({ ...frame, angles: [0, i < 2 ? 0.5 : 0] }));
    assert.deepEqual(
      await lines(await ask(at, { body: { ...angles, ...more } })),
      await lines(await ask(at, { body: { ...plain, frames: same, ...more } })),
    );

    const wrong: [Json, string][] = [
      [{ ...file, edits: [{ frame: 1, remove: ["l"] }] }, "edits"],
      [{ ...file, frames: [a, { targets: [[1, 1]] }] }, "frames[1].targets"],
      [{ ...file, frames: [{ ...a, scales: [1] }] }, "frames[0].scales"],
      [{ ...file, frames: [a, { targets: [[1], null] }] }, "frames[1].targets[0]"],
      [{ ...file, handles: [{ name: "l" }] }, "handles[0].rest"],
      [{ ...file, handles: ["l", "r"] }, "handles[0]"],
    ];
    for (const [body, field] of wrong) {
      const told = (await (await ask(path, { body })).json()) as Json;
      assert.equal(told.reason, "MALFORMED", JSON.stringify(told));
      assert.equal(told.field, field, JSON.stringify(told));
    }
    const unknown = { ...file, handles: [{ name: "x", rest: [0, 0] }, file.handles[1]] };
    await problem(path, { body: unknown }, "UNKNOWN_HANDLE");
  }),
);

test("what is wrong with a track is told with its place", { timeout }, () =>
  onStage(
    async ({ url }) => {
      const session = await puppet(url, 4);
      const path = `${url}/v1/sessions/${session}/handle-sets/h/track`;
      const wrong: [Json, string, string | undefined][] = [
        [{ handles }, "MALFORMED", undefined],
        [{ handles, frames: [] }, "MALFORMED", "frames"],
        [{ handles, frames: frames(1), more: 1 }, "MALFORMED", "more"],
        [{ handles: ["l"], frames: [{ positions: [0, 0] }] }, "TARGET_COUNT", undefined],
        [{ handles: ["l", "x"], frames: frames(1) }, "UNKNOWN_HANDLE", undefined],
        [
          { handles, frames: [...frames(1), { positions: [0, 0, 1] }] },
          "ARRAY_LENGTH",
          "frames[1].positions",
        ],
        [{ handles, frames: frames(9) }, "INVALID_OPTION", "frames"],
      ];
      for (const [body, reason, field] of wrong) {
        const response = await ask(path, { body });
        const told = (await response.json()) as Json;
        assert.equal(told.reason, reason, JSON.stringify(told));
        if (field !== undefined) assert.equal(told.field, field, JSON.stringify(told));
      }
      const body = { handles, frames: frames(1) };
      await problem(path, { body, headers: { accept: "image/png" } }, "NOT_ACCEPTABLE");
      const binary = { accept: "application/octet-stream" };
      await problem(path, { body: { ...body, float64: true }, headers: binary }, "MALFORMED");
      await problem(path.replace("/h/", "/none/"), { body }, "NOT_FOUND");
      await problem(path.replace(session, "none"), { body }, "NOT_FOUND");
    },
    {},
    ["--store", "memory", "--max-track-frames", "8"],
  ),
);

test(
  "hard handles that contradict each other in a later frame end it with a problem",
  { timeout },
  () =>
    onStage(async ({ url }) => {
      const session = await puppet(url, 4);
      const at = `${url}/v1/sessions/${session}`;
      const same = ["a", "b"].map((id) => ({ id, vertex: 5, hard: true }));
      await json(`${at}/handle-sets`, { body: { id: "g", meshId: "m", handles: same } }, 201);
      const body = {
        handles: ["a", "b"],
        frames: [
          { positions: [1, 1, 1, 1] },
          { positions: [2, 1, 2, 1] },
          { positions: [1, 1, 3, 3] },
        ],
      };
      const path = `${at}/handle-sets/g/track`;
      const told = await lines(await ask(path, { body }));
      assert.deepEqual(
        told.map(({ frame }) => frame as number),
        [0, 1, 2],
      );
      assert.equal(told[2].problem.reason, "CONFLICTING_HANDLES");
      assert.ok(told[2].problem.requestId);
      const answer = await ask(path, { body, headers: { accept: "application/octet-stream" } });
      const parts = split(Buffer.from(await answer.arrayBuffer())).map(frameOf);
      assert.equal(parts.length, 3);
      assert.equal(parts[2]!.local.length, 0);
      assert.equal(parts[2]!.facts.problem.reason, "CONFLICTING_HANDLES");
    }),
);

test("who leaves in the middle holds nothing", { timeout }, async () => {
  const server = new Server(["--store", "memory", "--admin", "127.0.0.1:0"]);
  try {
    await server.start();
    const options = { arapd: server.address, arapdAdmin: `http://${server.admin}` };
    await hold({ ...options, maxRequestsPerMinute: 1e6 }, async (url) => {
      const session = await puppet(url, 30);
      const streams = async (): Promise<number> =>
        ((await json(`${url}/v1/load`)) as Json).server.streams;
      const until = async (isSo: (count: number) => boolean): Promise<void> => {
        for (const limit = Date.now() + 60_000; !isSo(await streams()); ) {
          assert.ok(Date.now() < limit, "the track goes on");
          await delay(50);
        }
      };
      const controller = new AbortController();
      // Far more than the network takes without being read.
      const body = { handles, frames: frames(4000) };
      const path = `${url}/v1/sessions/${session}/handle-sets/h/track`;
      const response = await ask(path, { body, signal: controller.signal });
      const reader = response.body!.getReader();
      assert.ok(((await reader.read()).value?.length ?? 0) > 0);
      await until((count) => count === 1);
      controller.abort();
      await until((count) => count === 0);
    });
  } finally {
    await server.stop();
  }
});
