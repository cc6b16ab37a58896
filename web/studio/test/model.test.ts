// The document: history, pins, takes.
import assert from "node:assert/strict";
import { test } from "node:test";

import { holdAt, nearestHold, placeOf } from "../src/model/geometry.js";
import { History } from "../src/model/history.js";
import {
  atRest,
  emptyPuppet,
  freshId,
  keepPose,
  moveTo,
  newPin,
  paintStarch,
  sameHandle,
} from "../src/model/puppet.js";
import type { Body, Puppet } from "../src/model/puppet.js";
import { frameOf, looped, pinsAt, playedFrames, smoothed } from "../src/model/take.js";
import type { Take } from "../src/model/take.js";
import { readShape } from "../src/net/shape.js";
import { Detail } from "../src/view/detail.js";
import { orderOf } from "../src/view/order.js";

const square: Body = {
  picture: Float64Array.of(0, 0, 10, 0, 10, 10, 0, 10),
  rest: Float64Array.of(0, 0, 10, 0, 10, 10, 0, 10),
  triangles: Uint32Array.of(0, 1, 2, 0, 2, 3),
};

test("history goes back and forth, a key makes steps one, a new step forgets what was undone", () => {
  const history = new History(0);
  history.do(1, "one");
  history.do(2, "drag", "a");
  history.do(3, "drag", "a");
  assert.equal(history.undoable, "drag");
  assert.ok(history.undo());
  assert.equal(history.present, 1);
  assert.equal(history.redoable, "drag");
  assert.ok(history.redo());
  assert.equal(history.present, 3);
  history.do(4, "drag", "a"); // after a redo it is a drag of its own
  history.undo();
  assert.equal(history.present, 3);
  history.do(5, "other");
  assert.ok(!history.redo());
  history.do(5, "nothing");
  assert.equal(history.undoable, "other");
});

test("sealed steps are apart, history is bounded, the first document stays under amend", () => {
  const history = new History(0, 3);
  history.amend(1);
  assert.equal(history.undoable, undefined);
  history.do(2, "a", "k");
  history.seal();
  history.do(3, "b", "k");
  history.undo();
  assert.equal(history.present, 2);
  for (let i = 3; i < 9; ++i) history.do(i, `${i}`);
  let steps = 0;
  while (history.undo()) ++steps;
  assert.equal(steps, 3);
});

test("points are held by triangles, those outside by the nearest border", () => {
  const hold = holdAt(7, 2, square.triangles, square.rest)!;
  assert.equal(hold.triangle, 0);
  const [x, y] = placeOf(hold, square.triangles, square.rest);
  assert.ok(Math.hypot(x - 7, y - 2) < 1e-12);
  assert.equal(holdAt(11, 2, square.triangles, square.rest), undefined);
  const near = placeOf(
    nearestHold(14, 3, square.triangles, square.rest),
    square.triangles,
    square.rest,
  );
  assert.ok(Math.hypot(near[0] - 10, near[1] - 3) < 1e-12);
  // On top is what comes last in the order.
  const twice = Uint32Array.of(0, 1, 2, 0, 1, 2);
  assert.equal(holdAt(7, 2, twice, square.rest)!.triangle, 1);
  assert.equal(holdAt(7, 2, twice, square.rest, [1, 0])!.triangle, 0);
});

function puppetWithPins(): Puppet {
  const hold = holdAt(7, 2, square.triangles, square.rest)!;
  const first = newPin([], hold, 7, 2);
  const second = newPin([first], holdAt(2, 7, square.triangles, square.rest)!, 2, 7);
  return { ...emptyPuppet(0), body: square, pins: [first, second] };
}

