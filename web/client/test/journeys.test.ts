// What an application does, against the real server.
import assert from "node:assert/strict";
import { test } from "node:test";

import { Client, hasEnded } from "@arapd/client";
import type { FlatSurface, FlattenJob, FlattenOptions, Session } from "@arapd/client";

import { failure, next, nextShape } from "./support/events.js";
import { farthest, grid } from "./support/meshes.js";
import { serve } from "./support/server.js";

const timeout = 120_000;

async function puppet(client: Client, size = 9): Promise<Session> {
  const session = await client.createSession();
  await session.registerMesh(grid(size, size), { id: "m" });
  await session.compileHandles("h", "m", [
    { id: "l", vertex: 0 },
    { id: "r", triangle: 2 * (size - 2), barycentric: [0, 1, 0] },
    { id: "top", position: [size / 2, size - 1] },
  ]);
  return session;
}

test("the server tells what it is", { timeout }, () =>
  serve(async (client) => {
    await client.waitReady(60_000);
    const info = await client.getServerInfo();
    assert.match(info.version, /^\d+\.\d+\.\d+/);
    assert.equal(info.limits.maxVertices, 1_000_000);
    assert.equal(info.limits.maxTtl, 24 * 3600 * 1000);
    assert.ok(info.workers >= 1);
    assert.ok(info.capabilities.includes("basis.edge"));
  }),
);

test("sessions are made, listed, looked at and ended", { timeout }, () =>
  serve(async (client) => {
    const session = await client.createSession({
      id: "mine",
      ttl: 90_500,
      labels: { app: "test" },
    });
    await session.registerMesh(grid(3, 3), { id: "m" });
    const info = await session.get();
    assert.equal(info.ttl, 90_500);
    assert.deepEqual(info.labels, { app: "test" });
    assert.deepEqual(info.meshIds, ["m"]);
    assert.ok(Math.abs(info.expireTime.getTime() - info.createTime.getTime() - 90_500) < 60_000);
    await client.createSession();
    const page = await client.listSessions(1);
    assert.equal(page.sessions.length, 1);
    const rest = await client.listSessions(10, page.nextPageToken);
    assert.equal(rest.sessions.length, 1);
    assert.equal(rest.nextPageToken, "");
    await client.attachSession("mine").delete();
    await failure(session.get(), "NOT_FOUND");
  }),
);

test("a mesh is registered once, and handles compiled and edited", { timeout }, () =>
  serve(async (client) => {
    const session = await puppet(client);
    const again = await session.registerMesh(grid(9, 9), { id: "other" });
    assert.equal(again.shared, true);
    assert.equal(again.mesh.vertexCount, 81);
    assert.equal((await session.getMesh("m")).contentHash, again.mesh.contentHash);
    const set = await session.getHandleSet("h");
    assert.deepEqual(
      set.handles.map((handle) => handle.id),
      ["l", "r", "top"],
    );
    assert.deepEqual(set.handles[2]?.rest, [4.5, 8]);
    const edited = await session.editHandles("h", ["top"], [{ id: "mid", vertex: 40, depth: 2 }]);
    assert.deepEqual(
      edited.handleSet.handles.map((handle) => handle.id),
      ["l", "r", "mid"],
    );
    assert.equal(edited.handleSet.depth.length, 81);
    assert.equal(edited.handleSet.drawOrder.length, 128);
    await session.deleteHandleSet("h");
    await failure(session.getHandleSet("h"), "NOT_FOUND");
    await session.deleteMesh("m");
    await failure(session.getMesh("m"), "NOT_FOUND");
  }),
);

