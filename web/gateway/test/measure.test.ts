// Shapes that are measured only as often as the page asks for it.
import assert from "node:assert/strict";
import { test } from "node:test";

import { ask, json, onStage, problem } from "./support/gateway.js";
import type { Json } from "./support/gateway.js";
import { drag, move, puppet } from "./support/puppet.js";

const timeout = 120_000;
const figures = ["flippedCount", "energy", "meanStretch", "maxStretch"];

/** Whether a shape is measured; it has all figures then, and else none. */
function measured(facts: Json): boolean {
  for (const figure of figures)
    assert.equal(figure in facts, facts.measured, JSON.stringify(facts));
  if (!facts.measured) assert.ok(!("flippedIds" in facts));
  assert.ok("worstHandleError" in facts);
  return facts.measured as boolean;
}

test("a stream measures as often as it was asked", { timeout }, () =>
  onStage(async ({ url }) => {
    const session = await puppet(url);
    const page = await drag(url, session, { measureEvery: 3, flippedIds: true });
    const marks: boolean[] = [];
    for (let i = 0; i < 5; i++) {
      page.say(move(9 + i, 3));
      marks.push(measured((await page.frame()).facts));
    }
    assert.deepEqual(marks, [true, false, false, true, false]);
    page.say({ type: "edit", add: [{ id: "t", vertex: 76 }] });
    assert.ok(measured((await page.frame()).facts));
    page.say(move(9, 4));
    const left = await page.frame();
    assert.ok(!measured(left.facts));
    page.say({ type: "update", measure: true }); // the hand rests
    const rests = await page.frame();
    assert.ok(measured(rests.facts) && rests.facts.energy > 0);
    assert.deepEqual(rests.positions, left.positions);
    page.say({ type: "update", measure: "yes" });
    assert.equal((await page.text("error")).problem.field, "measure");
    page.socket.close();
  }),
);

test("measures that were asked for reach a slow page", { timeout }, () =>
  onStage(async ({ url }) => {
    const page = await drag(url, await puppet(url), { measureEvery: 0, window: 1 });
    page.say({ ...move(9, 1), sequence: 1 });
    assert.ok(!measured((await page.frame()).facts));
    // Nothing goes out until the page has seen that; the answers to pings give the shapes time to come.
    const said = [{ measure: true }, {}, { measure: true }, {}, {}];
    for (const [i, more] of said.entries()) {
      page.say({ ...move(9, 2 + i), sequence: 2 + i, ...more });
      page.say({ type: "ping", nonce: i });
      assert.equal((await page.text("pong")).nonce, i);
    }
    let measures = 0; // the last sequence whose shape has them
    let counted = 0;
    for (let last = 1; last !== 6; ) {
      page.say({ type: "seen", sequence: last });
      const { sequence, facts } = await page.frame();
      assert.ok(sequence > last);
      if (measured(facts)) measures = sequence;
      counted += 1 + facts.skipped + facts.replaced;
      last = sequence;
    }
    // Of 4 itself, or of what the server has computed in its place.
    assert.ok(measures >= 4);
    assert.equal(counted, said.length);
    page.say({ type: "seen", sequence: 6 });
    page.say({ type: "close" });
    assert.equal(await page.closed(), 1000);
  }),
);

test("single shapes and tracks too", { timeout }, () =>
  onStage(async ({ url }) => {
    const session = await puppet(url);
    const path = `${url}/v1/sessions/${session}/handle-sets/h`;
    const targets = [
      { id: "l", x: 0, y: 0 },
      { id: "r", x: 9, y: 3 },
    ];
    const whole = (await json(`${path}/deform`, { body: { targets } })) as Json;
    const bare = (await json(`${path}/deform`, { body: { targets, measureEvery: 0 } })) as Json;
    assert.ok(measured(whole) && !measured(bare));
    assert.deepEqual(bare.positions, whole.positions);
    await problem(`${path}/deform`, { body: { targets, measureEvery: -1 } }, "MALFORMED");

    const positions = [0, 0, 9, 3];
    const bodies = [
      { handles: ["l", "r"], frames: Array.from({ length: 5 }, () => ({ positions })) },
      {
        handles: [
          { name: "l", rest: [0, 0] },
          { name: "r", rest: [8, 0] },
        ],
        frames: Array.from({ length: 5 }, () => ({
          targets: [
            [0, 0],
            [9, 3],
          ],
        })),
      },
    ];
    for (const body of bodies) {
      const answer = await ask(`${path}/track`, { body: { ...body, measureEvery: 2 } });
      const lines = (await answer.text()).trimEnd().split("\n");
      assert.deepEqual(
        lines.map((line) => measured(JSON.parse(line) as Json)),
        [true, false, true, false, true],
      );
    }
  }),
);
