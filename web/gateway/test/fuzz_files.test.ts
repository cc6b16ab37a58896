// Files that are made up or damaged: a surface or a sentence comes of them, and nothing else.
import assert from "node:assert/strict";
import { test } from "node:test";

import { readSurface } from "#gateway/files/format.js";
import { FileFault } from "#gateway/files/surface.js";

import { Dice, bentBytes, files, made, seed } from "./support/dice.js";

const rounds = Number(process.env["ARAP_WEB_ROUNDS"] ?? 3);
const timeout = 240_000 + rounds * 60_000;

test("readers of files", { timeout }, async () => {
  const dice = new Dice(seed);
  let good = 0;
  for (let i = 0; i < 2000 * rounds; i++) {
    const bytes = dice.below(8) === 0 ? made(dice) : bentBytes(dice.of(files), dice);
    const name = dice.of(["", "a.obj", "a.stl", "a.ply", "a.glb", "a"]);
    try {
      const { vertices, triangles } = await readSurface(bytes, name, {
        vertices: 100,
        triangles: 100,
      });
      assert.ok(vertices.every(Number.isFinite));
      assert.ok(triangles.length > 0 && triangles.length % 3 === 0 && triangles.length <= 300);
      assert.ok(triangles.every((index) => 3 * index < vertices.length));
      good++;
    } catch (error) {
      if (!(error instanceof FileFault))
        throw new Error(`${bytes.toString("base64")} as ${name}`, { cause: error });
      // What is told never brings a terminal out of order.
      // eslint-disable-next-line no-control-regex
      assert.doesNotMatch(error.message, /[\u0000-\u001f\u007f]/, bytes.toString("base64"));
    }
  }
  assert.ok(good > 10, `only ${good} could be read`);
});