test("pins have names of their own, and go along to another mesh", () => {
  const { pins } = puppetWithPins();
  assert.deepEqual(
    pins.map((pin) => pin.id),
    ["pin-1", "pin-2"],
  );
  assert.equal(freshId([pins[1]]), "pin-1");
  const finer: Body = {
    picture: Float64Array.of(0, 0, 10, 0, 10, 10, 0, 10, 5, 5),
    rest: Float64Array.of(0, 0, 10, 0, 10, 10, 0, 10, 5, 5),
    triangles: Uint32Array.of(0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4),
  };
  const moved = moveTo(
    finer,
    pins.map((pin) => ({ ...pin, x: 90 })),
    square,
  );
  assert.ok(Math.hypot(moved[0].x - 7, moved[0].y - 2) < 1e-9);
  assert.ok(sameHandle(pins[0], { ...pins[0], x: 4, angle: 1 }));
  assert.ok(!sameHandle(pins[0], { ...pins[0], depth: 1 }));
  assert.ok(sameHandle(pins[0], { ...pins[0], weight: 3 })); // it is not a soft one
});

test("a kept pose is the new rest, where the pins that are left rest", () => {
  const puppet = puppetWithPins();
  const shape = Float32Array.of(0, 0, 20, 0, 20, 10, 0, 10);
  const kept = keepPose(puppet, shape, [puppet.pins[0]]);
  assert.deepEqual([...kept.body!.rest], [...shape]);
  assert.equal(kept.body!.picture, square.picture);
  assert.equal(kept.pins.length, 1);
  assert.ok(Math.hypot(kept.pins[0].x - 14, kept.pins[0].y - 2) < 1e-6);
  assert.deepEqual([...puppet.body!.rest], [...square.rest]);
  const pulled = { ...puppet, pins: puppet.pins.map((pin) => ({ ...pin, x: 99, angle: 2 })) };
  assert.ok(Math.abs(atRest(pulled).pins[0].x - 7) < 1e-12);
  assert.equal(atRest(pulled).pins[0].angle, 0);
});

test("starch is painted where the brush is, and the old one is not changed", () => {
  const painted = paintStarch(square, square.rest, null, 7, 2, 3, 20)!;
  assert.deepEqual([...painted], [20, 1]);
  const more = paintStarch(square, square.rest, painted, 3, 7, 1, 5)!;
  assert.deepEqual([...more], [20, 5]);
  assert.deepEqual([...painted], [20, 1]);
  assert.equal(paintStarch(square, square.rest, painted, 90, 90, 1, 5), painted);
});

test("a limb is drawn after the body, one piece after the other, whatever the triangles' numbers", () => {
  // A strip of squares, thick at its left end: 3 rows of 3 columns, then one row of 4 columns.
  const cells: [number, number][] = [];
  for (let x = 0; x < 7; ++x) for (let y = 0; y < (x < 3 ? 3 : 1); ++y) cells.push([x, y]);
  const id = (x: number, y: number): number => x * 4 + y;
  const faces = cells.flatMap(([x, y]) => [
    [id(x, y), id(x + 1, y), id(x + 1, y + 1)],
    [id(x, y), id(x + 1, y + 1), id(x, y + 1)],
  ]);
  const shuffled = faces.map((_, i) => faces[(i * 7) % faces.length]);
  const order = orderOf(Uint32Array.from(shuffled.flat()));
  const columns = [...order].map((t) => Math.floor(Math.min(...shuffled[t]) / 4));
  const limb = columns.filter((column) => column >= 3);
  assert.deepEqual(
    limb,
    [...limb].sort((a, b) => a - b),
  );
  assert.deepEqual(columns.slice(-2), [6, 6]);
  assert.deepEqual(
    [...order].sort((a, b) => a - b),
    shuffled.map((_, i) => i),
  );
  const two = orderOf(Uint32Array.of(0, 1, 2, 5, 6, 7, 2, 1, 3));
  assert.deepEqual([...two].slice(0, 2).sort(), [0, 2]);
});

const numbers = (...values: number[]): Float64Array[] =>
  values.map((value) => Float64Array.of(value));
const plain = (frames: Float64Array[]): number[] => frames.map((frame) => frame[0]);

test("smoothing keeps the ends, a straight move and the mean speed", () => {
  assert.deepEqual(plain(smoothed(numbers(0, 1, 2, 3), 7)), [0, 1, 2, 3]);
  assert.deepEqual(plain(smoothed(numbers(0, 4, 0), 1)), [0, 2, 0]);
  const rough = numbers(0, 3, 0, 3, 0, 3);
  const fine = plain(smoothed(rough, 5));
  const jump = (values: number[]): number =>
    Math.max(...values.slice(1).map((value, i) => Math.abs(value - values[i])));
  assert.ok(jump(fine) < jump(plain(rough)));
  assert.deepEqual([fine[0], fine[5]], [0, 3]);
});

