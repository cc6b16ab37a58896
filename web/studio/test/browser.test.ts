// The page as a visitor has it: chromium, the gateway and arapd.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { setTimeout as delay } from "node:timers/promises";

import { Stack, patience } from "./support/stack.js";
import type { Studio } from "./support/stack.js";
import { unzip } from "./support/unzip.js";
import { ringPng } from "./support/png.js";

const stack = new Stack();
before(() => stack.start());
after(() => stack.stop());

/** Pins on the gingerbread figure: head, right hand, left foot. */
async function threePins(studio: Studio): Promise<void> {
  await studio.click(320, 610);
  await studio.click(554, 498);
  await studio.click(186, 80);
  await studio.pinCount(3);
  await studio.settle();
}

async function save(studio: Studio, what: string): Promise<{ name: string; bytes: Buffer }> {
  const coming = studio.page.waitForEvent("download");
  await studio.page.locator(`[data-save=${what}]`).click();
  const download = await coming;
  return { name: download.suggestedFilename(), bytes: readFileSync((await download.path())!) };
}

function bake(files: Map<string, Uint8Array>, name: string): { csv: string; rows: number[][] } {
  for (const [file, bytes] of files) writeFileSync(join(stack.folder, file), bytes);
  const words = new TextDecoder().decode(files.get("README.txt")!).trim().split(" ").slice(1);
  execFileSync(process.env["ARAPCTL"]!, words, { cwd: stack.folder, stdio: "pipe" });
  const csv = readFileSync(join(stack.folder, `${name}.csv`), "utf8");
  const rows = csv
    .trim()
    .split("\n")
    .slice(1)
    .map((line) => line.split(",").slice(1).map(Number));
  return { csv, rows };
}

test("pins are placed and dragged, and what was recorded is what arapctl bakes", async () => {
  const studio = await stack.open();
  await threePins(studio);
  const [x, y] = await studio.at(554, 498);
  await studio.record(async () => {
    await studio.page.mouse.move(x, y);
    await studio.page.mouse.down();
    for (let i = 1; i <= 40; ++i) await studio.page.mouse.move(x - 2 * i, y - 3 * i);
    await studio.page.mouse.up();
  });
  await studio.settle();
  await studio.tab("Save");
  const { bytes } = await save(studio, "track");
  const files = unzip(bytes);
  assert.deepEqual([...files.keys()].sort(), [
    "README.txt",
    "ginger.obj",
    "ginger.png",
    "ginger.track.json",
  ]);
  if (process.env["ARAPCTL"]) {
    const { csv, rows } = bake(files, "ginger");
    assert.equal(bake(files, "ginger").csv, csv);
    // In double precision the gateway answers the very same numbers.
    const first = await studio.ask<number[]>(`(async () => {
      const { take, frames } = takes.film;
      const session = await studio.session.id();
      const set = await studio.session.handleSet(await studio.session.mesh(take), take.pins);
      const targets = take.pins.map((pin, i) => ({ id: pin.id, x: frames[5][4 * i], y: frames[5][4 * i + 1] }));
      const answer = await fetch(\`v1/sessions/\${session}/handle-sets/\${set.id}/deform\`, {
        method: "POST",
        headers: { "content-type": "application/json" },
        body: JSON.stringify({ targets, float64: true }),
      });
      return (await answer.json()).positions;
    })()`);
    assert.deepEqual(first, rows[5]);
    const film = await studio.ask<{ shapes: number[][]; error: number; live: number[] }>(
      "({ shapes: takes.film.shapes.map((shape) => [...shape]), error: takes.film.error, live: [...studio.shape] })",
    );
    assert.equal(rows.length, film.shapes.length);
    const worst = Math.max(
      ...rows.map((row, frame) =>
        Math.max(...row.map((value, i) => Math.abs(value - film.shapes[frame][i]))),
      ),
    );
    assert.ok(worst <= film.error * 1.01 + 1e-9, `${worst} off, where ${film.error} is allowed`);
    // The last frame is the pose that the stream shows.
    const last = rows[rows.length - 1];
    const off = Math.max(...last.map((value, i) => Math.abs(value - film.live[i])));
    assert.ok(off <= film.error * 2 + 1e-9, `the live pose is ${off} off`);
  }
  assert.deepEqual(studio.faults, []);
  await studio.page.context().close();
});

