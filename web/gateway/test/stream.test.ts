// The stream: what is said on a socket, and what comes back.
import assert from "node:assert/strict";
import { test } from "node:test";

import { json, onStage } from "./support/gateway.js";
import { Page } from "./support/page.js";
import { drag, farthest, grid, move, plain, puppet } from "./support/puppet.js";

const timeout = 120_000;

test("shapes are those of the Node client, in both encodings", { timeout }, () =>
  onStage(async ({ url, client }) => {
    const session = await puppet(url);
    const own = client.attachSession(session);
    const targets = [
      { id: "l", x: 0, y: 0 },
      { id: "r", x: 9, y: 3 },
    ];
    const exact = await own.deform("h", targets, { float64: true, pickPoints: [9, 3, 99, 99] });
    for (const encoding of ["float32", "int16"] as const) {
      const page = await drag(url, session, { encoding, flippedIds: true });
      assert.equal(page.socket.protocol, "arapd.v1");
      page.say({ ...move(9, 3), sequence: 7, pickPoints: [9, 3, 99, 99] });
      const { sequence, facts, positions, ...frame } = await page.frame();
      assert.deepEqual([sequence, frame.encoding, frame.local.length], [7, encoding, 162]);
      assert.ok(farthest(positions, exact.positions) <= 2 * facts.positionError + 1e-12);
      assert.ok(facts.positionError < 1e-3);
      const {
        energy,
        worstHandleId,
        worstHandleError,
        meanStretch,
        maxStretch,
        picks,
        flippedCount,
      } = exact;
      assert.deepEqual(
        { energy, worstHandleId, worstHandleError, meanStretch, maxStretch, picks, flippedCount },
        {
          energy: facts.energy,
          worstHandleId: facts.worstHandleId,
          worstHandleError: facts.worstHandleError,
          meanStretch: facts.meanStretch,
          maxStretch: facts.maxStretch,
          picks: facts.picks,
          flippedCount: facts.flippedCount,
        },
      );
      assert.deepEqual([facts.replaced, facts.skipped, facts.handleSetRevision], [0, 0, 1]);
      assert.ok(facts.solveMicros >= 0 && facts.queueMicros >= 0);
      assert.equal(frame.encoding === "float32", facts.scale === 1);
      page.say({ type: "close" });
      assert.equal(await page.closed(), 1000);
    }
  }),
);

test("positions of all handles, edits, pings, and the end", { timeout }, () =>
  onStage(async ({ url }) => {
    const page = await Page.connect(url, await puppet(url));
    page.say({ type: "open", handleSet: "h" });
    page.say({ type: "update", positions: [0, 1, 8, 1] }); // nobody has to wait for `opened`
    const { handleSet, vertices } = await page.text("opened");
    assert.deepEqual(
      handleSet.handles.map(({ id }: { id: string }) => id),
      ["l", "r"],
    );
    assert.equal(vertices, null);
    assert.equal((await page.frame()).sequence, 1);
    page.say({ type: "edit", add: [{ id: "t", vertex: 76 }] });
    const added = await page.frame();
    assert.deepEqual([added.sequence, added.facts.handleSetRevision], [2, 2]);
    page.say({ type: "edit", sequence: 9, remove: ["t"] });
    assert.equal((await page.frame()).sequence, 9);
    page.say({ type: "ping", nonce: 77 });
    assert.deepEqual(await page.text("pong"), { type: "pong", nonce: 77 });
    page.say(move(9, 1));
    page.say({ type: "close" });
    assert.equal((await page.frame()).sequence, 10);
    assert.equal(await page.closed(), 1000);
  }),
);

test("some vertices alone", { timeout }, () =>
  onStage(async ({ url }) => {
    const session = await puppet(url);
    for (const [open, expected] of [
      [{ vertexSubset: [3, 80, 0] }, [3, 80, 0]],
      [{ boundaryOnly: true }, undefined],
    ] as const) {
      const page = await Page.connect(url, session);
      page.say({ type: "open", handleSet: "h", ...open });
      const { vertices } = await page.text("opened");
      if (expected) assert.deepEqual(vertices, expected);
      else assert.equal(vertices.length, 32);
      page.say(move(9, 1));
      assert.equal((await page.frame()).local.length, 2 * vertices.length);
      page.socket.close();
    }
  }),
);

test('an "every" stream answers every update, in order', { timeout }, () =>
  onStage(async ({ url }) => {
    const page = await drag(url, await puppet(url), { delivery: "every", window: 1 });
    for (let i = 1; i <= 200; i++) page.say(move(8 + i / 100, 0));
    page.say({ type: "close" });
    for (let i = 1; i <= 200; i++) {
      const { sequence, facts } = await page.frame();
      assert.deepEqual([sequence, facts.replaced, facts.skipped], [i, 0, 0]);
      page.say({ type: "seen", sequence });
    }
    assert.equal(await page.closed(), 1000);
  }),
);