test(
  "a rigid motion comes back rigid, in either precision, and points are picked",
  { timeout },
  () =>
    serve(async (client) => {
      const session = await puppet(client);
      const mesh = grid(9, 9);
      const turn = (x: number, y: number): { x: number; y: number } => ({ x: 3 - y, y: 5 + x });
      const targets = [
        { id: "l", ...turn(0, 0) },
        { id: "r", ...turn(8, 0) },
        { id: "top", ...turn(4.5, 8) },
      ];
      const expected = Array.from(mesh.vertices);
      for (let i = 0; i < expected.length; i += 2) {
        const { x, y } = turn(mesh.vertices[i]!, mesh.vertices[i + 1]!);
        expected[i] = x;
        expected[i + 1] = y;
      }
      const { x, y } = turn(2.25, 3.5);
      const shape = await session.deform("h", targets, { pickPoints: [x, y, 100, 100] });
      assert.ok(shape.positions instanceof Float32Array);
      assert.ok(farthest(shape.positions, expected) < 1e-5);
      assert.equal(shape.flippedCount, 0);
      assert.ok(Math.hypot(shape.picks[0]!.rest[0] - 2.25, shape.picks[0]!.rest[1] - 3.5) < 1e-5);
      assert.equal(shape.picks[1], null);
      const exact = await session.deform("h", targets, {
        float64: true,
        mode: "rigid",
        refine: 2,
        flippedIds: true,
      });
      assert.ok(exact.positions instanceof Float64Array);
      assert.ok(farthest(exact.positions, expected) < 1e-9);
      assert.equal(exact.flippedIds.length, 0);
    }),
);

test("a track gives its frames in order, and may be left", { timeout }, () =>
  serve(async (client) => {
    const session = await puppet(client);
    const frames = Array.from({ length: 20 }, (_, i) => ({ positions: [0, 0, 8, i / 10, 4.5, 8] }));
    let count = 0;
    for await (const shape of session.deformTrack("h", ["l", "r", "top"], frames)) {
      assert.equal(shape.sequence, count++);
      assert.equal(shape.positions.length, 162);
    }
    assert.equal(count, 20);
    for await (const shape of session.deformTrack("h", ["l", "r", "top"], frames))
      if (shape.sequence === 3) break;
    const bad = session.deformTrack(
      "h",
      ["l", "r", "top"],
      [{ positions: [0, 0, 8, Number.NaN, 4.5, 8] }],
    );
    assert.match((await failure(bad.next(), "NON_FINITE_TARGET")).message, /frames\[0\]/);
  }),
);

test("shapes are measured as often as that is asked", { timeout }, () =>
  serve(async (client) => {
    const session = await puppet(client);
    const targets = [
      { id: "l", x: 0, y: 0 },
      { id: "r", x: 12, y: 0 },
      { id: "top", x: 4, y: 9 },
    ];
    const measured = await session.deform("h", targets, { float64: true });
    const shape = await session.deform("h", targets, { float64: true, measureEvery: 0 });
    assert.deepEqual([measured.measured, shape.measured], [true, false]);
    assert.deepEqual(shape.positions, measured.positions);
    assert.equal(shape.worstHandleError, measured.worstHandleError);
    assert.ok(measured.energy > 0 && measured.maxStretch > 1);
    const frames = Array.from({ length: 5 }, () => ({ positions: [0, 0, 12, 0, 4, 9] }));
    const marks: boolean[] = [];
    for await (const frame of session.deformTrack("h", ["l", "r", "top"], frames, {
      measureEvery: 3,
    }))
      marks.push(frame.measured);
    assert.deepEqual(marks, [true, false, false, true, false]);
    const stream = await session.openStream("h", { measureEvery: 0 });
    stream.send({ targets });
    assert.equal((await nextShape(stream)).measured, false);
    stream.edit({ add: [{ id: "mid", vertex: 40 }] });
    assert.equal((await nextShape(stream)).measured, true);
    stream.send({ targets });
    assert.equal((await nextShape(stream)).measured, false);
    stream.send({ measure: true });
    const rest = await nextShape(stream);
    assert.ok(rest.measured && rest.energy > 0);
    stream.cancel();
  }),
);

