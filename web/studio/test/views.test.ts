// Every view of the page: what axe finds, whether it fits, and pictures to look at.
import assert from "node:assert/strict";
import { existsSync, mkdirSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";

import { nothingForAxe } from "./support/axe.js";
import { Stack } from "./support/stack.js";

const stack = new Stack();
before(() => stack.start());
after(() => stack.stop());

const tabs = ["Puppet", "Pins", "Motion", "Take", "Save"];

test("axe finds nothing on any view, light or dark, wide or narrow", async () => {
  for (const colorScheme of ["light", "dark"] as const) {
    for (const width of [390, 1280]) {
      const studio = await stack.open({ colorScheme, viewport: { width, height: 844 } });
      const look = (where: string): Promise<void> =>
        nothingForAxe(studio.page, `${where}, ${colorScheme}, ${width} px`);
      await look("at first");
      await studio.ask("studio.suggestPins(), studio.look({ chosen: 'pin-2' })");
      await studio.ask("studio.changePin('pin-2', { turns: true, firmness: 'soft' })");
      await studio.record(async () => {});
      for (const tab of tabs) {
        await studio.tab(tab);
        await look(tab);
      }
      await studio.page.getByRole("button", { name: "Help" }).click();
      await look("Help");
      await studio.page.context().close();
    }
  }
});

test("nothing is wider than the window, and pictures are taken when somebody wants them", async () => {
  const shots = process.env["ARAP_STUDIO_SHOTS"];
  if (shots && !existsSync(shots)) mkdirSync(shots, { recursive: true });
  const sizes = [
    { width: 390, height: 844 },
    { width: 844, height: 390 },
    { width: 320, height: 640 },
    { width: 1280, height: 800 },
    { width: 2560, height: 1440 },
  ];
  for (const colorScheme of ["light", "dark"] as const) {
    for (const viewport of sizes) {
      const studio = await stack.open({ colorScheme, viewport, hasTouch: viewport.width < 500 });
      const look = async (name: string): Promise<void> => {
        const wide = await studio.ask<number>("document.documentElement.scrollWidth - innerWidth");
        assert.ok(wide <= 0, `${name} is ${wide} px too wide at ${viewport.width}`);
        const file = `${name}-${colorScheme}-${viewport.width}.png`.toLowerCase();
        if (shots) await studio.page.screenshot({ path: join(shots, file) });
      };
      await look("first");
      await studio.ask("studio.suggestPins(), studio.look({ chosen: 'pin-2' })");
      await studio.page.getByRole("button", { name: "Skip" }).click();
      await studio.ask("studio.changePin('pin-2', { turns: true, angle: -0.3 })");
      await studio.ask("studio.movePin('pin-2', { x: 60, y: 640 })");
      await studio.ask("studio.movePin('pin-6', { x: 560, y: 130 })");
      await studio.settle();
      await studio.record(async () => {
        for (let i = 1; i <= 20; ++i) {
          await studio.ask(
            `studio.movePin('pin-3', { x: 554 - ${(i * i) / 4}, y: 498 + ${6 * i} })`,
          );
        }
      });
      for (const tab of tabs) {
        if (tab === "Motion") await studio.ask("studio.look({ wire: true, onion: true })");
        if (tab === "Take") await studio.ask("studio.look({ wire: false, onion: false })");
        await studio.tab(tab);
        await look(tab);
      }
      await studio.page.context().close();
    }
  }
});
