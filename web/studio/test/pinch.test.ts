// Two fingers beside the puppet bring the view closer and farther; on the puppet they pull.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";

import { Stack } from "./support/stack.js";

const stack = new Stack();
before(() => stack.start());
after(() => stack.stop());

type Point = [number, number];

test("two fingers beside the puppet zoom about the middle between them, and move the view", async () => {
  const studio = await stack.open({ hasTouch: true, viewport: { width: 800, height: 900 } });
  const cdp = await studio.page.context().newCDPSession(studio.page);
  const touch = (type: string, points: Point[]) =>
    cdp.send("Input.dispatchTouchEvent", {
      type: type as "touchStart",
      touchPoints: points.map(([x, y], id) => ({ x, y, id })),
    });
  const box = await studio.ask<{ left: number; bottom: number; width: number }>(
    "(({ left, bottom, width }) => ({ left, bottom, width }))(document.getElementById('stage').getBoundingClientRect())",
  );
  // Below the figure, which keeps off the edge.
  const at = (part: number, up = 0): Point => [box.left + part * box.width, box.bottom - 14 - up];
  // Where a place of the figure is seen follows from two others.
  const seen = async (): Promise<{ zoom: number; at: Point }> => {
    const [a, b] = [await studio.at(0, 0), await studio.at(100, 0)];
    return { zoom: (b[0] - a[0]) / 100, at: a };
  };
  const steps = await studio.ask<string | null>("studio.history.undoable ?? null");
  const first = await seen();
  await touch("touchStart", [at(0.4)]);
  await touch("touchStart", [at(0.4), at(0.6)]);
  for (let i = 1; i <= 10; ++i) await touch("touchMove", [at(0.4 - 0.02 * i), at(0.6 + 0.02 * i)]);
  await studio.until(
    `(stage.inWindow(100, 0)[0] - stage.inWindow(0, 0)[0]) / ${100 * first.zoom} > 2.9`,
  );
  const closer = await seen();
  assert.ok(Math.abs(closer.zoom / first.zoom - 3) < 0.05, `${closer.zoom / first.zoom} times`);
  // What was in the middle is there still.
  const [mx, my] = at(0.5);
  for (const [k, m] of [mx, my].entries()) {
    const before = (first.at[k]! - m) / first.zoom;
    const now = (closer.at[k]! - m) / closer.zoom;
    assert.ok(Math.abs(before - now) < 1, `it went from ${before} to ${now}`);
  }
  for (let i = 1; i <= 5; ++i) await touch("touchMove", [at(0.2, 10 * i), at(0.8, 10 * i)]);
  await studio.until(`Math.abs(stage.inWindow(0, 0)[1] - ${closer.at[1] - 50}) < 1`);
  const moved = await seen();
  assert.ok(Math.abs(moved.zoom - closer.zoom) < 1e-3 && Math.abs(moved.at[0] - closer.at[0]) < 1);
  await touch("touchEnd", []);
  assert.equal(await studio.ask("studio.puppet.pins.length"), 0);
  assert.equal(await studio.ask("studio.history.undoable ?? null"), steps);

  // One finger on a pin and one beside: each does its own.
  await studio.ask("stage.fit(), studio.suggestPins()");
  await studio.settle();
  const pin = await studio.ask<{ x: number; y: number }>("studio.puppet.pins[0]");
  const [px, py] = await studio.at(pin.x, pin.y);
  await touch("touchStart", [[px, py]]);
  await touch("touchStart", [[px, py], at(0.6)]);
  for (let i = 1; i <= 5; ++i) await touch("touchMove", [[px - 4 * i, py], at(0.6)]);
  await touch("touchEnd", []);
  await studio.until(`studio.puppet.pins[0].x < ${pin.x - 5}`);
  await studio.settle();
  assert.deepEqual(studio.faults, []);
  await studio.page.context().close();
});
