// The flatten page as a visitor has it: chromium, the gateway and arapd.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";

import {
  along,
  girth,
  glb,
  height,
  obj,
  ply,
  shell,
  stl,
  tube,
  tubeVertex,
} from "./support/models.js";
import type { Model } from "./support/models.js";
import { openPatterns } from "./support/patterns.js";
import { Stack } from "./support/stack.js";
import { unzip } from "./support/unzip.js";

const stack = new Stack();
before(() => stack.start());
after(() => stack.stop());

const closed: Model = {
  vertices: [
    [0, 0, 0],
    [90, 0, 0],
    [0, 90, 0],
    [0, 0, 90],
  ],
  triangles: [
    [0, 2, 1],
    [0, 1, 3],
    [1, 2, 3],
    [2, 0, 3],
  ],
};

/** The size in millimetres of what a group of an SVG in millimetres draws. */
function measured(svg: string, group: string): [number, number] {
  const [, box] = /viewBox="([^"]*)"/.exec(svg)!;
  const [, width] = /width="([\d.]+)mm"/.exec(svg)!;
  const scale = Number(width) / Number(box.split(" ")[2]);
  const [, content] = new RegExp(`<g id="${group}"[^>]*>([\\s\\S]*?)</g>`).exec(svg)!;
  const xs: number[] = [];
  const ys: number[] = [];
  for (const [, path] of content.matchAll(/ d="([^"]*)"/g)) {
    let [x, y] = [0, 0];
    for (const [, kind, numbers] of path.matchAll(/([MLHVmlhv])([^A-Za-z]*)/g)) {
      const values = [...numbers.matchAll(/-?[\d.]+(?:e-?\d+)?/g)].map(Number);
      const relative = kind === kind.toLowerCase();
      const step = /[hv]/i.test(kind) ? 1 : 2;
      for (let i = 0; i < values.length; i += step) {
        const [base, other] = relative ? [x, y] : [0, 0];
        if (/h/i.test(kind)) x = base + values[i];
        else if (/v/i.test(kind)) y = other + values[i];
        else [x, y] = [base + values[i], other + values[i + 1]];
        xs.push(x);
        ys.push(y);
      }
    }
  }
  const span = (all: number[]): number => scale * (Math.max(...all) - Math.min(...all));
  return [span(xs), span(ys)];
}

test("a seam picked on the model lays a tube flat, and the SVG has its true size", async () => {
  const page = await openPatterns(stack);
  await page.upload("tube.obj", obj(tube()));
  await page.flat("tube");
  await page.tool("Path");
  // From the upper rim to the lower one, on the side that is seen.
  await page.click("model", tubeVertex(1, along), tubeVertex(1, along - 1));
  await page.until("shop.looks.from !== null");
  await page.click("model", tubeVertex(1, 0), tubeVertex(1, 1));
  await page.until("shop.pattern.seams.length > 0");
  const seam = await page.ask<number[][]>(
    "shop.pattern.seams.map((edge) => [shop.edges.ends[2 * edge], shop.edges.ends[2 * edge + 1]])",
  );
  const column = Array.from({ length: along }, (_, j) => [tubeVertex(1, j), tubeVertex(1, j + 1)]);
  const sorted = (pairs: number[][]): string[] =>
    pairs.map((pair) => [...pair].sort((a, b) => a - b).join("-")).sort();
  assert.deepEqual(sorted(seam), sorted(column));
  await page.settle();
  assert.equal(await page.ask("shop.layout.pieces.length"), 1);
  assert.equal(await page.ask("shop.layout.autoCuts.length"), 0);
  await page.tab("Save");
  await page.page.getByLabel("Seam allowance").fill("0");
  await page.page.getByLabel("Seam allowance").blur();
  const { name, bytes } = await page.save("svg");
  assert.equal(name, "tube.svg");
  const svg = bytes.toString();
  // The rims are the outline, the seam is drawn as one.
  const [w, h] = measured(svg, "outline");
  const sizes = [w, h].sort((a, b) => b - a);
  // The layout may be turned: its diagonal is not.
  assert.ok(Math.abs(Math.hypot(...sizes) - Math.hypot(girth, height)) < 0.05 * height, `${sizes}`);
  const uv = await page.ask<number[][]>(
    `[${tubeVertex(2, 0)}, ${tubeVertex(14, 0)}, ${tubeVertex(14, along)}].map((vertex) => [shop.layout.uv[2 * vertex], shop.layout.uv[2 * vertex + 1]])`,
  );
  const long = (a: number[], b: number[]): number => Math.hypot(a[0] - b[0], a[1] - b[1]);
  assert.ok(Math.abs(long(uv[0], uv[1]) - girth / 2) < 1e-3);
  assert.ok(Math.abs(long(uv[1], uv[2]) - height) < 1e-3);
  assert.deepEqual(page.faults, []);
  await page.page.context().close();
});

