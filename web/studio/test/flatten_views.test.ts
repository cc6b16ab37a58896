// Every view of the flatten page: what axe finds, whether it fits, and pictures to look at.
import assert from "node:assert/strict";
import { mkdirSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";

import { nothingForAxe } from "./support/axe.js";
import { obj, shell } from "./support/models.js";
import { openPatterns } from "./support/patterns.js";
import type { Patterns } from "./support/patterns.js";
import { Stack } from "./support/stack.js";

const stack = new Stack();
before(() => stack.start());
after(() => stack.stop());

const tabs = ["Model", "Seams", "Layout", "Report", "Save"];

/** A click on a vertex, wherever it is. */
const press = (vertex: number): string => `(() => {
  const corner = shop.surface.triangles.indexOf(${vertex});
  const weights = [0, 1, 2].map((k) => (k === corner % 3 ? 1 : 0));
  shop.press({ triangle: Math.floor(corner / 3), weights });
})()`;

/** A seam down the sleeve, a pin, and two methods. */
async function work(page: Patterns): Promise<void> {
  await page.page.getByRole("button", { name: "Skip" }).click();
  await page.tool("Path");
  // Under the arm, from the shoulder to the wrist.
  for (const vertex of [20, 34 * 40 + 20]) await page.ask(press(vertex));
  await page.until("shop.pattern.seams.length > 0");
  await page.settle();
  await page.ask("shop.addGrain(34 * 40, 40)");
  await page.settle();
}

test("axe finds nothing on any view, light or dark, wide or narrow", async () => {
  for (const colorScheme of ["light", "dark"] as const) {
    for (const width of [390, 1280]) {
      const page = await openPatterns(stack, { colorScheme, viewport: { width, height: 844 } });
      const look = (where: string): Promise<void> =>
        nothingForAxe(page.page, `${where}, ${colorScheme}, ${width} px`);
      await look("at first");
      await work(page);
      await page.ask("shop.addPin(45), shop.change({ other: 'lscm' }, ''), shop.press(null)");
      await page.until("shop.flat.layouts.length === 2");
      await page.settle();
      for (const tab of tabs) {
        await page.tab(tab);
        await look(tab);
      }
      const small = shell();
      small.vertices = small.vertices.map((vertex) => vertex.map((value) => value / 1000));
      await page.upload("small.obj", obj(small));
      await page.flat("small");
      await page.page.locator("[data-notice=unit]").waitFor();
      await look("the unit is asked for");
      await page.upload("bad.obj", "f 1 2 3\n");
      await page.page.locator(".toast p").waitFor();
      await page.ask("shop.cancel()");
      await look("cancelled, with a bad file");
      await page.page.getByRole("button", { name: "Help" }).click();
      await look("Help");
      await page.page.context().close();
    }
  }
});

test("nothing is wider than the window, and pictures are taken when somebody wants them", async () => {
  const shots = process.env["ARAP_STUDIO_SHOTS"];
  if (shots) mkdirSync(shots, { recursive: true });
  const sizes = [
    { width: 390, height: 844 },
    { width: 844, height: 390 },
    { width: 320, height: 640 },
    { width: 1280, height: 800 },
    { width: 2560, height: 1440 },
  ];
  // Dark is as wide as light.
  for (const colorScheme of shots ? (["light", "dark"] as const) : (["light"] as const)) {
    for (const viewport of sizes) {
      const hasTouch = viewport.width < 500;
      const page = await openPatterns(stack, { colorScheme, viewport, hasTouch });
      const look = async (name: string): Promise<void> => {
        const wide = await page.ask<number>("document.documentElement.scrollWidth - innerWidth");
        assert.ok(wide <= 0, `${name} is ${wide} px too wide at ${viewport.width}`);
        const file = `flatten-${name}-${colorScheme}-${viewport.width}.png`.toLowerCase();
        if (shots) await page.page.screenshot({ path: join(shots, file) });
      };
      await look("first");
      await work(page);
      for (const tab of tabs) {
        if (tab === "Layout" || tab === "Save") {
          await page.ask(`shop.change({ other: ${tab === "Layout" ? "'lscm'" : "null"} }, '')`);
          await page.settle();
        }
        await page.tab(tab);
        await look(tab);
      }
      await page.page.context().close();
    }
  }
});