test("what is wrong with a message changes nothing", { timeout }, () =>
  onStage(async ({ url }) => {
    const page = await drag(url, await puppet(url));
    const wrong: [object | string, string, number | null, string?][] = [
      [{ type: "update", sequence: 3, targets: [{ id: "x", x: 0, y: 0 }] }, "UNKNOWN_HANDLE", 3],
      [{ type: "update", sequence: 4, positions: [1, 2] }, "TARGET_COUNT", 4],
      [{ type: "update", sequence: 4, targets: [] }, "INVALID_OPTION", 4, "sequence"],
      [{ type: "update", targets: [{ id: "r", x: "1", y: 0 }] }, "MALFORMED", null, "targets[0].x"],
      [{ type: "update", colour: 1 }, "MALFORMED", null, "colour"],
      [{ type: "edit", add: [{ id: "t" }] }, "MALFORMED", null, "add[0]"],
      [{ type: "edit", sequence: 5, remove: ["x"] }, "UNKNOWN_HANDLE", 5],
      [{ type: "open", handleSet: "h" }, "MALFORMED", null],
      [{ type: "dance" }, "MALFORMED", null, "type"],
      ["{", "MALFORMED", null],
      ["null", "MALFORMED", null, "type"],
    ];
    for (const [message, reason, sequence, field] of wrong) {
      page.socket.send(typeof message === "string" ? message : JSON.stringify(message));
      const told = await page.text("error");
      assert.equal(told.problem.reason, reason, JSON.stringify(told));
      assert.equal(told.sequence, sequence);
      if (field) assert.equal(told.problem.field, field);
    }
    page.socket.send(Buffer.from([1, 2, 3]));
    assert.equal((await page.text("error")).problem.reason, "MALFORMED");
    page.say({ ...move(9, 2), sequence: 6 });
    assert.equal((await page.frame()).sequence, 6);
    page.socket.close();
  }),
);

test("what ends a stream is told before the socket is closed", { timeout }, () =>
  onStage(async ({ url, client }) => {
    const session = await puppet(url);
    const first: [object, string][] = [
      [{ type: "ping" }, "MALFORMED"],
      [{ type: "open" }, "MALFORMED"],
      [{ type: "open", handleSet: "none" }, "NOT_FOUND"],
      [{ type: "open", handleSet: "h", vertexSubset: [81] }, "INDEX_OUT_OF_RANGE"],
    ];
    for (const [message, reason] of first) {
      const page = await Page.connect(url, session);
      page.say(message);
      assert.equal((await page.failed()).reason, reason);
    }
    const nowhere = await Page.connect(url, "nowhere");
    nowhere.say({ type: "open", handleSet: "h" });
    assert.equal((await nowhere.failed()).reason, "NOT_FOUND");

    const ended = await drag(url, session);
    await client.attachSession(session).delete();
    assert.equal((await ended.failed()).reason, "NOT_FOUND");
  }),
);

test("a socket that says nothing is closed", { timeout }, () =>
  onStage(
    async ({ url }) => {
      const silent = await Page.connect(url, "any");
      assert.equal((await silent.failed()).reason, "TOO_LATE");
    },
    { openWithinMs: 100 },
  ),
);

test("a page that leaves frees what it had", { timeout }, () =>
  onStage(
    async ({ url }) => {
      const session = await puppet(url);
      const page = await drag(url, session);
      const sockets = async (): Promise<string> =>
        /^arapd_gateway_sockets (\d+)$/m.exec(await (await fetch(`${url}/metrics`)).text())![1]!;
      assert.equal(await sockets(), "1");
      page.socket.terminate();
      while ((await sockets()) !== "0");
      // The stream of arapd has ended with it: another takes its place, as often as one likes.
      for (let i = 0; i < 20; i++) (await drag(url, session)).socket.terminate();
    },
    {},
    ["--store", "memory", "--max-streams", "4"],
  ),
);

test("far from 0 nothing is lost", { timeout }, () =>
  onStage(async ({ url }) => {
    const { id } = await json(`${url}/v1/sessions`, { body: {} }, 201);
    const far = grid(5, 5);
    const vertices = Array.from(far.vertices, (x) => x + 5_400_000);
    await json(
      `${url}/v1/sessions/${id}/meshes`,
      { body: { id: "m", mesh: { ...plain(far), vertices } } },
      201,
    );
    const handles = [{ id: "r", vertex: 4 }];
    await json(
      `${url}/v1/sessions/${id}/handle-sets`,
      { body: { id: "h", meshId: "m", handles } },
      201,
    );
    const page = await drag(url, id);
    page.say(move(5_400_004.125, 5_400_000.125));
    const { positions } = await page.frame();
    assert.ok(
      farthest(
        positions,
        vertices.map((x) => x + 0.125),
      ) < 1e-6,
    );
    page.socket.close();
  }),
);
