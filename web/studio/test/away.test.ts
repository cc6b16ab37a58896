// Without its server the page stays usable, says what is missing, and goes on when it is back.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { after, before, test } from "node:test";

import { Stack } from "./support/stack.js";

const stack = new Stack();
before(() => stack.start());
after(() => stack.stop());

test("a page that has gone offline is usable, and catches up", async () => {
  const studio = await stack.open();
  const { page } = studio;
  await studio.ask("studio.suggestPins()");
  await studio.settle();
  await page.context().setOffline(true);
  await stack.killGateway();
  await page.getByText("Connection lost, trying again…").waitFor();

  // Pins are placed and moved, and taken back; tabs, views and help open; colours change.
  const count = await studio.ask<number>("studio.puppet.pins.length");
  await studio.ask("studio.movePin('pin-2', { x: 500, y: 620 })");
  await studio.ask("studio.addPin(320, 330)");
  await studio.pinCount(count + 1);
  await page.keyboard.press("Control+z");
  await studio.pinCount(count);
  for (const tab of ["Puppet", "Motion", "Take", "Save"]) await studio.tab(tab);
  await page.getByRole("button", { name: "Help" }).click();
  await page.getByRole("dialog").getByRole("button", { name: "Close" }).click();
  await page.getByRole("button", { name: "Closer" }).click();

  // What the page has is saved.
  const coming = page.waitForEvent("download");
  await page.locator("[data-save=still]").click();
  const png = readFileSync((await (await coming).path())!);
  assert.equal(png.subarray(1, 4).toString(), "PNG");

  // A take is recorded, and its shapes wait.
  await studio.tab("Take");
  await page.locator("[data-take=record]").click();
  for (let i = 1; i <= 10; ++i)
    await studio.ask(`studio.movePin('pin-2', { x: ${500 - 5 * i}, y: 620 })`);
  await studio.until("takes.recorded > 0.3");
  await page.locator("[data-take=record]").click();
  await page.getByText("The shapes of the take are computed when it is back.").waitFor();
  // Another puppet needs the server, which is said; nobody waits for it who goes on with this one.
  await studio.tab("Puppet");
  await page.getByRole("button", { name: /Teapot/ }).click();
  await page.getByText("The server does not answer. Trying again…").waitFor();

  await stack.startGateway();
  await page.context().setOffline(false);
  await studio.until(
    "studio.figure.name !== 'Ginger' && studio.puppet.body !== null && !studio.working",
  );
  await studio.settle();
  await page.keyboard.press("Control+z");
  await studio.until("takes.film !== undefined && takes.film.take === takes.take");
  await studio.settle();
  await studio.until("studio.connection === 'live'");
  assert.deepEqual(studio.faults, []);
  await page.context().close();
});

test("a page that is opened while there is no arapd says so, and begins when there is", async () => {
  await stack.killServer();
  const page = await stack.visit();
  await page.getByText("The server does not answer. Trying again…").waitFor();
  await stack.startServer();
  const limit = Date.now() + 120_000;
  while (!(await page.evaluate("studio.connection === 'live' && studio.isSettled"))) {
    assert.ok(Date.now() < limit, "the page does not begin");
  }
  await page.context().close();
});
