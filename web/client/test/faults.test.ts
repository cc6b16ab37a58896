// Faults: every reason of the interface has a name here, and those of a real server come with all
// their facts.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";

import { Client, reasons } from "@arapd/client";
import type { Reason } from "@arapd/client";

import { failure } from "./support/events.js";
import { grid } from "./support/meshes.js";
import { Server, serve } from "./support/server.js";

const timeout = 120_000;

test("every reason of the interface has a name, and no other has", () => {
  const proto = readFileSync(join(process.cwd(), "../../proto/arap/v1/errors.proto"), "utf8");
  const told = [...proto.matchAll(/ERROR_REASON_(\w+) = [1-9]/g)].map((match) => match[1]!);
  assert.deepEqual([...reasons].sort(), told.sort());
});

const square = grid(3, 3);
const nan = Float64Array.from(square.vertices);
nan[5] = Number.NaN;

// What is wrong with a mesh, and which elements the error names.
const meshes: [Reason, { vertices: ArrayLike<number>; triangles: number[] }, number[]][] = [
  ["EMPTY_MESH", { vertices: [], triangles: [] }, []],
  ["ARRAY_LENGTH", { vertices: [0, 0, 1], triangles: [0, 0, 0] }, []],
  ["NON_FINITE_COORDINATE", { vertices: nan, triangles: Array.from(square.triangles) }, [2]],
  ["INDEX_OUT_OF_RANGE", { vertices: [0, 0, 1, 0, 0, 1], triangles: [0, 1, 2, 0, 1, 7] }, [1]],
  ["REPEATED_INDEX", { vertices: [0, 0, 1, 0, 0, 1], triangles: [0, 1, 1] }, [0]],
  ["DEGENERATE_TRIANGLE", { vertices: [0, 0, 1, 0, 2, 0], triangles: [0, 1, 2] }, [0]],
  ["DUPLICATE_TRIANGLE", { vertices: [0, 0, 1, 0, 0, 1], triangles: [0, 1, 2, 1, 2, 0] }, [0, 1]],
];

test("a server names what is wrong with a mesh", { timeout }, () =>
  serve(async (client) => {
    const session = await client.createSession();
    for (const [reason, mesh, elements] of meshes) {
      const error = await failure(
        session.registerMesh({ vertices: Array.from(mesh.vertices), triangles: mesh.triangles }),
        reason,
      );
      assert.equal(error.code, "INVALID_ARGUMENT");
      assert.deepEqual(
        error.elements.slice(0, elements.length),
        elements,
        `${reason}: ${error.elements.join()}`,
      );
      assert.ok(error.message.length > 10);
      assert.match(error.requestId ?? "", /^[0-9a-f]{32}$/);
      assert.equal(error.retryAfter, undefined);
    }
    const named = session.getMesh("none", { requestId: "page-7" });
    assert.equal((await failure(named, "NOT_FOUND")).requestId, "page-7");
    const unfit = session.getMesh("none", { requestId: "no name" });
    assert.match((await failure(unfit, "NOT_FOUND")).requestId ?? "", /^[0-9a-f]{32}$/);
  }),
);

test("a server names the field, the quota and when to try again", { timeout }, () =>
  serve(
    async (client) => {
      const session = await client.createSession();
      await session.registerMesh(square, { id: "m" });
      const compile = (
        id: string,
        handles: Parameters<typeof session.compileHandles>[2],
      ): Promise<unknown> => session.compileHandles(id, "m", handles);
      const heavy = await failure(
        compile("a", [{ id: "x", vertex: 0, weight: -1 }]),
        "INVALID_OPTION",
      );
      assert.equal(heavy.field, "handles[0].weight");
      const outside = await failure(
        compile("b", [{ id: "x", position: [50, 0] }]),
        "HANDLE_OUTSIDE",
      );
      assert.equal(Number(outside.details["distance"]), 48);
      await failure(
        compile("c", [
          { id: "x", vertex: 0 },
          { id: "x", vertex: 1 },
        ]),
        "DUPLICATE_HANDLE",
      );
      await failure(compile("no such name!", []), "INVALID_NAME");
      await failure(session.deform("none", []), "NOT_FOUND");
      await compile("h", [
        { id: "x", vertex: 0 },
        { id: "y", vertex: 8 },
      ]);
      await failure(compile("h", [{ id: "z", vertex: 0 }]), "ALREADY_EXISTS");
      await failure(session.deform("h", [{ id: "x", x: 0, y: 0 }]), "TARGET_COUNT");
      await failure(session.editHandles("h", ["q"], []), "UNKNOWN_HANDLE");
      const large = await failure(session.registerMesh(grid(20, 20)), "MESH_TOO_LARGE");
      assert.equal(large.code, "RESOURCE_EXHAUSTED");
      assert.equal(large.details["quota"], "max_vertices");
      assert.equal(large.details["limit"], "300");
      assert.equal(large.retryAfter, 3_600_000);
      const tube = {
        vertices: [0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1],
        triangles: [0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2],
      };
      assert.deepEqual((await failure(client.flatten(tube), "NOT_A_DISK")).elements, [0]);
      await failure(client.flatten(tube, { seamEdges: [0, 0] }), "UNKNOWN_EDGE");
    },
    ["--store", "memory", "--max-vertices", "300"],
  ),
);

