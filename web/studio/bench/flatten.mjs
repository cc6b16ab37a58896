// Large models on the flatten page: how long it takes until one is read and until it lies flat, what memory that is,
// and how long a picture takes in which the pointer moves over the model or over the pieces, or the view is moved.
//
// Usage: npm run build, then node bench/flatten.mjs [--triangles 50000,200000] [--moves 40] [--json]
// ARAPD=PATH is the server, CHROMIUM=PATH the browser. The page, the gateway and arapd share the machine.
import { setTimeout as sleep } from "node:timers/promises";
import { parseArgs } from "node:util";

import { Stack } from "./stack.mjs";

const { values } = parseArgs({
  options: {
    triangles: { type: "string", default: "50000,200000" },
    moves: { type: "string", default: "40" },
    json: { type: "boolean", default: false },
  },
});

// A skirt in folds, open behind, in millimetres.
function skirt(triangles) {
  const along = Math.round(Math.sqrt(triangles / 4));
  const across = 2 * along;
  const lines = ["g skirt"];
  for (let j = 0; j <= along; ++j) {
    for (let i = 0; i <= across; ++i) {
      const [s, t] = [i / across, j / along];
      const angle = 1.9 * Math.PI * s;
      const radius = 120 + 130 * t + 18 * t * t * Math.sin(9 * angle);
      const place = [radius * Math.sin(angle), -600 * t, 0.8 * radius * Math.cos(angle)];
      lines.push(`v ${place.map((value) => value.toFixed(4)).join(" ")}`);
    }
  }
  for (let j = 0; j < along; ++j) {
    for (let i = 1; i <= across; ++i) {
      const a = j * (across + 1) + i;
      const b = a + across + 1;
      lines.push(`f ${a} ${b} ${a + 1}`, `f ${a + 1} ${b} ${b + 1}`);
    }
  }
  return lines.join("\n");
}

const stack = new Stack();
const reports = [];
try {
  await stack.start();
  for (const triangles of values.triangles.split(",").map(Number)) {
    const page = await stack.browser.newPage({ viewport: { width: 1280, height: 800 } });
    await page.goto(new URL("flatten.html", stack.address).href);
    const until = async (expression) => {
      while (!(await page.evaluate(expression))) await sleep(20);
    };
    await until("shop.isSettled && window.model !== undefined");
    const before = stack.pageMegabytes();
    const buffer = Buffer.from(skirt(triangles));
    const began = performance.now();
    await page
      .locator("input[type=file]")
      .setInputFiles({ name: "skirt.obj", mimeType: "model/obj", buffer });
    await until("shop.surface.name === 'skirt'");
    const read = performance.now() - began;
    await until("shop.isSettled || shop.flat.state === 'failed'");
    const flat = performance.now() - began;
    const count = await page.evaluate("shop.surface.triangles.length / 3");
    const problem = await page.evaluate("shop.flat.problem?.message ?? null");
    if (problem) {
      reports.push({ triangles: count, problem });
      continue;
    }
    await sleep(1000);
    const report = {
      triangles: count,
      fileMegabytes: Number((buffer.length / 1e6).toFixed(1)),
      readSeconds: Number((read / 1000).toFixed(2)),
      flatSeconds: Number((flat / 1000).toFixed(2)),
      pageMegabytes: [before, stack.pageMegabytes()],
    };
    for (const tool of ["look", "path"]) {
      await page.evaluate(`shop.choose("${tool}")`);
      for (const how of ["hover model", "hover layout", "turn model", "move layout"])
        report[`${tool}: ${how}`] = await page.evaluate(`(${moves})("${how}", ${values.moves})`);
    }
    // A path under the pointer, from where the first point is.
    await page.evaluate("shop.look({ from: shop.edges.pointOf[0] })");
    report["path begun: hover model"] = await page.evaluate(`(${moves})("hover model", 20)`);
    reports.push(report);
    await page.close();
  }
  console.log(values.json ? JSON.stringify(reports) : reports);
} finally {
  await stack.stop();
}

// In the page: from the move until the picture that shows it is made, in ms.
async function moves(how, count) {
  const { model, views } = window;
  const view = how.endsWith("model") ? model : views[0];
  const { left, top, width, height } = view.element.getBoundingClientRect();
  const picture = () =>
    new Promise((done) =>
      requestAnimationFrame(() => {
        const channel = new MessageChannel();
        channel.port1.onmessage = done;
        channel.port2.postMessage(null);
      }),
    );
  const times = [];
  for (let i = 0; i < count; ++i) {
    await picture();
    const began = performance.now();
    if (how.startsWith("hover")) {
      const clientX = left + width * (0.5 + 0.15 * Math.sin(i));
      const clientY = top + height * (0.5 + 0.15 * Math.cos(1.7 * i));
      view.element.dispatchEvent(
        new PointerEvent("pointermove", { pointerId: 1, bubbles: true, clientX, clientY }),
      );
    } else view.turn(i % 2 === 0 ? 1 : -1, 0);
    await picture();
    times.push(performance.now() - began);
  }
  times.sort((a, b) => a - b);
  const part = (p) => Number(times[Math.min(count - 1, Math.floor(p * count))].toFixed(1));
  return { median: part(0.5), p90: part(0.9) };
}