test("a loop has no jump between its end and its beginning", () => {
  const line = numbers(...Array.from({ length: 30 }, (_, i) => i));
  const played = plain(looped(line, 10));
  assert.equal(played.length, 20);
  assert.equal(played[19], 19);
  for (let i = 0; i < 20; ++i) {
    assert.ok(Math.abs(played[(i + 1) % 20] - played[i]) < 3, `a jump after ${i}`);
  }
  assert.deepEqual(plain(looped(line, 0)), plain(line));
  assert.equal(looped(numbers(1, 2), 9).length, 1);
});

test("a take is trimmed, and plays what the pins did", () => {
  const { pins, motion } = puppetWithPins();
  const frames = [0, 1, 2, 3].map((t) => frameOf(pins.map((pin) => ({ ...pin, x: pin.x + t }))));
  const take: Take = {
    rate: 30,
    body: square,
    starch: null,
    motion,
    pins,
    frames,
    first: 1,
    end: 3,
    smooth: 0,
    loop: 0,
  };
  const played = playedFrames(take);
  assert.equal(played.length, 2);
  assert.equal(pinsAt(pins, played[0])[1].x, pins[1].x + 1);
  assert.equal(playedFrames({ ...take, first: 9, end: 2 }).length, 1);
});

function shapeBytes(int16: boolean, values: number[], facts: object): ArrayBuffer {
  const text = new TextEncoder().encode(JSON.stringify(facts));
  const width = int16 ? 2 : 4;
  const buffer = new ArrayBuffer(16 + width * values.length + text.length);
  const head = new DataView(buffer);
  head.setUint8(0, 1);
  head.setUint8(1, int16 ? 1 : 0);
  head.setUint32(4, 77, true);
  head.setUint32(8, values.length / 2, true);
  head.setUint32(12, text.length, true);
  values.forEach((value, i) =>
    int16 ? head.setInt16(16 + 2 * i, value, true) : head.setFloat32(16 + 4 * i, value, true),
  );
  new Uint8Array(buffer).set(text, 16 + width * values.length);
  return buffer;
}

test("shapes are read as the gateway writes them", () => {
  const facts = { origin: [100, 200], scale: 0.5, flippedIds: [3] };
  for (const int16 of [false, true]) {
    const shape = readShape(shapeBytes(int16, [2, 4, -6, 8], facts));
    assert.equal(shape.sequence, 77);
    assert.deepEqual([...shape.positions], [101, 202, 97, 204]);
    assert.deepEqual(shape.facts.flippedIds, [3]);
  }
  assert.throws(() => readShape(shapeBytes(false, [1, 2], facts).slice(0, 30)), /length/);
  assert.throws(() => readShape(new ArrayBuffer(4)), /version/);
});

test("pictures of a drag that take too long have fewer pixels, and all when it rests", async () => {
  Object.assign(globalThis, { devicePixelRatio: 1 });
  const canvas = { width: 0, height: 0 };
  let asked: (() => void) | undefined;
  const again = new Promise<void>((resolve) => (asked = resolve));
  const detail = new Detail(canvas as HTMLCanvasElement, () => asked!());
  const drag = (pictures: number, ms: number): number => {
    for (let i = 0; i < pictures; ++i) {
      detail.resize(1000, 500, true);
      detail.took(ms);
    }
    assert.equal(canvas.height * 2, canvas.width);
    return canvas.width;
  };
  assert.equal(drag(102, 5), 1000, "quick enough");
  assert.equal(drag(7, 40), 700);
  assert.equal(drag(7, 40), 500);
  assert.equal(drag(50, 40), 500, "not coarser than that");
  assert.equal(drag(50, 5), 500, "no flickering");
  await again;
  detail.resize(1000, 500, true);
  detail.took(100);
  assert.equal(canvas.width, 1000, "the hand rests");
  assert.equal(drag(1, 5), 500);
  detail.resize(1000, 500, false);
  assert.equal(canvas.width, 1000);
});
