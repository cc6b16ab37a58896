// Streams that outlive their server: killed, drained and frozen under a running drag.
import assert from "node:assert/strict";
import { test } from "node:test";
import { setTimeout as sleep } from "node:timers/promises";

import { Client } from "@arapd/client";
import type { DeformStream, Session, StreamOptions } from "@arapd/client";

import { failure, next, nextShape } from "./support/events.js";
import { grid } from "./support/meshes.js";
import { Server } from "./support/server.js";

const rounds = Number(process.env["ARAP_WEB_ROUNDS"] ?? 3);
const timeout = 120_000 + rounds * 30_000;
const deliveries = ["latest", "every"] as const;

interface Stage {
  server: Server;
  client: Client;
  session: Session;
}

async function onStage(
  use: (stage: Stage) => Promise<void>,
  flags: readonly string[] = [],
  listen?: string,
): Promise<void> {
  const server = new Server(["--store", "sqlite:{}/state", ...flags], listen);
  let client: Client | undefined;
  try {
    await server.start();
    client = Client.connect(server.address);
    const session = await client.createSession();
    await session.registerMesh(grid(9, 9), { id: "m" });
    await session.compileHandles("h", "m", [
      { id: "l", vertex: 0 },
      { id: "r", vertex: 8 },
    ]);
    await use({ server, client, session });
  } finally {
    client?.close();
    await server.stop();
  }
}

// Two updates with an edit of the stream's own between them: what it adds starts where the first
// has brought it.
async function begin(stream: DeformStream): Promise<void> {
  stream.send({ targets: [{ id: "r", x: 8, y: 3 }] });
  assert.equal((await nextShape(stream)).sequence, 1);
  stream.edit({ add: [{ id: "t", vertex: 76 }] });
  assert.equal((await nextShape(stream)).sequence, 2);
  stream.send({ targets: [{ id: "l", x: -1, y: 0 }] });
  assert.equal((await nextShape(stream)).sequence, 3);
}
const last = { targets: [{ id: "r", x: 9, y: 1 }] };

/** The last shape of a stream that nothing happens to. */
async function undisturbed(
  session: Session,
): Promise<{ positions: ArrayLike<number>; revision: number }> {
  const stream = await session.openStream("h", { float64: true });
  await begin(stream);
  stream.send(last);
  const shape = await nextShape(stream);
  stream.cancel();
  return { positions: shape.positions, revision: shape.handleSetRevision };
}

/**
 * Drags "r" until `harm` is over and a little longer, then to its last place. Counts what was sent
 * and what came, and answers the last shape.
 */
async function drag(stream: DeformStream, harm: () => Promise<void>) {
  let sent = 0;
  let shapes = 0;
  let resumed = 0;
  let over = false;
  let final = 0;
  const sending = (async () => {
    const move = (): void => {
      const angle = sent++ / 10;
      stream.send({ targets: [{ id: "r", x: 8 + Math.cos(angle), y: Math.sin(angle) }] });
    };
    const step = async (): Promise<void> => {
      move();
      await sleep(4);
    };
    for (let i = 0; i < 10; i++) await step();
    const harming = harm().finally(() => (over = true));
    while (!over) await step();
    await harming;
    for (let i = 0; i < 10; i++) await step();
    sent++;
    final = stream.send(last);
    stream.closeSending();
  })();
  const stopped = sending.then(
    () => undefined,
    (error: unknown) => (stream.cancel(), Promise.reject(error)),
  );
  let shape;
  for await (const event of stream) {
    assert.notEqual(event.kind, "error");
    if (event.kind === "resumed") resumed++;
    if (event.kind !== "shape") continue;
    shapes++;
    shape = event.shape;
  }
  await stopped;
  assert.ok(
    shape && shape.sequence === final,
    `the last shape answers ${shape?.sequence}, not ${final}`,
  );
  return { shape, sent, shapes, resumed };
}

const harms: Record<string, { options: StreamOptions; harm: (server: Server) => Promise<void> }> = {
  killed: {
    options: {},
    harm: async (server) => {
      await server.end("SIGKILL");
      await server.start();
    },
  },
  drained: {
    options: {},
    harm: async (server) => {
      await server.end("SIGTERM");
      await server.start();
    },
  },
  frozen: {
    options: { heartbeat: 50, silence: 250 },
    harm: async (server) => {
      await server.freeze();
      // The stream's own clock runs in this process: by then it has noticed, and tried again.
      await sleep(750);
      server.signal("SIGCONT");
    },
  },
};

