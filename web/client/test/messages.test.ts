// How updates become fewer, and what is said again after a loss.
import assert from "node:assert/strict";
import { test } from "node:test";

import { packFloat64 } from "../dist/runs.js";
import { fold, isEdit, sequenceOf } from "../dist/stream/messages.js";
import type { Message, Update } from "../dist/stream/messages.js";
import { MergeRule } from "../dist/stream/merge_rule.js";
import { ReplayLog } from "../dist/stream/replay_log.js";

const none = new Uint8Array(0);
const move = (sequence: number, places: Record<string, number>): Message => ({
  update: {
    sequence,
    positions: none,
    pickPoints: none,
    measure: false,
    targets: Object.entries(places).map(([handleId, x]) => ({
      handleId,
      x,
      y: 0,
      angleRadians: 0,
    })),
  },
});
const all = (sequence: number, ...places: number[]): Message => ({
  update: {
    sequence,
    targets: [],
    pickPoints: none,
    positions: packFloat64(places),
    measure: false,
  },
});
const edit = (sequence: number, remove: string[] = [], add: string[] = []): Message => ({
  edit: { sequence, remove, add: add.map((handleId) => ({ handleId, vertex: 0 })) },
});

/** Sequences and places, for comparing. */
const told = (messages: readonly Message[]): string[] =>
  messages.map((message) => {
    if (isEdit(message)) return `${message.edit.sequence} edit`;
    const { sequence, targets, positions } = message.update;
    const places = targets.map((target) => `${target.handleId}=${String(target.x)}`);
    return `${sequence} ${positions.length > 0 ? `all ${positions.length / 16}` : places.join(" ")}`;
  });

test("updates that newer ones replace become one, and no target is lost", () => {
  const messages = [move(1, { a: 1 }), move(2, { b: 2 }), move(3, { a: 3 }), move(4, { c: 4 })];
  assert.deepEqual(told(fold(messages)), ["3 a=3 b=2", "4 c=4"]);
});

test("what answers in the place of an update that asks to be measured asks too", () => {
  const asking = (sequence: number): Message => {
    const message = move(sequence, { a: sequence });
    return isEdit(message) ? message : { update: { ...message.update, measure: true } };
  };
  const messages = [move(1, { a: 1 }), asking(2), move(3, { a: 3 }), edit(4), move(5, { a: 5 })];
  const asks = fold(messages).map((message) => !isEdit(message) && message.update.measure);
  assert.deepEqual(asks, [false, true, false, false]);
});

test("all positions at once stand between what came before and after", () => {
  const messages = [
    move(1, { a: 1 }),
    all(2, 0, 0),
    move(3, { b: 3 }),
    all(4, 0, 0),
    move(5, { a: 5 }),
    move(6, { a: 6 }),
  ];
  assert.deepEqual(told(fold(messages)), ["3 a=1 b=3", "4 all 1", "5 a=5", "6 a=6"]);
});

test("the last update before an edit stays, and so does what may not be merged", () => {
  const messages = [
    move(1, { a: 1 }),
    move(2, { a: 2 }),
    edit(3),
    move(4, { a: 4 }),
    move(5, { x: 5 }),
    move(6, { a: 6 }),
  ];
  const mayMerge = (update: Update): boolean => update.targets[0]?.handleId !== "x";
  assert.deepEqual(told(fold(messages, mayMerge)), [
    "1 a=1",
    "2 a=2",
    "3 edit",
    "4 a=4",
    "5 x=5",
    "6 a=6",
  ]);
});

test("only what is surely good is merged", () => {
  const rule = new MergeRule();
  const update = (message: Message): Update => (isEdit(message) ? assert.fail() : message.update);
  const handles = ["a", "b"].map((id) => ({
    id,
    rest: [0, 0] as const,
    snappedDistance: 0,
    component: 0,
  }));
  rule.restart({ handles } as never);
  assert.ok(rule.allows(update(move(1, { a: 1, b: 2 }))));
  assert.ok(!rule.allows(update(move(1, { c: 1 }))));
  assert.ok(!rule.allows(update(move(1, { a: Number.NaN }))));
  assert.ok(rule.allows(update(all(1, 0, 0, 1, 1))));
  assert.ok(!rule.allows(update(all(1, 0, 0))));
  assert.ok(!rule.allows(update(all(1, 0, 0, Infinity, 1))));
  // Which handles there are after an edit shows when it is answered.
  rule.sent({ sequence: 2, remove: ["a"], add: [{ handleId: "c" }] });
  assert.ok(!rule.allows(update(move(3, { b: 1 }))));
  rule.answered(2, true);
  assert.ok(rule.allows(update(move(3, { b: 1, c: 1 }))));
  assert.ok(!rule.allows(update(move(3, { a: 1 }))));
  rule.sent({ sequence: 4, remove: ["b"] });
  rule.answered(4, false);
  assert.ok(rule.allows(update(move(5, { b: 1 }))));
});

test("after a loss the edits are said again with the targets before each, then the rest", () => {
  const log = new ReplayLog(true);
  for (const message of [
    move(1, { a: 1 }),
    move(2, { b: 2 }),
    edit(3, [], ["c"]),
    move(4, { c: 4 }),
    move(5, { c: 5 }),
  ]) {
    log.sent(message);
  }
  assert.equal(log.answered(2, true), true);
  assert.equal(log.answered(3, true), true);
  assert.equal(log.answered(3, true), false, "it had come before");
  assert.equal(log.pending, 2);
  assert.deepEqual(told(log.messages()), ["2 a=1 b=2", "3 edit", "4 c=4", "5 c=5"]);
  log.answered(5, true);
  assert.deepEqual(told(log.messages()), ["2 a=1 b=2", "3 edit", "5 c=5"]);
});

test("what was answered by an error is forgotten, what it replaced is not", () => {
  const log = new ReplayLog(true);
  for (const message of [move(1, { a: 1 }), move(2, { a: Number.NaN })]) log.sent(message);
  log.answered(2, false);
  assert.deepEqual(told(log.messages()), ["1 a=1"]);
});

test("a latest stream keeps a few hundred updates that wait, an every stream all", () => {
  for (const [latest, most] of [
    [true, 260],
    [false, 5000],
  ] as const) {
    const log = new ReplayLog(latest);
    for (let i = 1; i <= 5000; i++) log.sent(move(i, { [`h${i % 3}`]: i }));
    const messages = log.messages();
    assert.ok(messages.length <= most, `${messages.length}`);
    if (!latest) assert.equal(messages.length, 5000);
    assert.equal(sequenceOf(messages.at(-1)!), 5000);
    const sequences = messages.map(sequenceOf);
    assert.ok(sequences.every((sequence, i) => i === 0 || sequence > sequences[i - 1]!));
  }
});