test("every format is read, at the size that it has", async () => {
  const page = await openPatterns(stack);
  const model = shell();
  for (const [name, content] of [
    ["a.obj", obj(model)],
    ["b.ply", ply(model)],
    ["c.stl", stl(model)],
    ["d.glb", glb(model)],
  ] as const) {
    await page.upload(name, content);
    await page.flat(name[0]);
    assert.equal(await page.ask("shop.surface.triangles.length / 3"), model.triangles.length);
    const [w, h] = await page.ask<number[]>(
      "(({ width, height }) => [width, height].map((x) => x * shop.pattern.millimetresPerUnit))(shop.layout.pieces[0])",
    );
    const off = Math.abs(Math.hypot(w, h) - Math.hypot(girth / 2, height));
    assert.ok(off < 0.15 * height, `${name}: ${w} × ${h}`);
    const area = await page.ask<number>(
      "shop.layout.pieces[0].area * shop.pattern.millimetresPerUnit ** 2",
    );
    assert.ok(Math.abs(area / ((girth / 2) * height) - 1) < 1e-4, `${name}: ${area}`);
  }
  assert.deepEqual(page.faults, []);
  await page.page.context().close();
});

test("a bad file is refused with the line, and the model stays", async () => {
  const page = await openPatterns(stack);
  await page.upload("bad.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
  const said = page.page.locator(".toast");
  await said.getByText(/bad\.obj cannot be read: .*[Ll]ine 4/).waitFor();
  await page.settle();
  assert.equal(await page.ask("shop.surface.name"), "Sleeve");
  await page.upload("empty.obj", "v 0 0 0\n");
  await said.getByText(/empty\.obj/).waitFor();
  assert.deepEqual(page.faults, []);
  await page.page.context().close();
});

test("what is pointed at in one view is marked in the other; a click chooses its piece", async () => {
  const page = await openPatterns(stack);
  await page.upload("tube.obj", obj(tube()));
  await page.flat("tube");
  const marked = `(() => {
    const [, over] = document.querySelectorAll("#layout-0 canvas");
    const { data } = over.getContext("2d").getImageData(0, 0, over.width, over.height);
    return data.some((value, i) => i % 4 === 3 && value > 0);
  })()`;
  assert.equal(await page.ask(marked), false);
  await page.page.mouse.move(...(await page.at("model", tubeVertex(1, 4), tubeVertex(2, 5))));
  await page.until("shop.looks.hover !== null");
  const triangle = await page.ask<number>("shop.looks.hover.triangle");
  const corners = await page.ask<number[]>(
    `[...shop.surface.triangles.slice(${3 * triangle}, ${3 * triangle + 3})]`,
  );
  assert.ok(corners.includes(tubeVertex(1, 4)), `${corners}`);
  await page.page.locator("[data-under]").getByText(`triangle ${triangle}:`).waitFor();
  await page.until(marked);
  // The other way round, at a corner that has one copy only.
  const single = await page.ask<number>(
    "[...shop.layout.uvVertex].findIndex((vertex, i, all) => vertex > 60 && all.indexOf(vertex) === all.lastIndexOf(vertex))",
  );
  const [neighbour] = await page.ask<number[]>(
    `[...shop.surface.triangles].map((v, i, all) => v === ${single} ? all[3 * Math.floor(i / 3) + (i + 1) % 3] : -1).filter((v) => v >= 0)`,
  );
  await page.page.mouse.move(...(await page.at("views[0]", single, neighbour)));
  await page.until(
    `[0, 1, 2].some((k) => shop.surface.triangles[3 * (shop.looks.hover?.triangle ?? -1) + k] === ${single})`,
  );
  await page.page.mouse.down();
  await page.page.mouse.up();
  await page.until("shop.looks.chosenTriangle === shop.looks.hover.triangle");
  await page.tab("Report");
  await page.page.getByText("Piece 1, chosen").waitFor();
  assert.deepEqual(page.faults, []);
  await page.page.context().close();
});

test("downloads are what they say, on paper and roll too", async () => {
  const page = await openPatterns(stack);
  const pdf = await page.save("pdf");
  assert.equal(pdf.name, "sleeve.pdf");
  assert.equal(pdf.bytes.subarray(0, 5).toString(), "%PDF-");
  const dxf = await page.save("dxf");
  assert.match(dxf.bytes.toString(), /SECTION[\s\S]*OUTLINE[\s\S]*EOF\s*$/);
  const made = (await page.save("obj")).bytes.toString();
  assert.equal(made.match(/^v /gm)!.length, await page.ask("shop.surface.vertices.length / 3"));
  assert.equal(made.match(/^vt /gm)!.length, await page.ask("shop.layout.uv.length / 2"));
  await page.page.getByLabel("Print on").selectOption("A4");
  const pages = await page.save("svg");
  assert.equal(pages.name, "sleeve-svg.zip");
  const files = [...unzip(pages.bytes).keys()];
  assert.ok(files.includes("sleeve-cover.svg") && files.length > 3, `${files}`);
  await page.page.getByLabel("Print on").selectOption("roll");
  await page.page.getByLabel("Width of the roll").fill("900");
  await page.page.getByLabel("Width of the roll").blur();
  const rolled = (await page.save("svg")).bytes.toString();
  assert.match(rolled, /<svg/);
  assert.deepEqual(page.faults, []);
  await page.page.context().close();
});

test("a flattening is cancelled, and tried again", async () => {
  const page = await openPatterns(stack);
  await page.tab("Layout");
  stack.pauseServer();
  try {
    await page.page.getByLabel("What the layout keeps").selectOption("lscm");
    await page.page.locator("[data-job=cancel]").click();
    await page.until("shop.flat.state === 'cancelled'");
  } finally {
    stack.resumeServer();
  }
  await page.page.getByRole("button", { name: "Try again" }).click();
  await page.settle();
  assert.equal(await page.ask("shop.layout.method"), "lscm");
  assert.deepEqual(page.faults, []);
  await page.page.context().close();
});

test("seams are undone, redone, closed one by one and all together", async () => {
  const page = await openPatterns(stack);
  await page.upload("tube.obj", obj(tube()));
  await page.flat("tube");
  await page.tool("Line");
  await page.click("model", tubeVertex(1, 4), tubeVertex(1, 5));
  await page.until("shop.pattern.seams.length === 8");
  await page.settle(); // or the piece moves under the next click
  await page.tool("Edge");
  await page.click("views[0]", tubeVertex(6, 4), tubeVertex(6, 5));
  await page.until("shop.pattern.seams.length === 9");
  const count = (wanted: number): Promise<void> =>
    page.until(`shop.pattern.seams.length === ${wanted}`);
  await page.page.getByRole("button", { name: "Undo" }).click();
  await count(8);
  await page.page.keyboard.press("Control+Shift+z");
  await count(9);
  await page.tab("Seams");
  await page.page.locator("[data-list=seams] button").last().click();
  await count(8);
  await page.page.getByRole("button", { name: "Close all seams" }).click();
  await count(0);
  await page.settle();
  assert.ok((await page.ask<number>("shop.layout.autoCuts.length")) > 0);
  // Without cuts what is closed cannot lie flat: the page says so and helps.
  await page.page.getByLabel("Cut by itself where it must").uncheck();
  await page.upload("closed.obj", obj(closed));
  await page.page.getByRole("button", { name: "Cut it by itself" }).click();
  await page.settle();
  assert.deepEqual(page.faults, []);
  await page.page.context().close();
});

test("with the keyboard alone: a tool, a seam along the edges, a pin, a file", async () => {
  const page = await openPatterns(stack);
  const { keyboard } = page.page;
  // The first stop is the way past the head.
  await keyboard.press("Tab");
  await keyboard.press("Enter");
  await page.until("document.activeElement.id === 'model'");
  const before = await page.ask("model.inWindow(0)");
  await keyboard.press("ArrowLeft");
  await keyboard.press("+");
  assert.notDeepEqual(await page.ask("model.inWindow(0)"), before);
  await page.page.locator("[data-tool=edge]").focus();
  await keyboard.press("Enter");
  await page.page.locator("#model").focus();
  await keyboard.press("Shift+ArrowUp"); // stands in the middle
  await page.until("shop.looks.cursor !== null");
  for (let i = 1; i <= 3; ++i) {
    await keyboard.press("Shift+ArrowUp");
    await page.until("shop.looks.cursor.edge >= 0");
    await keyboard.press("Enter");
    await page.until(`shop.pattern.seams.length === ${i}`);
  }
  await page.settle();
  await page.page.locator("[data-tool=pin]").focus();
  await keyboard.press("Enter");
  await page.page.locator("#layout-0").focus();
  await keyboard.press("Enter");
  await page.until("shop.pattern.pins.length === 1");
  await page.settle();
  await page.page.locator("[data-pin]").focus();
  const u = await page.ask<number>("shop.pattern.pins[0].u");
  await keyboard.press("Shift+ArrowRight");
  await page.until(`Math.abs(shop.pattern.pins[0].u - ${u} - 10) < 1e-6`);
  await page.settle();
  const held = await page.ask<number>("shop.layout.uv[2 * shop.pattern.pins[0].vertex]");
  assert.ok(Math.abs(held - u - 10) < 1e-3, `${held} is not ${u + 10}`);
  await keyboard.press("Delete");
  await page.until("shop.pattern.pins.length === 0");
  await page.page.getByRole("tab", { name: "Model" }).focus();
  for (let i = 0; i < 4; ++i) await keyboard.press("ArrowRight");
  await page.page.locator("[data-save=svg]").focus();
  const coming = page.page.waitForEvent("download");
  await keyboard.press("Enter");
  assert.equal((await coming).suggestedFilename(), "sleeve.svg");
  assert.deepEqual(page.faults, []);
  await page.page.context().close();
});

test("two methods are beside each other, with one report and one scale; a grain line turns a piece", async () => {
  const page = await openPatterns(stack);
  await page.page.locator("[data-sample='1']").click();
  await page.flat("Top");
  await page.tab("Layout");
  await page.page.getByLabel("Beside it").selectOption("lscm");
  await page.until("shop.flat.layouts.length === 2");
  await page.settle();
  await page.page.locator("#layout-1").waitFor();
  await page.tab("Report");
  const energies = await page.page.locator("[data-row=energy] td").allTextContents();
  assert.equal(energies.length, 2);
  assert.ok(Number(energies[0]) < Number(energies[1]), `${energies}`);
  await page.ask("shop.addGrain(0, 29 * 20)");
  await page.settle();
  const [dx, dy] = await page.ask<number[]>(
    "[0, 1].map((k) => shop.layout.uv[2 * 29 * 20 + k] - shop.layout.uv[k])",
  );
  assert.ok(Math.abs(dx) < 1e-3 * dy, `${dx}, ${dy}`);
  assert.deepEqual(page.faults, []);
  await page.page.context().close();
});

test("the unit is asked for where the size looks wrong", async () => {
  const page = await openPatterns(stack);
  const small = shell();
  small.vertices = small.vertices.map((vertex) => vertex.map((value) => value / 1000));
  await page.upload("metres.obj", obj(small));
  await page.flat("metres");
  const notice = page.page.locator("[data-notice=unit]");
  await notice.getByText("0.2 mm").first().waitFor();
  await notice.getByRole("button", { name: "metres: 200 mm" }).click();
  await page.until("shop.pattern.millimetresPerUnit === 1000");
  await notice.waitFor({ state: "hidden" });
  await page.tab("Save");
  await page.page.getByLabel("Seam allowance").fill("0");
  await page.page.getByLabel("Seam allowance").blur();
  const [w, h] = measured((await page.save("svg")).bytes.toString(), "outline");
  assert.ok(Math.abs(Math.hypot(w, h) - Math.hypot(girth / 2, height)) < 0.15 * height);
  assert.deepEqual(page.faults, []);
  await page.page.context().close();
});

test("without WebGL the page draws all the same, and the pieces are cut on", async () => {
  const without = `(() => {
    const { getContext } = HTMLCanvasElement.prototype;
    HTMLCanvasElement.prototype.getContext = function (kind, ...more) {
      return kind.startsWith("webgl") ? null : getContext.call(this, kind, ...more);
    };
  })()`;
  const page = await openPatterns(stack, {}, without);
  const inked = await page.ask<number>(`(() => {
    const canvas = document.querySelector("#model canvas");
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    return data.filter((value, i) => i % 4 === 3 && value === 255).length;
  })()`);
  assert.ok(inked > 5000, `${inked} pixels of the model`);
  await page.upload("tube.obj", obj(tube()));
  await page.flat("tube");
  await page.tool("Line");
  const inner = await page.ask<number>(
    "[...shop.edges.lengths.keys()].find((edge) => shop.edges.sides[edge] === 2 && !shop.layout.autoCuts.includes(edge) && Math.abs(shop.edges.lengths[edge] - 25) < 1e-6)",
  );
  const [a, b] = await page.ask<number[]>(
    `[shop.edges.ends[2 * ${inner}], shop.edges.ends[2 * ${inner} + 1]]`,
  );
  await page.click("views[0]", a, b);
  await page.until("shop.pattern.seams.length === 8");
  await page.settle();
  assert.deepEqual(page.faults, []);
  await page.page.context().close();
});

test("the puppet page does not load what only the flatten page needs, and each leads to the other", async () => {
  const page = await openPatterns(stack);
  await page.page.getByRole("navigation").getByRole("link", { name: "Puppet" }).click();
  await page.until("typeof studio === 'object' && studio.connection === 'live'");
  const loaded = await page.ask<string[]>(
    "performance.getEntriesByType('resource').map(({ name }) => name)",
  );
  assert.ok(!loaded.some((name) => name.includes("model_view")), `${loaded}`);
  await page.page.getByRole("navigation").getByRole("link", { name: "Flatten" }).click();
  await page.until("typeof shop === 'object' && shop.isSettled");
  assert.deepEqual(page.faults, []);
  await page.page.context().close();
});