test("a stream moves, edits, picks, pings and ends", { timeout }, () =>
  serve(async (client) => {
    const session = await puppet(client);
    const stream = await session.openStream("h", { float64: true });
    assert.equal(stream.handleSet.handles.length, 3);
    stream.send({ targets: [{ id: "r", x: 9, y: 2 }] });
    const first = await nextShape(stream);
    assert.equal(first.sequence, 1);
    assert.ok(Math.abs(first.positions[16]! - 9) < 1e-4);
    stream.send({ positions: Float64Array.of(0, 0, 9, 3, 4.5, 8), pickPoints: [0, 0] });
    const second = await nextShape(stream);
    assert.equal(second.picks.length, 1);
    assert.equal(stream.edit({ remove: ["top"], add: [{ id: "mid", vertex: 40 }] }), 3);
    const edited = await nextShape(stream);
    assert.equal(edited.sequence, 3);
    assert.equal(edited.handleSetRevision, first.handleSetRevision + 1);
    stream.ping(77);
    assert.equal((await next(stream, "pong")).nonce, 77);
    // A bad update is answered by an error of its own, and the stream goes on.
    assert.equal(stream.send({ sequence: 10, targets: [{ id: "nobody", x: 0, y: 0 }] }), 10);
    const bad = await next(stream, "error");
    assert.equal(bad.sequence, 10);
    assert.equal(bad.error.reason, "UNKNOWN_HANDLE");
    stream.send({ targets: [{ id: "mid", x: 4, y: 5 }] });
    assert.equal((await nextShape(stream)).sequence, 11);
    stream.closeSending();
    assert.equal(await stream.read(), undefined);
    assert.equal(await stream.read(), undefined);
    await failure(() => stream.send({}), "PROTOCOL");
  }),
);

test(
  "every update is answered where that is asked, and for await ends with the stream",
  { timeout },
  () =>
    serve(async (client) => {
      const session = await puppet(client);
      const stream = await session.openStream("h", { delivery: "every" });
      const sending = (async () => {
        for (let i = 1; i <= 50; i++) {
          stream.send({ targets: [{ id: "r", x: 8, y: i / 50 }] });
          await stream.drained();
        }
        stream.closeSending();
      })();
      const sequences: number[] = [];
      for await (const event of stream)
        if (event.kind === "shape") sequences.push(event.shape.sequence);
      await sending;
      assert.deepEqual(
        sequences,
        Array.from({ length: 50 }, (_, i) => i + 1),
      );
    }),
);

test("outlines become a mesh that can be registered", { timeout }, () =>
  serve(async (client) => {
    const outline = await client.meshOutline(
      [
        [0, 0, 10, 0, 10, 10, 0, 10],
        [4, 4, 6, 4, 6, 6, 4, 6],
      ],
      200,
    );
    assert.equal(outline.pieceCount, 1);
    assert.equal(outline.holeCount, 1);
    const session = await client.createSession();
    const registered = await session.registerMesh(outline.mesh);
    assert.ok(Math.abs(registered.mesh.area - 96) < 1e-9);
    assert.equal(outline.outlineError, 0);
    // The hole closes.
    const grown = await client.meshOutline(
      [
        [0, 0, 10, 0, 10, 10, 0, 10],
        [4, 4, 6, 4, 6, 6, 4, 6],
      ],
      { vertices: 100, tolerance: 0.1, expansion: 1.5 },
    );
    assert.equal(grown.holeCount, 0);
    assert.ok(grown.outlineError > 0 && grown.outlineError < 0.2);
    assert.ok(Math.abs(Math.min(...grown.mesh.vertices) + 1.5) < 0.2);
  }),
);

