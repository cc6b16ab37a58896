// A drag on a puppet of many vertices, by the page's own meter: how many shapes come in a second, and how
// long it takes from moving the pointer to the picture that shows it; drawn, and with drawing switched off. Also
// what processor time of the browser that takes, which other work on the machine hardly changes.
//
// Usage: npm run build, then node bench/drag.mjs [--vertices 5000] [--seconds 20] [--rate 125] [--json]
//   --rate N: how often a second the pointer moves. ARAPD=PATH is the server, CHROMIUM=PATH the browser.
// --trace FILE: what chromium did meanwhile, for its own viewer. The page, the gateway and arapd share the
// machine, which ought to be quiet.
import { spawn } from "node:child_process";
import { once } from "node:events";
import { mkdtempSync, readFileSync, readdirSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { createInterface } from "node:readline";
import { setTimeout as sleep } from "node:timers/promises";
import { fileURLToPath } from "node:url";
import { parseArgs } from "node:util";

import { chromium } from "playwright-core";

const here = dirname(dirname(fileURLToPath(import.meta.url)));
const arapd = process.env.ARAPD ?? join(here, "../../build/release/bin/arapd");
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

async function start(program, words, ready) {
  const child = spawn(program, words, { stdio: ["ignore", "pipe", "inherit"] });
  for await (const line of createInterface({ input: child.stdout })) {
    const found = ready.exec(line)?.[1];
    if (found === undefined) continue;
    child.stdout.resume();
    return { child, address: found };
  }
  throw new Error(`${program} ended before it was ready`);
}

const folder = mkdtempSync(join(tmpdir(), "arapd-drag-"));
const children = [];
let browser;
try {
  const listen = ["--listen", `unix:${folder}/socket`, "--store", "memory", "--no-admin"];
  const server = await start(
    arapd,
    [...listen, "--log-level", "error"],
    /^arapd listening on (.*)$/,
  );
  children.push(server.child);
  const words = [
    "--arapd",
    server.address,
    "--listen",
    "127.0.0.1:0",
    "--static",
    join(here, "dist"),
  ];
  const gateway = await start(
    process.execPath,
    [join(here, "../gateway/dist/main.js"), ...words, "--log-level", "error"],
    /^gateway listening on (.*)$/,
  );
  children.push(gateway.child);
  browser = await chromium.launch({
    executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
    args: [
      "--no-sandbox",
      "--disable-gpu",
      "--use-angle=swiftshader",
      "--enable-unsafe-swiftshader",
      "--disable-dev-shm-usage",
      "--no-first-run",
      "--disable-background-networking",
    ],
  });
  const page = await browser.newPage({ viewport: { width: 1280, height: 800 } });
  await page.goto(gateway.address);
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
    const before = browserMs();
    const found = await page.evaluate(`(${drag})(${x}, ${y}, ${rate}, ${1000 * seconds})`);
    found.processorMsPerSecond = Math.round((browserMs() - before) / seconds);
    if (values.trace && !blind) await browser.stopTracing();
    await page.mouse.up();
    // The pin goes back to where the pointer is next.
    await page.evaluate("studio.undo()");
    await until("studio.isSettled");
    report[blind ? "undrawn" : "drawn"] = found;
  }
  console.log(values.json ? JSON.stringify(report) : report);
} finally {
  await browser?.close();
  for (const child of children.reverse()) child.kill("SIGTERM");
  await Promise.all(children.map((child) => child.exitCode ?? once(child, "exit")));
  rmSync(folder, { recursive: true, force: true });
}

// Processor time of the browser so far, in ms: of all that comes from this process, but of its other children.
function browserMs() {
  const parents = new Map();
  const spent = new Map();
  for (const pid of readdirSync("/proc")
    .filter((name) => /^\d+$/.test(name))
    .map(Number)) {
    try {
      const fields = readFileSync(`/proc/${pid}/stat`, "latin1")
        .replace(/^.*\) /, "")
        .split(" ");
      parents.set(pid, Number(fields[1]));
      spent.set(pid, 10 * (Number(fields[11]) + Number(fields[12])));
    } catch {
      // It has just ended.
    }
  }
  const others = new Set(children.map(({ pid }) => pid));
  const isOurs = (pid) => {
    for (let at = pid; at > 1 && !others.has(at); at = parents.get(at)) {
      if (parents.get(at) === process.pid) return true;
    }
    return false;
  };
  return [...spent].reduce((sum, [pid, ms]) => sum + (isOurs(pid) ? ms : 0), 0);
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
