// The real server, gateway and browser for what is measured here. ARAPD=PATH is the server, CHROMIUM=PATH the browser.
import { spawn } from "node:child_process";
import { once } from "node:events";
import { mkdtempSync, readFileSync, readdirSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { createInterface } from "node:readline";
import { fileURLToPath } from "node:url";

import { chromium } from "playwright-core";

const here = dirname(dirname(fileURLToPath(import.meta.url)));
const arapd = process.env.ARAPD ?? join(here, "../../build/release/bin/arapd");

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

export class Stack {
  #folder = mkdtempSync(join(tmpdir(), "arapd-bench-"));
  #children = [];
  browser;
  address;

  async start() {
    const server = await start(
      arapd,
      ["--listen", `unix:${this.#folder}/socket`, "--store", "memory", "--no-admin"].concat([
        "--log-level",
        "error",
      ]),
      /^arapd listening on (.*)$/,
    );
    this.#children.push(server.child);
    const listen = ["--arapd", server.address, "--listen", "127.0.0.1:0"];
    const words = [...listen, "--static", join(here, "dist"), "--log-level", "error"];
    const gateway = await start(
      process.execPath,
      [join(here, "../gateway/dist/main.js"), ...words],
      /^gateway listening on (.*)$/,
    );
    this.#children.push(gateway.child);
    this.address = gateway.address;
    this.browser = await chromium.launch({
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
  }

  async stop() {
    await this.browser?.close();
    for (const child of this.#children.reverse()) child.kill("SIGTERM");
    await Promise.all(this.#children.map((child) => child.exitCode ?? once(child, "exit")));
    rmSync(this.#folder, { recursive: true, force: true });
  }

  /** Processor time of the browser so far, in ms: of all that comes from this process, but of its other children. */
  browserMs() {
    return this.#processes().reduce((sum, { ms }) => sum + ms, 0);
  }
  /** Memory of its largest process, in MB. */
  pageMegabytes() {
    return Math.max(...this.#processes().map(({ megabytes }) => megabytes));
  }

  #processes() {
    const found = new Map();
    for (const pid of readdirSync("/proc")
      .filter((name) => /^\d+$/.test(name))
      .map(Number)) {
      try {
        const fields = readFileSync(`/proc/${pid}/stat`, "latin1")
          .replace(/^.*\) /, "")
          .split(" ");
        found.set(pid, {
          parent: Number(fields[1]),
          ms: 10 * (Number(fields[11]) + Number(fields[12])),
          megabytes: Math.round((Number(fields[21]) * 4096) / 1e6),
        });
      } catch {
        // It has just ended.
      }
    }
    const others = new Set(this.#children.map(({ pid }) => pid));
    const isOurs = (pid) => {
      for (let at = pid; at > 1 && !others.has(at); at = found.get(at)?.parent ?? 0) {
        if (found.get(at)?.parent === process.pid) return true;
      }
      return false;
    };
    return [...found].filter(([pid]) => isOurs(pid)).map(([, facts]) => facts);
  }
}
