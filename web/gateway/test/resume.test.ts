// What goes wrong under a drag: arapd is killed and replaced, readers stall, the gateway goes away.
import assert from "node:assert/strict";
import { test } from "node:test";

import { onStage } from "./support/gateway.js";
import { Page } from "./support/page.js";
import type { Frame, Heard } from "./support/page.js";
import { drag, farthest, move, puppet } from "./support/puppet.js";

const rounds = Number(process.env["ARAP_WEB_ROUNDS"] ?? 3);
const timeout = 120_000 + rounds * 30_000;
const stored = ["--store", "sqlite:{}/state"];

test(`arapd is killed ${rounds} times under a drag, which goes on`, { timeout }, () =>
  onStage(
    async ({ url, server }) => {
      const session = await puppet(url);
      const calm = await drag(url, session);
      const steps = async (page: Page, harm: () => Promise<void>): Promise<Frame> => {
        page.say(move(8, 3));
        assert.equal((await page.frame()).sequence, 1);
        page.say({ type: "edit", add: [{ id: "t", vertex: 76 }] });
        assert.equal((await page.frame()).sequence, 2);
        await harm();
        page.say({ type: "update", targets: [{ id: "l", x: -1, y: 0 }] });
        page.say({ ...move(9, 1), sequence: 100 });
        for (;;) {
          const heard = await page.next();
          if (heard.kind === "text")
            assert.equal(heard.message.type, "resumed", JSON.stringify(heard.message));
          else if (heard.kind === "closed") assert.fail(`closed with ${heard.code}`);
          else if (heard.frame.sequence === 100) return heard.frame;
        }
      };
      const expected = await steps(calm, async () => {});
      for (let round = 0; round < rounds; round++) {
        const page = await drag(url, session);
        const { positions, facts } = await steps(page, async () => {
          await server.end("SIGKILL");
          for (let i = 0; i < 50; i++) page.say(move(8 + i / 10, 2)); // into the void
          await server.start();
        });
        assert.equal(farthest(positions, expected.positions), 0);
        assert.equal(facts.handleSetRevision, expected.facts.handleSetRevision);
        page.socket.close();
      }
      const metrics = await (await fetch(`${url}/metrics`)).text();
      assert.ok(Number(/^arapd_gateway_resumed_total (\d+)$/m.exec(metrics)![1]) >= rounds);
    },
    {},
    stored,
  ),
);

test("requests too outlive their server", { timeout }, () =>
  onStage(
    async ({ url, server }) => {
      const session = await puppet(url);
      await server.end("SIGKILL");
      const asked = fetch(`${url}/v1/sessions/${session}`);
      await server.start();
      assert.equal((await asked).status, 200);
    },
    {},
    stored,
  ),
);

test("a stream that is not resumed in time says so", { timeout }, () =>
  onStage(
    async ({ url, server }) => {
      const page = await drag(url, await puppet(url));
      await server.end("SIGKILL");
      assert.equal((await page.failed()).reason, "DRAINING");
    },
    { resumeWithinMs: 300 },
  ),
);

// 40,000 vertices: a frame of 320 kB, so that a few fill what kernels hold.
const columns = 200;

test("a reader that stalls costs one frame, and reads the newest next", { timeout }, () =>
  onStage(async ({ url }) => {
    const page = await drag(url, await puppet(url, columns));
    const frames: Frame[] = [];
    let newest: Frame | undefined;
    page.socket.pause();
    let sent = 0;
    const metric = async (name: string): Promise<number> => {
      const text = await (await fetch(`${url}/metrics`)).text();
      return Number(new RegExp(`^arapd_gateway_${name} (\\d+)$`, "m").exec(text)![1]);
    };
    // Until the network takes no more, and then a while: every further shape replaces the one that waits.
    while ((await metric("shapes_skipped_total")) < 20)
      page.say({ ...move(columns + (sent % 7), 1), sequence: ++sent });
    page.say({ ...move(columns, 5), sequence: ++sent });
    page.socket.resume();
    while (newest?.sequence !== sent) frames.push((newest = await page.frame()));
    // Every update has a frame, or is counted by the next one.
    const without = frames.reduce((sum, { facts }) => sum + facts.skipped + facts.replaced, 0);
    assert.equal(frames.length + without, sent);
    assert.ok(frames.reduce((sum, { facts }) => sum + facts.skipped, 0) >= 20);
    assert.ok(frames.every(({ sequence }, i) => i === 0 || sequence > frames[i - 1]!.sequence));
    page.socket.close();
  }),
);

test("with a window at most so many shapes are on their way", { timeout }, () =>
  onStage(async ({ url }) => {
    const session = await puppet(url);
    for (const window of [1, 2]) {
      const page = await drag(url, session, { window });
      const first: Frame[] = [];
      for (let i = 1; i <= window; i++) {
        page.say({ ...move(9, i), sequence: i });
        first.push(await page.frame());
      }
      // The pong of arapd comes behind the shapes of what was said before, none of which may go out.
      for (let i = 10; i < 20; i++) {
        page.say({ ...move(9, i), sequence: i });
        page.say({ type: "ping", nonce: i });
        assert.equal((await page.text("pong")).nonce, i);
      }
      page.say({ ...move(10, 3), sequence: 50, pickPoints: [0, 0] });
      page.say({ type: "seen", sequence: first.at(-1)!.sequence });
      const skipped: number[] = [];
      for (let last = 0; last !== 50; ) {
        const { sequence, facts } = await page.frame();
        skipped.push(facts.skipped + facts.replaced);
        last = sequence;
        page.say({ type: "seen", sequence });
      }
      // Each of the eleven updates came as a shape or is counted by one.
      const counted = skipped.reduce((sum, one) => sum + one, skipped.length);
      assert.equal(counted, 11);
      page.socket.close();
    }
  }),
);

test("a gateway that goes away says so, and takes no new work", { timeout }, () =>
  onStage(async ({ url, gateway }) => {
    const session = await puppet(url);
    const page = await drag(url, session);
    const drained = gateway.drain(60);
    await page.text("draining");
    page.say(move(9, 9));
    assert.equal((await page.frame()).sequence, 1);
    for (const path of ["/readyz", `/v1/sessions/${session}`]) {
      const response = await fetch(`${url}${path}`);
      assert.deepEqual(
        [response.status, ((await response.json()) as { reason: string }).reason],
        [503, "GATEWAY_BUSY"],
      );
    }
    assert.equal((await fetch(`${url}/healthz`)).status, 200);
    assert.equal(
      (await Page.refused(url, `/v1/sessions/${session}/stream`)).reason,
      "GATEWAY_BUSY",
    );
    page.say({ type: "close" });
    assert.equal(await page.closed(), 1000);
    await drained; // long before the minute is over
  }),
);

test("what has not ended in time is cut", { timeout }, () =>
  onStage(async ({ url, gateway }) => {
    const page = await drag(url, await puppet(url));
    const drained = gateway.drain(0);
    await page.text("draining");
    let heard: Heard;
    do heard = await page.next();
    while (heard.kind !== "closed");
    assert.equal(heard.code, 1001);
    await drained;
  }),
);

test("a socket that answers no ping is cut", { timeout }, () =>
  onStage(
    async ({ url }) => {
      // A page that is gone without a word: it neither reads nor answers.
      const page = await Page.connect(url, "any");
      const raw = (page.socket as unknown as { _socket: NodeJS.ReadableStream })._socket;
      raw.pause();
      while (/^arapd_gateway_sockets 1$/m.test(await (await fetch(`${url}/metrics`)).text()));
      raw.resume();
      page.socket.terminate();
    },
    { socketPingMs: 50 },
  ),
);
