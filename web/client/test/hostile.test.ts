// What a client does when a server, or something between, does not behave.
import assert from "node:assert/strict";
import { test } from "node:test";

import { status } from "@grpc/grpc-js";

import type { Client, DeformStream, StreamOptions } from "@arapd/client";

import { failure, next, nextShape } from "./support/events.js";
import { fault, flattenResponse, gone, opened, pretend, shape, square } from "./support/stub.js";
import type { Message, Pieces, Stream, Unary } from "./support/stub.js";

const timeout = 60_000;

async function stream(client: Client, options: StreamOptions = {}): Promise<DeformStream> {
  const session = await client.createSession();
  await session.registerMesh(square, { id: "m" });
  await session.compileHandles("h", "m", [
    { id: "a", vertex: 0 },
    { id: "b", vertex: 2 },
  ]);
  return session.openStream("h", options);
}

// Opens, and then answers every update with what `answer` makes of it.
const live = (answer: (message: Message, call: Stream) => void) => (call: Stream) => {
  call.on("data", (message: Message) => {
    if (message.open) call.write(opened("a", "b"));
    else if (message.ping) call.write({ pong: { nonce: message.ping.nonce } });
    else answer(message, call);
  });
  call.on("end", () => call.end());
  call.on("error", () => {});
};

const wrong: [string, RegExp, object][] = [
  ["another count", /3 vertices; the mesh has 4/, shape(1, { positions: [0, 0, 1, 0, 1, 1] })],
  ["half a vertex", /half a position/, shape(1, { positions: [0, 0, 1] })],
  ["no position", /empty shape/, shape(1, { positions: [] })],
  [
    "not a number",
    /position of vertex 2 that is not finite/,
    shape(1, { positions: [0, 0, 1, 0, 1, NaN, 0, 1] }),
  ],
  ["another precision", /another precision/, shape(1, { positions64: [0, 0, 1, 0, 1, 1, 0, 1] })],
  ["another sequence", /sequence 2, for which it was not asked/, shape(2)],
  ["flipped ids", /1 flipped triangles, not 0/, shape(1, { flippedIds: [0] })],
  ["picks", /1 picks, not 0/, shape(1, { picks: [{ hit: false }] })],
  ["quality", /quality of a shape/, shape(1, { energy: Infinity })],
  ["no measures", /without the measures/, shape(1, { unmeasured: true, meanStretch: 0 })],
  ["a pong", /a ping that was not sent/, { pong: { nonce: 3 } }],
  ["another opening", /does not belong here/, opened("a", "b")],
];
test("a shape that does not fit is not handed out", { timeout }, async () => {
  for (const [name, sentence, message] of wrong) {
    await pretend({ StreamDeform: live((_, call) => call.write(message)) }, async (client) => {
      const one = await stream(client, { resumeWithin: 60_000 });
      one.send({ targets: [{ id: "a", x: 1, y: 1 }] });
      assert.match((await failure(one.read(), "INTERNAL")).message, sentence, name);
    });
  }
});

test(
  "shapes are measured as often as was asked, and say nothing else of it",
  { timeout },
  async () => {
    const bare = { unmeasured: true, meanStretch: 0, maxStretch: 0 };
    const cases: [StreamOptions, number, object[], RegExp][] = [
      [{ measureEvery: 3 }, 0, [{}, bare, bare, bare], /without the measures/],
      [{ measureEvery: 3 }, 0, [bare], /without the measures/],
      [{ measureEvery: 0 }, 3, [bare, bare, bare], /without the measures/],
      [{ measureEvery: 0 }, 0, [bare, { ...bare, flippedCount: 1 }], /says it has not measured/],
      [{ measureEvery: 0 }, 0, [bare, { ...bare, maxStretch: 1 }], /says it has not measured/],
    ];
    for (const [options, asking, answers, sentence] of cases) {
      const answer = ({ update }: Message, call: Stream): void => {
        call.write(shape(update.sequence, answers[update.sequence - 1]));
      };
      await pretend({ StreamDeform: live(answer) }, async (client) => {
        const one = await stream(client, options);
        for (const [i, given] of answers.entries()) {
          one.send({ measure: i + 1 === asking });
          if (i + 1 < answers.length) {
            assert.equal((await nextShape(one)).measured, given !== bare);
          } else {
            assert.match((await failure(one.read(), "INTERNAL")).message, sentence);
          }
        }
      });
    }
  },
);

