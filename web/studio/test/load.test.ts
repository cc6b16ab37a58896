// The load page as an operator has it, with a little load.
import assert from "node:assert/strict";
import { mkdirSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { setTimeout as delay } from "node:timers/promises";

import type { Page } from "playwright-core";

import { nothingForAxe } from "./support/axe.js";
import { Stack, patience } from "./support/stack.js";
import type { Studio } from "./support/stack.js";

const stack = new Stack(true);
before(() => stack.start());
after(() => stack.stop());

async function until(
  page: Page,
  isSo: () => boolean | Promise<boolean>,
  what: string,
): Promise<void> {
  const limit = Date.now() + patience;
  while (!(await isSo())) {
    if (Date.now() > limit) assert.fail(`${what}: ${await page.locator("main").innerText()}`);
    await delay(50);
  }
}
const told = (page: Page, key: string): Promise<string> =>
  page.locator(`[data-load="${key}"]`).innerText();

/** Drags for as long as `use` goes on. */
async function underLoad(use: () => Promise<void>): Promise<void> {
  const studio: Studio = await stack.open();
  await studio.ask("studio.suggestPins()");
  await studio.settle();
  let goes = true;
  const drags = (async () => {
    for (let i = 0; goes; ++i) {
      await studio.ask(`studio.movePin('pin-2', { x: ${500 + 40 * Math.sin(i / 5)}, y: 520 })`);
      await delay(20);
    }
  })();
  try {
    await use();
  } finally {
    goes = false;
    await drags;
    await studio.page.context().close();
  }
}

test("rates, times, queues and sessions are seen, and stand still in a pause", async () => {
  const page = await stack.visit({}, "load.html");
  await page.getByText("Live", { exact: true }).waitFor();
  await underLoad(async () => {
    const number = async (key: string): Promise<number> => parseFloat(await told(page, key));
    await until(page, async () => (await number("shapes.computed")) > 0, "shapes");
    await until(page, async () => (await number("shapes.sent")) > 0, "sent");
    await until(page, async () => (await number("shapeTime.median")) > 0, "times");
    await until(page, async () => (await number("queueTime.p99")) >= 0, "queue");
    await until(page, async () => (await told(page, "open.sessions")) === "1", "sessions");
    await until(page, async () => (await told(page, "open.sockets")) === "1", "sockets");
    assert.match(await told(page, "waiting.interactive"), /^\d+$/);
    assert.match(await told(page, "memory.server"), /^\d+ MiB$/);
    assert.match(await told(page, "busy.interactive"), /^\d+ %$/);
    assert.match(
      await page.locator("main .facts").innerText(),
      /arapd \d+\.\d+\.\d+, up for .*gateway up for/,
    );
    // A line is drawn, and what is drawn is said.
    await until(
      page,
      async () =>
        /L/.test((await page.locator("[data-chart=shapes] .line-0").getAttribute("d")) ?? ""),
      "a line",
    );
    const label = await page.locator("[data-chart=shapes] svg").getAttribute("aria-label");
    assert.match(
      label ?? "",
      /^Shapes: computed .*\/s, sent to pages .*\/s, replaced by newer ones /,
    );
    const row = page.getByRole("row", { name: /^Shapes: computed/ });
    await until(page, async () => /\d\/s/.test(await row.innerText()), "the table");

    await page.getByRole("button", { name: "Pause" }).click();
    await page.getByText("Paused").waitFor();
    const before = await page.evaluate("load.watch.moments.length");
    await delay(2500);
    assert.equal(await page.evaluate("load.watch.moments.length"), before);
    // A moment is looked at by keyboard.
    const slider = page.getByLabel("Moment");
    await slider.focus();
    for (let i = 0; i < 2; ++i) await page.keyboard.press("ArrowLeft");
    assert.match((await slider.getAttribute("aria-valuetext")) ?? "", /s ago$/);
    assert.equal(
      await page.locator("[data-chart=shapes] .cursor").getAttribute("visibility"),
      "visible",
    );
    await page.keyboard.press("End");
    assert.equal(await slider.getAttribute("aria-valuetext"), "now");
    await page.getByRole("button", { name: "Go on" }).click();
    await page.getByText("Live", { exact: true }).waitFor();
  });
  await until(page, async () => (await told(page, "open.sockets")) === "0", "the socket is gone");
  await page.context().close();
});

test("what is refused is listed by its reason", async () => {
  const page = await stack.visit({}, "load.html");
  await page.getByText("Live", { exact: true }).waitFor();
  await page.getByRole("cell", { name: "Nothing." }).waitFor();
  await fetch(`${stack.address}/v1/sessions/none`);
  await page.getByRole("row", { name: "NOT_FOUND gateway 1" }).waitFor();
  await page.context().close();
});

test("a server that is gone, and a gateway that is, are told and found again", async () => {
  const page = await stack.visit({}, "load.html");
  await page.getByText("Live", { exact: true }).waitFor();
  await until(page, async () => (await told(page, "memory.server")) !== "–", "memory");
  await stack.killServer();
  await page
    .getByRole("alert")
    .getByText(/admin page does not answer/)
    .waitFor();
  await until(page, async () => (await told(page, "memory.server")) === "–", "nothing is known");
  await until(
    page,
    async () => /MiB/.test(await told(page, "memory.gateway")),
    "the gateway goes on",
  );
  await stack.startServer();
  await until(page, async () => /MiB/.test(await told(page, "memory.server")), "it is back");
  await stack.killGateway();
  await page.getByText("The gateway does not answer. Trying again…").waitFor();
  await stack.startGateway();
  await page.getByText("Live", { exact: true }).waitFor();
  await page.context().close();
});

test("axe finds nothing, nothing is too wide, and pictures are taken when somebody wants them", async () => {
  const shots = process.env["ARAP_STUDIO_SHOTS"];
  if (shots) mkdirSync(shots, { recursive: true });
  await underLoad(async () => {
    for (const colorScheme of ["light", "dark"] as const) {
      for (const viewport of [
        { width: 320, height: 640 },
        { width: 390, height: 844 },
        { width: 1280, height: 800 },
        { width: 2560, height: 1440 },
      ]) {
        const where = `${colorScheme}, ${viewport.width} px`;
        const page = await stack.visit({ colorScheme, viewport }, "load.html");
        await page.getByText("Live", { exact: true }).waitFor();
        await until(page, async () => parseFloat(await told(page, "shapes.sent")) > 0, where);
        if (shots && viewport.width > 320) await delay(15_000); // so that there is something to see
        const wide = await page.evaluate("document.documentElement.scrollWidth - innerWidth");
        assert.ok((wide as number) <= 0, `${where} is ${wide} px too wide`);
        if (shots) {
          const file = join(shots, `load-${colorScheme}-${viewport.width}.png`);
          await page.screenshot({ path: file });
        }
        await nothingForAxe(page, where);
        await page.context().close();
      }
    }
  });
});
