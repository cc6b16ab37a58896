// A drag on a puppet of many vertices, by the page's own meter: how many shapes come in a second, and how
// long it takes from moving the pointer to the picture that shows it; drawn, and with drawing switched off. Also
// what processor time of the browser that takes, which other work on the machine hardly changes.
//
// Usage: npm run build, then node bench/drag.mjs [--vertices 5000] [--seconds 20] [--rate 125] [--json]
//   --rate N: how often a second the pointer moves. ARAPD=PATH is the server, CHROMIUM=PATH the browser.
// --trace FILE: what chromium did meanwhile, for its own viewer. The page, the gateway and arapd share the
// machine, which ought to be quiet.
import { setTimeout as sleep } from "node:timers/promises";
import { parseArgs } from "node:util";

import { Stack } from "./stack.mjs";

const { values } = parseArgs({
  options: {
    vertices: { type: "string", default: "5000" },
    seconds: { type: "string", default: "20" },
    rate: { type: "string", default: "125" },
    trace: { type: "string" },
    json: { type: "boolean", default: false },
  },
});
const [vertices, seconds, rate] = ["vertices", "seconds", "rate"].map((name) =>
  Number(values[name]),
);

const stack = new Stack();
try {
  await stack.start();
  const { browser } = stack;
  const page = await browser.newPage({ viewport: { width: 1280, height: 800 } });
  await page.goto(stack.address);
  const until = async (expression) => {
    while (!(await page.evaluate(expression))) await sleep(50);
  };
  await until("studio.connection === 'live' && studio.puppet.body !== null");
  await page.evaluate(`studio.cut({ ...studio.puppet.cut, vertices: ${vertices} })`);
  await until("!studio.working");
  await page.evaluate("studio.suggestPins()");
  await until("studio.isSettled");
  const count = await page.evaluate("studio.puppet.body.rest.length / 2");
  const [x, y] = await page.evaluate(
    "stage.inWindow(studio.puppet.pins[1].x, studio.puppet.pins[1].y)",
  );
  const report = { vertices: count, moves: rate };
  for (const blind of [false, true]) {
    await page.evaluate(`stage.blind = ${blind}`);
    await page.mouse.move(x, y);
    await page.mouse.down();
    if (values.trace && !blind) await browser.startTracing(page, { path: values.trace });
    const before = stack.browserMs();
    const found = await page.evaluate(`(${drag})(${x}, ${y}, ${rate}, ${1000 * seconds})`);
    found.processorMsPerSecond = Math.round((stack.browserMs() - before) / seconds);
    if (values.trace && !blind) await browser.stopTracing();
    await page.mouse.up();
    // The pin goes back to where the pointer is next.
    await page.evaluate("studio.undo()");
    await until("studio.isSettled");
    report[blind ? "undrawn" : "drawn"] = found;
  }
  console.log(values.json ? JSON.stringify(report) : report);
} finally {
  await stack.stop();
}

// In the page. The mouse is at x, y and holds a pin.
async function drag(x, y, rate, ms) {
  const { studio, stage } = window;
  const seen = { lag: [], frame: [], server: [], network: [], shapes: [] };
  const { meter } = studio;
  for (const [name, values] of Object.entries(seen)) {
    const add = Object.getPrototypeOf(meter[name]).add;
    meter[name].add = function (value, now) {
      values.push(value);
      add.call(this, value, now);
    };
  }
  let pictures = 0;
  let goes = true;
  const count = () => {
    pictures++;
    if (goes) requestAnimationFrame(count);
  };
  requestAnimationFrame(count);
  const began = performance.now();
  let moves = 0;
  await new Promise((done) => {
    const timer = setInterval(() => {
      const now = performance.now() - began;
      if (now > ms) {
        clearInterval(timer);
        done();
        return;
      }
      // Timers are late; then the moves that were due are one, as those of a mouse are.
      const angle = now / 300;
      stage.element.dispatchEvent(
        new PointerEvent("pointermove", {
          pointerId: 1,
          bubbles: true,
          clientX: x + 60 * Math.sin(angle),
          clientY: y + 60 * (Math.cos(angle) - 1),
        }),
      );
      moves++;
    }, 1000 / rate);
  });
  goes = false;
  const canvas = stage.element.querySelector("canvas");
  for (const name of Object.keys(seen)) delete meter[name].add;
  const part = (values, p) => {
    const sorted = [...values].sort((a, b) => a - b);
    const value = sorted[Math.min(sorted.length - 1, Math.floor(p * sorted.length))];
    return value === undefined ? null : Number(value.toFixed(1));
  };
  const of = (values) => ({
    median: part(values, 0.5),
    p90: part(values, 0.9),
    p99: part(values, 0.99),
  });
  return {
    movesPerSecond: Math.round((1000 * moves) / ms),
    picturesPerSecond: Math.round((1000 * pictures) / ms),
    shapesPerSecond: Math.round((1000 * seen.shapes.length) / ms),
    pointerToPictureMs: of(seen.lag),
    pictureMs: of(seen.frame),
    canvas: [canvas.width, canvas.height],
    serverMs: of(seen.server),
    networkMs: of(seen.network),
  };
}