test("two fingers pull two pins at once, in one step of the history", async () => {
  const studio = await stack.open({ hasTouch: true });
  await threePins(studio);
  const cdp = await studio.page.context().newCDPSession(studio.page);
  const [a, b] = [await studio.at(320, 610), await studio.at(554, 498)];
  const touch = (type: string, points: [number, number][]) =>
    cdp.send("Input.dispatchTouchEvent", {
      type: type as "touchStart",
      touchPoints: points.map(([x, y], id) => ({ x, y, id })),
    });
  await touch("touchStart", [a]);
  await touch("touchStart", [a, b]);
  for (let i = 1; i <= 10; ++i) {
    await touch("touchMove", [
      [a[0] - 3 * i, a[1]],
      [b[0], b[1] - 4 * i],
    ]);
  }
  await touch("touchEnd", []);
  await studio.until("studio.puppet.pins[0].x < 310 && studio.puppet.pins[1].y > 510");
  await studio.settle();
  await studio.page.keyboard.press("Control+z");
  const places = await studio.ask<number[][]>("studio.puppet.pins.map((pin) => [pin.x, pin.y])");
  assert.ok(Math.abs(places[0][0] - 320) < 1 && Math.abs(places[1][1] - 498) < 1);
  await studio.settle();
  assert.deepEqual(studio.faults, []);
  await studio.page.context().close();
});

test("everything is undone and redone, and the shape follows", async () => {
  const studio = await stack.open();
  await threePins(studio);
  await studio.ask("studio.movePin('pin-1', { x: 380, y: 560 })");
  await studio.ask("studio.changePin('pin-2', { turns: true, angle: 0.6 })");
  await studio.ask("studio.setMotion({ mode: 'similarity', refine: 2 })");
  await studio.ask("studio.beginPaint(), studio.paint(320, 420), studio.endPaint()");
  await studio.settle();
  await studio.ask("studio.removePin('pin-3', true)");
  await studio.settle();
  for (let i = 0; i < 8; ++i) await studio.page.getByRole("button", { name: "Undo" }).click();
  await studio.pinCount(0);
  await studio.until("studio.history.undoable === undefined");
  await studio.until(
    "studio.shape.every((value, i) => Math.abs(value - studio.puppet.body.rest[i]) < 0.01)",
  );
  for (let i = 0; i < 8; ++i) await studio.page.getByRole("button", { name: "Redo" }).click();
  await studio.pinCount(2);
  await studio.settle();
  // The pose that was kept is the rest, and the pins rest in it.
  await studio.until(
    "studio.shape.every((value, i) => Math.abs(value - studio.puppet.body.rest[i]) < 0.01)",
  );
  assert.deepEqual(studio.faults, []);
  await studio.page.context().close();
});

test("a pin that is removed leaves the pose, when that is asked for", async () => {
  const studio = await stack.open();
  await threePins(studio);
  await studio.ask("studio.movePin('pin-2', { x: 480, y: 640 })");
  await studio.settle();
  const before = await studio.ask<number[]>("[...studio.shape]");
  await studio.page.locator("[data-pin=pin-2]").focus();
  await studio.page.keyboard.press("Shift+Delete");
  await studio.pinCount(2);
  await studio.ask("studio.movePin('pin-1', { x: studio.puppet.pins[0].x + 1 })");
  await studio.settle();
  const after_ = await studio.ask<number[]>("[...studio.shape]");
  const moved = Math.max(...before.map((value, i) => Math.abs(value - after_[i])));
  assert.ok(moved < 3, `the pose has moved by ${moved}`);
  await studio.page.context().close();
});

test("the keyboard places, moves, turns and removes pins", async () => {
  const studio = await stack.open();
  const { page } = studio;
  await page.locator("#stage").focus();
  await page.keyboard.press("Enter");
  await studio.pinCount(1);
  for (let i = 0; i < 12; ++i) await page.keyboard.press("ArrowUp");
  await page.keyboard.press("Enter");
  await studio.pinCount(2);
  await page.locator("[data-pin=pin-2]").focus();
  const y = await studio.ask<number>("studio.puppet.pins[1].y");
  for (let i = 0; i < 3; ++i) await page.keyboard.press("Shift+ArrowUp");
  assert.ok((await studio.ask<number>("studio.puppet.pins[1].y")) > y + 5);
  await page.keyboard.press("[");
  assert.ok(await studio.ask("studio.puppet.pins[1].turns && studio.puppet.pins[1].angle > 0"));
  await studio.settle();
  await page.keyboard.press("Delete");
  await studio.pinCount(1);
  await studio.until("document.activeElement.id === 'stage'");
  await page.keyboard.press("Control+z");
  await studio.pinCount(2);
  await page.keyboard.press("Control+Shift+z");
  await studio.pinCount(1);
  await page.getByRole("tab", { name: "Puppet" }).focus();
  await page.keyboard.press("ArrowRight");
  await page.getByRole("tab", { selected: true, name: "Pins", exact: true }).waitFor();
  await page.context().close();
});