for (const [name, { options, harm }] of Object.entries(harms)) {
  for (const delivery of deliveries) {
    test(`a server is ${name} ${rounds} times under a drag ("${delivery}")`, { timeout }, (t) =>
      onStage(async ({ server, session }) => {
        const expected = await undisturbed(session);
        const total = { sent: 0, shapes: 0, resumed: 0 };
        for (let round = 0; round < rounds; round++) {
          const stream = await session.openStream("h", {
            ...options,
            delivery,
            float64: true,
            resumeWithin: 60_000,
          });
          await begin(stream);
          const { shape, sent, shapes, resumed } = await drag(stream, () => harm(server));
          assert.deepEqual(shape.positions, expected.positions);
          assert.equal(shape.handleSetRevision, expected.revision);
          assert.ok(resumed >= 1, "the stream was never lost");
          if (delivery === "every") assert.equal(shapes, sent);
          total.sent += sent;
          total.shapes += shapes;
          total.resumed += resumed;
        }
        const lost = total.sent - total.shapes;
        t.diagnostic(
          `${total.sent} updates sent, ${lost} without a frame of their own, ${total.resumed} resumed`,
        );
      }),
    );
  }
}

test("what was on its way is said again, pings too", { timeout }, () =>
  onStage(async ({ server, session }) => {
    const expected = await undisturbed(session);
    const stream = await session.openStream("h", { float64: true, resumeWithin: 60_000 });
    await begin(stream);
    await server.end("SIGKILL");
    // Into the void: nobody has noticed yet.
    stream.send(last);
    stream.ping(77);
    await server.start();
    const resumed = await next(stream, "resumed");
    assert.equal(resumed.handleSet.handles.length, 2, "before the stream's own edit");
    assert.equal(resumed.unanswered, 1);
    const events = [await stream.read(), await stream.read()];
    assert.ok(events.some((event) => event?.kind === "pong" && event.nonce === 77));
    const shape = events.find((event) => event?.kind === "shape");
    assert.deepEqual(shape?.kind === "shape" && shape.shape.positions, expected.positions);
    stream.send({ targets: [{ id: "t", x: 4, y: 9 }] });
    assert.equal((await nextShape(stream)).sequence, 5);
    stream.closeSending();
    assert.equal(await stream.read(), undefined);
  }),
);

test("a connection that the server replaces is nothing that a stream shows", { timeout }, () =>
  onStage(
    async ({ session }) => {
      const expected = await undisturbed(session);
      const stream = await session.openStream("h", { float64: true, resumeWithin: 60_000 });
      await begin(stream);
      await next(stream, "resumed");
      stream.send(last);
      let event = await stream.read();
      while (event?.kind === "resumed") event = await stream.read();
      assert.deepEqual(event?.kind === "shape" && event.shape.positions, expected.positions);
      await session.get();
      stream.cancel();
    },
    ["--connection-age-seconds", "1"],
    "127.0.0.1:0",
  ),
);

test("a stream gives up in time, and says why again", { timeout }, () =>
  onStage(async ({ server, session }) => {
    const stream = await session.openStream("h", { resumeWithin: 300 });
    await server.end("SIGKILL");
    await failure(stream.read(), "DRAINING");
    await failure(stream.read(), "DRAINING");
    await failure(() => stream.send({}), "PROTOCOL");
  }),
);

test("cancelling ends the trying", { timeout }, () =>
  onStage(async ({ server, session }) => {
    const stop = new AbortController();
    const stream = await session.openStream("h", { resumeWithin: 60_000 }, { signal: stop.signal });
    await server.end("SIGKILL");
    const end = failure(stream.read(), "CANCELLED");
    stop.abort();
    await end;
  }),
);

test("what is gone is not tried again", { timeout }, () =>
  onStage(async ({ session }) => {
    const stream = await session.openStream("h", { resumeWithin: 60_000 });
    await session.delete();
    await failure(stream.read(), "NOT_FOUND");
  }),
);

test("a frozen server is noticed by a stream that does not resume", { timeout }, () =>
  onStage(async ({ server, session }) => {
    const stream = await session.openStream("h", { heartbeat: 50, silence: 250 });
    await server.freeze();
    const error = await failure(stream.read(), "DRAINING");
    assert.match(error.message, /Nothing was heard from the server for 0.25 s/);
  }),
);
