// Many drags over WebSockets: how long from an update to its shape, how many updates have one of
// their own, and what memory the gateway takes meanwhile, every second: all of it, what V8 has taken
// for its heap and uses of it, and what lies outside of the heap; with a straight line through the
// last two thirds, which says whether it grows.
//
// Usage: node bench/drags.mjs [--sockets 200] [--rate 30] [--seconds 120] [--columns 30]
//                             [--slow 10] [--encoding int16] [--json]
// --columns N: meshes of N × N vertices, one for each session; --slow K: so many of the sockets read
// nothing while the others drag, and at the end have to find one stale frame before the newest;
// --node-flags TEXT: how node runs the gateway, "--cpu-prof" say.
// ARAPD=PATH is the server. Runs on a quiet machine; the pages, the gateway and arapd share it.
import { spawn } from "node:child_process";
import { once } from "node:events";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { createInterface } from "node:readline";
import { setTimeout as sleep } from "node:timers/promises";
import { fileURLToPath } from "node:url";
import { parseArgs } from "node:util";

import { WebSocket } from "ws";

const here = dirname(dirname(fileURLToPath(import.meta.url)));
const arapd = process.env.ARAPD ?? join(here, "../../build/release/bin/arapd");
const text = (fallback) => ({ type: "string", default: fallback });
const { values } = parseArgs({
  options: {
    sockets: text("200"),
    rate: text("30"),
    seconds: text("120"),
    columns: text("30"),
    slow: text("10"),
    encoding: text("int16"),
    "node-flags": text(""),
    json: { type: "boolean", default: false },
  },
});
const [sockets, rate, seconds, columns, slow] = [
  "sockets",
  "rate",
  "seconds",
  "columns",
  "slow",
].map((name) => Number(values[name]));

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

async function post(url, body) {
  const response = await fetch(url, {
    method: "POST",
    headers: { "content-type": "application/json" },
    body: JSON.stringify(body),
  });
  if (!response.ok) throw new Error(`${url}: ${await response.text()}`);
  return response.json();
}

function sheet(id) {
  const vertices = [];
  const triangles = [];
  for (let y = 0; y < columns; y++) {
    for (let x = 0; x < columns; x++) {
      vertices.push(x, y * (1 + id / 1000)); // no two share their factors
      if (x + 1 === columns || y + 1 === columns) continue;
      const v = y * columns + x;
      triangles.push(v, v + 1, v + columns, v + 1, v + columns + 1, v + columns);
    }
  }
  return { vertices, triangles };
}

class Drag {
  sent = new Map(); // when, by sequence
  latencies = [];
  shapes = 0;
  updates = 0;
  last = 0; // sequence that was seen last
  skipped = 0;

  async open(url, id) {
    const session = await post(`${url}/v1/sessions`, {});
    const at = `${url}/v1/sessions/${session.id}`;
    await post(`${at}/meshes`, { id: "m", mesh: sheet(id) });
    const handles = [0, columns - 1, columns * columns - 1].map((vertex) => ({
      id: `v${vertex}`,
      vertex,
    }));
    await post(`${at}/handle-sets`, { id: "h", meshId: "m", handles });
    this.socket = new WebSocket(`${at.replace(/^http/, "ws")}/stream`, "arapd.v1");
    await once(this.socket, "open");
    const opened = once(this.socket, "message");
    this.socket.send(
      JSON.stringify({ type: "open", handleSet: "h", encoding: values.encoding, window: 2 }),
    );
    await opened;
    this.socket.on("message", (data, isBinary) =>
      isBinary ? this.shape(data) : this.complain(data),
    );
  }

  complain(data) {
    // One is enough: the others say the same.
    if (process.exitCode !== 1) console.error(String(data).slice(0, 500));
    process.exitCode = 1;
  }

  shape(bytes) {
    const sequence = bytes.readUInt32LE(4);
    const at = this.sent.get(sequence);
    if (at !== undefined) this.latencies.push(performance.now() - at);
    for (const older of this.sent.keys()) if (older <= sequence) this.sent.delete(older);
    this.shapes++;
    this.last = sequence;
    this.skipped += JSON.parse(bytes.subarray(bytes.length - bytes.readUInt32LE(12))).skipped;
    this.socket.send(JSON.stringify({ type: "seen", sequence }));
  }

  update() {
    const sequence = ++this.updates;
    const angle = sequence / 10;
    const targets = [
      { id: `v${columns - 1}`, x: columns - 1 + Math.cos(angle), y: Math.sin(angle) },
    ];
    this.sent.set(sequence, performance.now());
    this.socket.send(JSON.stringify({ type: "update", sequence, targets }));
  }

  // On a schedule of its own, whatever comes back.
  async run(until, phase) {
    for (let next = performance.now() + phase; next < until; next += 1000 / rate) {
      await sleep(Math.max(0, next - performance.now()));
      this.update();
    }
  }
}