test("a stream that ends before it has answered is broken", { timeout }, () =>
  pretend({ StreamDeform: live((_, call) => call.end()) }, async (client) => {
    const one = await stream(client);
    one.send({ targets: [{ id: "a", x: 1, y: 1 }] });
    assert.match((await failure(one.read(), "INTERNAL")).message, /ended the stream early/);
  }),
);

test("a server that answers pings alone is not waited for without end", { timeout }, () =>
  pretend({ StreamDeform: live(() => {}) }, async (client) => {
    const one = await stream(client, {
      heartbeat: 20,
      silence: 10_000,
      answer: 200,
      resumeWithin: 60_000,
    });
    one.send({ targets: [{ id: "a", x: 1, y: 1 }] });
    const error = await failure(one.read(), "DEADLINE_EXCEEDED");
    assert.match(error.message, /has not answered an update or edit for 0.2 s/);
  }),
);

test("updates that were not taken yet become one, and no target is lost", { timeout }, async () => {
  const heard: Message[] = [];
  const places = new Map<string, number>();
  const answer = ({ update }: Message, call: Stream): void => {
    heard.push(update);
    for (const target of update.targets) places.set(target.handleId, target.x);
    if (update.sequence === 200) call.write(shape(200, { replaced: heard.length - 1 }));
  };
  await pretend({ StreamDeform: live(answer) }, async (client) => {
    const one = await stream(client);
    for (let i = 1; i < 200; i++) one.send({ targets: [{ id: i % 2 ? "a" : "b", x: i, y: 0 }] });
    one.send({ targets: [{ id: "b", x: 200, y: 0 }] });
    const last = await nextShape(one);
    assert.equal(last.sequence, 200);
    assert.ok(heard.length < 20, `${heard.length} updates were sent`);
    assert.deepEqual(Object.fromEntries(places), { a: 199, b: 200 });
    assert.equal(last.replaced, 199, "those that were merged on this side count too");
  });
});

test(
  "no more updates are without answer than was said; what waits becomes one",
  { timeout },
  async () => {
    const heard: number[] = [];
    const places = new Map<string, number>();
    let open: Stream | undefined;
    const answer = ({ update }: Message, call: Stream): void => {
      open = call;
      heard.push(update.sequence);
      for (const target of update.targets) places.set(target.handleId, target.x);
    };
    await pretend({ StreamDeform: live(answer) }, async (client) => {
      await failure(stream(client, { ahead: 0 }), "INVALID_OPTION");
      const one = await stream(client, { ahead: 2 });
      const settle = async (nonce: number): Promise<void> => {
        one.ping(nonce); // waits for nothing, and is answered when what went before it was heard
        assert.equal((await next(one, "pong")).nonce, nonce);
      };
      for (let i = 1; i <= 100; i++) {
        one.send({ targets: [{ id: i % 2 ? "a" : "b", x: i, y: 0 }] });
        if (i <= 3) await settle(i);
      }
      await settle(4);
      assert.deepEqual(heard, [1, 2]);
      open!.write(shape(1));
      assert.equal((await nextShape(one)).sequence, 1);
      // Those that waited are one, and the newest is as it was sent; both go out.
      await settle(5);
      assert.deepEqual(heard, [1, 2, 99, 100]);
      assert.deepEqual(Object.fromEntries(places), { a: 99, b: 100 });
      open!.write(shape(100, { replaced: 2 }));
      assert.equal((await nextShape(one)).replaced, 98, "all but 1 and 100");
      one.cancel();
    });
  },
);