test("a picture with a hole becomes a puppet, and what is none is said", async () => {
  const studio = await stack.open();
  const input = studio.page.locator("input[type=file]");
  await input.setInputFiles({
    name: "ring.png",
    mimeType: "image/png",
    buffer: ringPng(200, 80, 40),
  });
  await studio.until("studio.figure.name === 'ring' && studio.facts?.holes === 1");
  // What the page says follows what it knows.
  await studio.page.locator("[data-facts=mesh]", { hasText: "1 piece, 1 hole" }).waitFor();
  await studio.ask("studio.suggestPins()");
  await studio.ask("studio.movePin('pin-1', { x: 20, y: 20 })");
  await studio.settle();
  await input.setInputFiles({
    name: "notes.txt",
    mimeType: "image/png",
    buffer: Buffer.from("no picture"),
  });
  await studio.page.getByText("notes.txt is no picture that this browser can read.").waitFor();
  await studio.page.getByRole("button", { name: "Undo" }).click();
  await studio.page.getByRole("button", { name: "Undo" }).click();
  await studio.page.getByRole("button", { name: "Undo" }).click();
  await studio.until("studio.figure.name === 'Ginger'");
  for (const [card, holes, pieces] of [
    ["Teapot", 1, 1],
    ["Reef", 0, 3],
  ] as const) {
    await studio.page.getByRole("button", { name: card }).click();
    await studio.until(`studio.figure.name === '${card}' && !studio.working`);
    assert.deepEqual(await studio.ask("[studio.facts.holes, studio.facts.pieces]"), [
      holes,
      pieces,
    ]);
  }
  assert.deepEqual(studio.faults, []);
  await studio.page.context().close();
});

test("the mesh is made anew with another density, and its pins stay on it", async () => {
  const studio = await stack.open();
  await threePins(studio);
  const before = await studio.ask<number>("studio.puppet.body.rest.length");
  await studio.ask("studio.cut({ ...studio.puppet.cut, vertices: 1500 })");
  await studio.until(`studio.puppet.body.rest.length > ${1.5 * before}`);
  await studio.ask("studio.movePin('pin-2', { x: 500, y: 600 })");
  await studio.settle();
  await studio.page.keyboard.press("Control+z");
  await studio.page.keyboard.press("Control+z");
  await studio.until(`studio.puppet.body.rest.length === ${before}`);
  await studio.settle();
  await studio.page.context().close();
});

test("a page that is closed leaves no session behind", async () => {
  const studio = await stack.open();
  const id = await studio.ask<string>("studio.session.id()");
  const status = async (): Promise<number> =>
    (await fetch(`${stack.address}/v1/sessions/${id}`)).status;
  assert.equal(await status(), 200);
  await studio.page.goto("about:blank");
  for (const limit = Date.now() + patience; (await status()) !== 404; await delay(20))
    assert.ok(Date.now() < limit, "the session stays");
  await studio.page.context().close();
});

test("the view is moved and zoomed beside the puppet, and Alt removes a pin", async () => {
  const studio = await stack.open();
  const { page } = studio;
  await threePins(studio);
  await page.getByRole("tab", { selected: true, name: "Pins", exact: true }).waitFor();
  const before = await studio.at(320, 610);
  const [x, y] = await studio.at(20, 20);
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + 60, y - 30);
  await page.mouse.up();
  const moved = await studio.at(320, 610);
  assert.ok(Math.abs(moved[0] - before[0] - 60) < 1 && Math.abs(moved[1] - before[1] + 30) < 1);
  const far = await studio.at(554, 498);
  await page.mouse.move(...moved);
  await page.mouse.wheel(0, -300);
  await studio.until(`stage.inWindow(554, 498)[0] > ${moved[0] + 1.2 * (far[0] - moved[0])}`);
  const zoomed = await studio.at(320, 610);
  assert.ok(Math.hypot(zoomed[0] - moved[0], zoomed[1] - moved[1]) < 1);
  await studio.pinCount(3);
  await page.keyboard.down("Alt");
  await page.mouse.click(...zoomed);
  await page.keyboard.up("Alt");
  await studio.pinCount(2);
  await page.context().close();
});