test("a curved sheet is laid flat, at once and as a job", { timeout }, () =>
  serve(async (client) => {
    // A quarter of a tube of radius 20 that is 10 wide: true size flat, 10π long.
    const n = 33;
    const sheet = grid(n, 5, () => 0);
    for (let i = 0; i < n * 5; i++) {
      const angle = ((Math.PI / 2) * (i % n)) / (n - 1);
      sheet.vertices.set(
        [20 * Math.sin(angle), 2.5 * Math.floor(i / n), 20 * Math.cos(angle)],
        3 * i,
      );
    }
    const options = {
      method: "arap_face",
      singularValues: true,
      firstStep: true,
      float64: true,
    } as const;
    const flat = await client.flatten(sheet, options);
    const us = flat.uv.filter((_, i) => i % 2 === 0);
    assert.ok(Math.abs(Math.max(...us) - Math.min(...us) - 10 * Math.PI) < 0.01);
    assert.ok(flat.distortion.maxStretchPercent < 0.01);
    assert.equal(flat.charts.length, 1);
    assert.equal(flat.charts[0]!.refineEnd, "converged");
    assert.equal(flat.singularValues.length, 2 * 256);

    const session = await client.createSession();
    await session.submitFlatten("job", sheet, options);
    const seen: FlattenJob[] = [];
    const ended = await session.watchJob("job", (job) => seen.push(job));
    assert.equal(ended.state, "done");
    assert.ok(seen.length >= 1 && hasEnded(seen.at(-1)!));
    const result = await session.getResult("job", sheet, options);
    assert.deepEqual(result.uv, flat.uv);
    assert.deepEqual(result.cornerUv, flat.cornerUv);
    assert.equal((await session.cancelJob("job")).state, "done");
    await failure(session.submitFlatten("job", sheet, { injective: true }), "ALREADY_EXISTS");
  }),
);

test("a layout is drawn at true size, at once and as a job", { timeout }, () =>
  serve(async (client) => {
    const strip = grid(5, 3, () => 0);
    const options: FlattenOptions = {
      drawings: [
        { format: "svg", millimetresPerUnit: 10, allowance: 5, corners: "round" },
        { format: "dxf" },
        { format: "pdf", paper: "A4" },
        { format: "svg", paper: "A5", millimetresPerUnit: 100 },
      ],
      parts: [{ firstTriangle: 0, name: "sleeve" }],
    };
    const check = ({ drawings }: FlatSurface): void => {
      const begins = drawings.map(({ files }) => Buffer.from(files[0]!.data).toString("latin1"));
      assert.match(begins[0]!, /<svg[^]*sleeve/);
      assert.match(begins[1]!, /SECTION[^]*ENTITIES/);
      assert.match(begins[2]!, /^%PDF-/);
      assert.equal(drawings[3]!.files[0]!.page, "cover");
      assert.ok(drawings[3]!.files.length > 2);
    };
    check(await client.flatten(strip, options));
    const session = await client.createSession();
    await session.submitFlatten("drawn", strip, options);
    await session.watchJob("drawn");
    check(await session.getResult("drawn", strip, options));
    const wide = client.flatten(strip, {
      drawings: [{ format: "svg" }, { format: "svg", allowance: -1 }],
    });
    assert.equal((await failure(wide, "INVALID_OPTION")).field, "drawings[1].allowance");
  }),
);

test("answers larger than the 4 MB of gRPC arrive", { timeout: 300_000 }, () =>
  serve(async (client) => {
    const sheet = grid(300, 300, (x, y) => Math.sin(x / 30) + Math.cos(y / 40));
    const flat = await client.flatten(sheet, {
      method: "lscm",
      float64: true,
      singularValues: true,
      firstStep: true,
    });
    const bytes = flat.uv.byteLength + flat.firstStepUv.byteLength + flat.singularValues.byteLength;
    assert.ok(bytes > 4 << 20, `${bytes} bytes`);
  }),
);

test("a port of TCP will do as well as a socket", { timeout }, () =>
  serve(
    async (client) => {
      await (
        await puppet(client)
      ).deform("h", [
        { id: "l", x: 0, y: 0 },
        { id: "r", x: 8, y: 0 },
        { id: "top", x: 4, y: 9 },
      ]);
    },
    ["--store", "memory"],
    "127.0.0.1:0",
  ),
);
