// Streams that say nothing for long, and readers who are slow.
import assert from "node:assert/strict";
import { test } from "node:test";

import { failure, nextShape } from "./support/events.js";
import { grid } from "./support/meshes.js";
import { serve } from "./support/server.js";

const timeout = 120_000;

test("a heartbeat keeps an idle stream", { timeout }, () =>
  serve(
    async (client) => {
      const session = await client.createSession();
      await session.registerMesh(grid(9, 9), { id: "m" });
      await session.compileHandles("h", "m", [{ id: "r", vertex: 8 }]);
      const alive = await session.openStream("h", { heartbeat: 100 });
      const shape = nextShape(alive);
      // Two of these one after the other take longer than a stream may say nothing.
      for (let round = 0; round < 2; round++) {
        const quiet = await session.openStream("h", { heartbeat: 0 });
        await failure(quiet.read(), "STREAM_IDLE");
      }
      alive.send({ targets: [{ id: "r", x: 8, y: 3 }] });
      assert.equal((await shape).sequence, 1, "and no pong came before");
      alive.cancel();
    },
    ["--store", "memory", "--max-stream-idle-seconds", "2"],
  ),
);

test("every update of a latest stream is answered, or replaced and counted", { timeout }, () =>
  serve(async (client) => {
    const session = await client.createSession();
    // A shape of 320 kB, of which the window of HTTP/2 holds a part.
    await session.registerMesh(grid(200, 200), { id: "m" });
    await session.compileHandles("h", "m", [
      { id: "l", vertex: 0 },
      { id: "r", vertex: 199 },
    ]);
    const stream = await session.openStream("h");
    // The first is read, so that others are computed; nobody reads while those are sent.
    for (let i = 0; i < 40; i++) {
      const sequence = stream.send({ targets: [{ id: "r", x: 199, y: i }] });
      if (i % 10 === 0) await client.getServerInfo();
      assert.equal(sequence, i + 1);
    }
    let shapes = 0;
    let replaced = 0;
    for (let last = 0; last < 40; shapes++) {
      const shape = await nextShape(stream);
      assert.ok(shape.sequence > last);
      last = shape.sequence;
      replaced += shape.replaced;
    }
    assert.equal(shapes + replaced, 40, "each was answered, or replaced and counted");
    stream.closeSending();
    assert.equal(await stream.read(), undefined);
  }),
);