test("depth decides what is in front", async () => {
  const studio = await stack.open();
  await threePins(studio);
  assert.deepEqual(await studio.ask("[...studio.order]"), []);
  await studio.ask("studio.changePin('pin-2', { depth: 3 })");
  await studio.until("studio.order.length === studio.puppet.body.triangles.length / 3");
  await studio.ask("studio.changePin('pin-2', { depth: 0 })");
  await studio.until("studio.order.length === 0");
  await studio.page.context().close();
});

test("a refused change is said and taken back", async () => {
  const studio = await stack.open();
  await threePins(studio);
  await studio.ask("studio.changePin('pin-1', { firmness: 'soft', weight: 1e30 })");
  await studio.page
    .getByRole("alert")
    .getByText(/weight/)
    .waitFor();
  await studio.until("studio.puppet.pins[0].firmness === 'firm'");
  await studio.ask("studio.movePin('pin-1', { x: 340, y: 600 })");
  await studio.settle();
  await studio.page.context().close();
});

test("a server that is killed under a drag and comes back without anything is caught up with", async () => {
  const studio = await stack.open();
  await threePins(studio);
  const [x, y] = await studio.at(554, 498);
  await studio.page.mouse.move(x, y);
  await studio.page.mouse.down();
  await studio.page.mouse.move(x, y - 20);
  await stack.killServer();
  // The pins go on moving while nobody answers.
  for (let i = 0; i < 10; ++i) await studio.page.mouse.move(x - 3 * i, y - 20 - 3 * i);
  await studio.until("studio.puppet.pins[1].y > 510");
  await studio.page.getByText("Waiting for the server…").waitFor();
  await stack.startServer();
  await studio.page.mouse.move(x - 40, y - 60);
  await studio.page.mouse.up();
  await studio.settle();
  await studio.until("studio.connection === 'live'");
  assert.deepEqual(studio.faults, []);
  await studio.page.context().close();
});

test("a gateway that is killed and comes back is found again, with the pins where they are by then", async () => {
  const studio = await stack.open();
  await threePins(studio);
  await stack.killGateway();
  await studio.until("studio.connection === 'lost'");
  await studio.ask("studio.movePin('pin-2', { x: 500, y: 620 })");
  await studio.ask("studio.addPin(320, 330)");
  await stack.startGateway();
  await studio.settle();
  assert.equal(await studio.ask("studio.puppet.pins.length"), 4);
  await studio.page.context().close();
});

test("a take is trimmed, smoothed and looped, and every file of it can be had", async () => {
  const studio = await stack.open();
  await threePins(studio);
  await studio.record(async () => {
    for (let i = 1; i <= 20; ++i) {
      await studio.ask(`studio.movePin('pin-2', { x: 554 - ${5 * i}, y: 498 + ${4 * i} })`);
    }
  });
  const all = await studio.ask<number>("takes.count");
  await studio.ask("takes.edit({ first: 2, smooth: 3 }, true)");
  await studio.ask("takes.edit({ loop: 4 }, true)");
  await studio.until(`takes.film?.take === takes.take && takes.film.frames.length === ${all - 6}`);
  await studio.ask("takes.edit({ end: 14 }, true)");
  await studio.until("takes.film?.take === takes.take && takes.film.frames.length === 8");
  await studio.page.locator("[data-take=play]").click();
  await studio.until("takes.frame !== undefined");
  await studio.tab("Save");
  const magic: Record<string, (bytes: Buffer) => boolean> = {
    still: (bytes) => bytes.subarray(1, 4).toString() === "PNG",
    svg: (bytes) => bytes.toString().match(/<image /g)?.length === 4,
    gltf: (bytes) => bytes.subarray(0, 4).toString() === "glTF",
    spine: (bytes) => {
      const skeleton = JSON.parse(new TextDecoder().decode(unzip(bytes).get("ginger.json")!));
      return skeleton.animations.take.attachments.default.ginger.ginger.deform.length === 4;
    },
    png: (bytes) => unzip(bytes).size === 8,
  };
  if (await studio.page.locator("[data-save=webm]").isEnabled()) {
    magic["webm"] = (bytes) => bytes.readUInt32BE(0) === 0x1a45dfa3 && bytes.length > 2000;
  }
  for (const [what, isRight] of Object.entries(magic)) {
    const { bytes, name } = await save(studio, what);
    assert.ok(isRight(bytes), `${name} is not what it should be`);
    const shots = process.env["ARAP_STUDIO_SHOTS"];
    if (shots) writeFileSync(join(shots, name), bytes);
  }
  await studio.page.keyboard.press("Control+z");
  await studio.until(`takes.take.end === ${all}`);
  assert.deepEqual(studio.faults, []);
  await studio.page.context().close();
});