test("what cannot be sent is said on this side, with its field", { timeout }, () =>
  serve(async (client) => {
    const session = await client.createSession();
    await session.registerMesh(square, { id: "m" });
    const bad = async (what: Promise<unknown> | (() => unknown), field: string): Promise<void> => {
      assert.equal((await failure(what, "INVALID_OPTION")).field, field);
    };
    await bad(
      session.registerMesh({ vertices: [0, 0, 1, 0, 0, 1], triangles: [0, 1, -1] }),
      "mesh.triangles",
    );
    await bad(session.compileHandles("h", "m", [{ id: "x", vertex: 1.5 }]), "handles[0].vertex");
    await bad(session.compileHandles("h", "m", [{ id: "x" } as never]), "handles[0]");
    await bad(
      session.registerMesh(square, { energy: { basis: "corner" as never } }),
      "energy.basis",
    );
    await session.compileHandles("h", "m", [{ id: "x", vertex: 0 }]);
    const stream = await session.openStream("h");
    await bad(() => stream.send({ sequence: 0.5 }), "sequence");
    stream.send({ sequence: 7, targets: [{ id: "x", x: 0, y: 0 }] });
    await bad(() => stream.send({ sequence: 7 }), "sequence");
    await bad(() => stream.send({ pickPoints: [1, 2, 3] }), "pick_points");
    stream.cancel();
    await failure(stream.read(), "CANCELLED");
  }),
);

test("nobody there, too late, and given up", { timeout }, async () => {
  const server = new Server();
  const nobody = Client.connect(`unix:${server.folder}/nothing`);
  const error = await failure(nobody.getServerInfo({ retryWithin: 0 }), "DRAINING");
  assert.equal(error.code, "UNAVAILABLE");
  await failure(nobody.getServerInfo({ retryWithin: 200 }), "DRAINING");
  await failure(nobody.waitReady(50), "DEADLINE_EXCEEDED");
  const stop = new AbortController();
  const waiting = failure(
    nobody.getServerInfo({ retryWithin: 60_000, signal: stop.signal }),
    "CANCELLED",
  );
  stop.abort();
  await waiting;
  await failure(nobody.getServerInfo({ signal: stop.signal }), "CANCELLED");
  const closing = failure(nobody.getServerInfo({ retryWithin: 60_000 }), "CANCELLED");
  nobody.close();
  await closing;
  await failure(nobody.getServerInfo(), "CANCELLED");
  await failure(nobody.attachSession("s").openStream("h"), "CANCELLED");
  await failure(nobody.attachSession("s").deformTrack("h", [], []).next(), "CANCELLED");
  try {
    await server.start();
    const client = Client.connect(server.address);
    await client.getServerInfo();
    await server.freeze();
    await failure(client.getServerInfo({ timeout: 100 }), "DEADLINE_EXCEEDED");
    client.close();
  } finally {
    await server.stop();
  }
});

test("a call that was lost is made again", { timeout }, async () => {
  const server = new Server(["--store", "sqlite:{}/state"]);
  try {
    await server.start();
    const client = Client.connect(server.address);
    const session = await client.createSession();
    await session.registerMesh(square, { id: "m" });
    await server.end("SIGKILL");
    const answer = session.getMesh("m", { retryWithin: 60_000 });
    await server.start();
    assert.equal((await answer).vertexCount, 9);
    client.close();
  } finally {
    await server.stop();
  }
});