test("a bad update is never merged into a good one", { timeout }, async () => {
  const heard: string[] = [];
  const answer = ({ update }: Message, call: Stream): void => {
    heard.push(update.targets.map((target: Message) => target.handleId).join());
    if (update.sequence === 50) call.write(shape(50));
  };
  await pretend({ StreamDeform: live(answer) }, async (client) => {
    const one = await stream(client);
    for (let i = 1; i <= 50; i++)
      one.send({ targets: [{ id: i === 20 ? "nobody" : "a", x: i, y: 0 }] });
    await nextShape(one);
    assert.ok(heard.length < 20);
    assert.equal(heard.filter((ids) => ids === "nobody").length, 1);
  });
});

// How streams are lost, in the words of servers and of what stands between.
const losses = [
  gone(),
  fault(status.UNAVAILABLE, "The server is going away.", "DRAINING", 20),
  fault(status.UNKNOWN, "Stream removed"),
  fault(status.UNKNOWN, "No status received"),
  fault(status.INTERNAL, "Received RST_STREAM with error code 2"),
  fault(status.INTERNAL, "Write error: write after end"),
  fault(status.CANCELLED, "stopping"),
];
for (const loss of losses) {
  test(`a stream that ended with ${loss.code} "${loss.details}" resumes`, { timeout }, async () => {
    let opening = 0;
    const answer = ({ update }: Message, call: Stream): void => {
      if (opening === 1) call.emit("error", loss);
      else call.write(shape(update.sequence));
    };
    const usual = live(answer);
    const handler = (call: Stream): void => {
      opening++;
      // No room at first: asked again.
      if (opening === 2)
        call.emit("error", fault(status.RESOURCE_EXHAUSTED, "full", "LIMIT_EXCEEDED", 1000));
      else usual(call);
    };
    await pretend({ StreamDeform: handler }, async (client) => {
      const one = await stream(client, { resumeWithin: 60_000 });
      one.send({ targets: [{ id: "a", x: 1, y: 1 }] });
      const resumed = await next(one, "resumed");
      assert.equal(resumed.attempts, 2);
      assert.equal(resumed.unanswered, 1);
      assert.equal((await nextShape(one)).sequence, 1);
    });
  });
}

test("a stream that is refused for good is not opened again", { timeout }, () =>
  pretend(
    { StreamDeform: live((_, call) => call.emit("error", fault(9, "order", "PROTOCOL"))) },
    async (client) => {
      const one = await stream(client, { resumeWithin: 60_000 });
      one.send({ targets: [{ id: "a", x: 1, y: 1 }] });
      assert.equal((await failure(one.read(), "PROTOCOL")).code, "FAILED_PRECONDITION");
    },
  ),
);

