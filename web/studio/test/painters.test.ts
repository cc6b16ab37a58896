// The figure and the model as WebGL draws them, and as the page does where there is no graphics processor.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";

import { openPatterns } from "./support/patterns.js";
import { Stack } from "./support/stack.js";
import type { Visit } from "./support/stack.js";

const stack = new Stack();
before(() => stack.start());
after(() => stack.stop());

const nextPicture =
  "new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(null))))";

/** How far two pictures of the same view are apart, in the page of one of them. */
async function compare(visit: Visit, shots: readonly string[]): Promise<void> {
  const [mean, far, ink] = await visit.page.evaluate(async (pictures) => {
    const pixels = [];
    for (const picture of pictures) {
      const bytes = Uint8Array.from(atob(picture), (letter) => letter.charCodeAt(0));
      const bitmap = await createImageBitmap(new Blob([bytes], { type: "image/png" }));
      const canvas = new OffscreenCanvas(bitmap.width, bitmap.height);
      const context = canvas.getContext("2d")!;
      context.drawImage(bitmap, 0, 0);
      pixels.push(context.getImageData(0, 0, bitmap.width, bitmap.height).data);
    }
    const [a, b] = pixels;
    let [sum, far, coloured] = [0, 0, 0];
    for (let i = 0; i < a.length; i += 4) {
      const off = Math.max(...[0, 1, 2].map((k) => Math.abs(a[i + k] - b[i + k])));
      sum += off;
      if (off > 60) far++;
      if (Math.abs(a[i] - a[0]) > 12) coloured++;
    }
    return [sum / (a.length / 4), far / coloured, coloured];
  }, shots);
  assert.ok(ink > 20_000, `${ink} pixels have something`);
  assert.ok(mean < 6 && far < 0.1, `${mean} off in the mean, ${far} of the picture far off`);
  assert.deepEqual(visit.faults, []);
}

test("the page draws the figure that WebGL draws", async () => {
  const shots: string[] = [];
  for (const draw of ["webgl", "page"]) {
    const studio = await stack.open({ viewport: { width: 900, height: 700 } }, `?draw=${draw}`);
    await studio.page.addStyleTag({ content: ".pins, .guide, .toolbar { visibility: hidden }" });
    await studio.ask("studio.suggestPins()");
    await studio.ask("studio.movePin('pin-2', { x: 60, y: 640 }), studio.look({ wire: true })");
    await studio.settle();
    await studio.ask(nextPicture);
    assert.equal(await studio.ask("stage.isFast"), draw === "webgl");
    shots.push((await studio.page.locator("#stage").screenshot()).toString("base64"));
    if (draw === "page") await compare(studio, shots);
    await studio.page.context().close();
  }
});

test("the page draws the model that WebGL draws", async () => {
  const shots: string[] = [];
  for (const draw of ["webgl", "page"]) {
    const options = { viewport: { width: 1100, height: 700 } };
    const page = await openPatterns(stack, options, "", `?draw=${draw}`);
    await page.until("window.model !== undefined");
    await page.tool("Line");
    await page.ask("shop.addPin(45), shop.press({ triangle: 900, weights: [0.5, 0.5, 0] })");
    await page.settle();
    await page.ask("shop.choose('look')");
    await page.ask(nextPicture);
    shots.push((await page.page.locator("#model").screenshot()).toString("base64"));
    if (draw === "page") await compare(page, shots);
    await page.page.context().close();
  }
});