const kinds = [
  ["resident", "process_resident_memory_bytes"],
  ["heap", "nodejs_heap_size_total_bytes"],
  ["used", "nodejs_heap_size_used_bytes"],
  ["outside", "nodejs_external_memory_bytes"],
];
// Of the straight line that is nearest to the samples, in MiB per second.
function slope(samples) {
  const mean = (values) => values.reduce((sum, value) => sum + value, 0) / values.length;
  const [at, level] = [
    mean(samples.map((one) => one.at)),
    mean(samples.map((one) => one.resident)),
  ];
  const over = samples.map((one) => (one.at - at) * (one.resident - level));
  return mean(over) / mean(samples.map((one) => (one.at - at) ** 2));
}
const quantile = (sorted, part) =>
  sorted[Math.min(sorted.length - 1, Math.floor(part * sorted.length))] ?? NaN;
const folder = mkdtempSync(join(tmpdir(), "arapd-drags-"));
const children = [];
try {
  const flags = [
    "--listen",
    `unix:${folder}/socket`,
    "--store",
    "memory",
    "--no-admin",
    "--log-level",
    "error",
    "--max-stream-load",
    "0",
  ];
  const server = await start(
    arapd,
    [...flags, "--max-streams-per-owner", "2000"],
    /listening on (.*)$/,
  );
  children.push(server.child);
  const gateway = await start(
    process.execPath,
    [
      ...values["node-flags"].split(" ").filter((flag) => flag !== ""),
      join(here, "dist/main.js"),
      "--arapd",
      server.address,
      "--listen",
      "127.0.0.1:0",
      "--log-level",
      "error",
    ].concat(
      ["--max-sockets-per-user", "10000", "--max-requests-per-minute", "1000000"],
      // Who reads nothing answers no pings either, and is to be there at the end.
      ["--socket-ping-ms", "3600000"],
    ),
    /listening on (.*)$/,
  );
  children.push(gateway.child);
  const url = gateway.address;
  const drags = Array.from({ length: sockets }, () => new Drag());
  for (const [id, drag] of drags.entries()) await drag.open(url, id);
  const sleepers = drags.slice(0, slow);
  const readers = drags.slice(slow);
  for (const { socket } of sleepers) socket.pause();
  const memory = [];
  const began = performance.now();
  const sample = async () => {
    const at = (performance.now() - began) / 1000;
    const metrics = await (await fetch(`${url}/metrics`)).text();
    const read = (name) => Number(new RegExp(`^${name} (\\S+)`, "m").exec(metrics)?.[1]) / 2 ** 20;
    const now = { at, ...Object.fromEntries(kinds.map(([kind, name]) => [kind, read(name)])) };
    memory.push(now);
    if (!values.json) {
      const told = kinds.map(([kind]) => `${kind} ${now[kind].toFixed(1)}`).join("  ");
      console.log(`${at.toFixed(0).padStart(4)} s  ${told} MiB`);
    }
  };
  await sample();
  const sampling = setInterval(() => void sample(), 1000);
  const until = performance.now() + seconds * 1000;
  await Promise.all(drags.map((drag, i) => drag.run(until, ((1000 / rate) * i) / sockets)));
  clearInterval(sampling);
  await sample();
  for (const { socket } of sleepers) socket.resume();
  for (const limit = performance.now() + 10_000; performance.now() < limit; await sleep(20)) {
    if (drags.every(({ last, updates }) => last === updates)) break;
  }
  const latencies = readers.flatMap((drag) => drag.latencies).sort((a, b) => a - b);
  const sum = (of, what) => of.reduce((total, drag) => total + drag[what], 0);
  const report = {
    sockets,
    rate,
    seconds,
    vertices: columns * columns,
    updates: sum(readers, "updates"),
    shapes: sum(readers, "shapes"),
    latencyMs: Object.fromEntries(
      [0.5, 0.9, 0.99, 0.999, 1].map((part) => [
        `p${100 * part}`,
        Number(quantile(latencies, part).toFixed(2)),
      ]),
    ),
    skipped: sum(readers, "skipped"),
    slowReaders: { sockets: slow, most: Math.max(0, ...sleepers.map(({ shapes }) => shapes)) },
    unanswered: drags.filter(({ last, updates }) => last !== updates).length,
    gatewayMiB: {
      first: Math.round(memory[0].resident),
      last: Math.round(memory.at(-1).resident),
      most: Math.round(Math.max(...memory.map(({ resident }) => resident))),
      // Of the last two thirds.
      growthPerMinute: Number((60 * slope(memory.slice(memory.length / 3))).toFixed(2)),
    },
    ...(values.json && { memory }),
  };
  console.log(values.json ? JSON.stringify(report) : report);
  for (const { socket } of drags) socket.terminate();
} finally {
  for (const child of children.reverse()) child.kill("SIGTERM");
  await Promise.all(children.map((child) => child.exitCode ?? once(child, "exit")));
  rmSync(folder, { recursive: true, force: true });
}