test(
  "calls say who they are, and are made again where that does no harm",
  { timeout },
  async () => {
    const seen: Message[] = [];
    const failing = (times: number, loss: () => object, answer: object): Unary => {
      let count = 0;
      return (call, say) => {
        seen.push({ ...call.metadata.getMap(), deadline: call.getDeadline() });
        if (count++ < times) say(loss() as never, null);
        else say(null, answer);
      };
    };
    const set = opened("a").opened;
    const handlers = {
      GetSession: failing(2, gone, { session: { sessionId: "mine" } }),
      EditHandles: failing(1, gone, set),
      DeleteMesh: failing(1, gone, {}),
      GetHandleSet: failing(
        1,
        () => fault(status.RESOURCE_EXHAUSTED, "busy", "OVERLOADED", 20),
        set,
      ),
      DeleteHandleSet: ((): Unary => {
        let count = 0;
        return (_, say) =>
          say((count++ === 0 ? gone() : fault(5, "none", "NOT_FOUND")) as never, null);
      })(),
    };
    await pretend(handlers, async (client) => {
      const session = client.attachSession("mine");
      await session.get({ traceparent: "00-0123456789abcdef0123456789abcdef-0123456789abcdef-01" });
      assert.equal(seen.length, 3);
      for (const headers of seen) {
        assert.equal(headers["x-session-id"], "mine");
        assert.equal(headers["x-request-id"], seen[0]["x-request-id"]);
        assert.equal(
          headers["traceparent"],
          "00-0123456789abcdef0123456789abcdef-0123456789abcdef-01",
        );
        assert.ok(
          headers.deadline - Date.now() < 30_000 && headers.deadline - Date.now() > -timeout,
        );
      }
      // Whether it was done is not known, so it is not done again.
      await failure(session.editHandles("h", [], []), "DRAINING");
      assert.equal(seen.length, 4);
      await session.deleteMesh("m");
      await session.deleteHandleSet("h"); // nothing left to delete after a lost answer
      assert.equal((await session.getHandleSet("h")).handles.length, 1);
      await failure(
        session.get({ retryWithin: 0, timeout: 5000 }).then(() => session.deleteHandleSet("h")),
        "NOT_FOUND",
      );
    });
  },
);

test("a download goes on where it was lost", { timeout }, async () => {
  const distortion = { symmetricDirichlet: 4, areaRatio: 1, scale: 1 };
  const whole = flattenResponse({
    uv: [0, 0, 1, 0, 0, 1],
    uvVertex: [0, 1, 2],
    cornerUv: [0, 1, 2],
    distortion,
    triangleChart: [0],
    charts: [{ loops: [{ uvIndices: [0, 1, 2] }], triangleCount: 1, distortion }],
  });
  const offsets: number[] = [];
  const DownloadResult: Pieces = (call) => {
    const { offset } = call.request as { offset: number };
    offsets.push(offset);
    call.write(
      { data: whole.subarray(offset, offset + 30), offset, totalBytes: whole.length },
      () => {
        if (offset + 30 >= whole.length) call.end();
        // Once what was written has surely gone out.
        else setTimeout(() => call.emit("error", gone()), 100);
      },
    );
  };
  const mesh = { vertices: [0, 0, 0, 1, 0, 0, 0, 1, 0], triangles: [0, 1, 2] };
  await pretend({ DownloadResult }, async (client) => {
    const flat = await client
      .attachSession("s")
      .getResult("job", mesh, {}, { retryWithin: 60_000 });
    assert.deepEqual(Array.from(flat.uv), [0, 0, 1, 0, 0, 1]);
    assert.equal(flat.charts[0]!.refineEnd, null);
    assert.ok(
      offsets.length >= 2 && offsets.every((offset, i) => i === 0 || offset >= offsets[i - 1]!),
    );
  });
});

test("a stream reads on demand: what nobody waits for stays on its way", { timeout }, async () => {
  const count = 30;
  let written = 0;
  let heard = 0;
  let hasHeardAll = (): void => {};
  const all = new Promise<void>((resolve) => (hasHeardAll = resolve));
  const answer = ({ update }: Message, call: Stream): void => {
    // 80 kB each, of which the window of HTTP/2 holds less than one.
    call.write(
      shape(update.sequence, { positions: new Array<number>(20_000).fill(1) }),
      () => written++,
    );
    if (++heard === count) hasHeardAll();
  };
  await pretend({ StreamDeform: live(answer) }, async (client) => {
    const one = await client.attachSession("s").openStream("h", { delivery: "every" });
    for (let i = 0; i < count; i++) one.send({});
    await nextShape(one);
    await all;
    // Long enough for a reader that reads ahead; one that does not never comes farther.
    await new Promise((resolve) => setTimeout(resolve, 300));
    assert.ok(written < 8, `${written} shapes have left the server`);
    for (let i = 2; i <= count; i++) assert.equal((await nextShape(one)).sequence, i);
    one.cancel();
  });
});
