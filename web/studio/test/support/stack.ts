// The real arapd, the real gateway and a real browser, each a process of its own.
import { spawn } from "node:child_process";
import type { ChildProcess } from "node:child_process";
import { once } from "node:events";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { createInterface } from "node:readline";
import { setTimeout as delay } from "node:timers/promises";

import { chromium } from "playwright-core";
import type { Browser, BrowserContextOptions, Page } from "playwright-core";

/** Nothing is expected to be quick: a test that waits longer has found something that never comes. */
export const patience = 120_000;

const running = new Set<ChildProcess>();
process.on("exit", () => running.forEach((child) => child.kill("SIGKILL")));

/** Starts a program and waits for the line that says where it listens. */
async function listening(
  command: string,
  words: string[],
  line: RegExp,
): Promise<[ChildProcess, string]> {
  const child = spawn(command, words, { stdio: ["ignore", "pipe", "pipe"] });
  running.add(child);
  let log = "";
  child.once("exit", () => running.delete(child));
  child.once("error", (error) => (log += error.message));
  child.stderr!.on("data", (text: Buffer) => (log += text.toString()));
  const limit = setTimeout(() => child.kill("SIGKILL"), patience);
  for await (const said of createInterface({ input: child.stdout! })) {
    const address = line.exec(said)?.[1];
    if (address === undefined) continue;
    clearTimeout(limit);
    child.stdout!.resume();
    return [child, address];
  }
  clearTimeout(limit);
  throw new Error(`${command} does not say where it listens:\n${log}`);
}

async function end(child: ChildProcess, signal: NodeJS.Signals): Promise<void> {
  if (!running.has(child)) return;
  const ended = once(child, "exit");
  child.kill(signal);
  await ended;
}

export class Stack {
  readonly folder = mkdtempSync(join(tmpdir(), "arapd-studio-"));
  address = "";
  /** Where arapd's admin page is, with `--admin`. */
  admin = "";
  readonly #hasAdmin: boolean;
  #server!: ChildProcess;
  #gateway!: ChildProcess;
  #browser!: Browser;

  /** `hasAdmin`: with arapd's admin page, which the gateway knows. */
  constructor(hasAdmin = false) {
    this.#hasAdmin = hasAdmin;
  }

  async start(): Promise<this> {
    await this.startServer();
    await this.startGateway();
    this.#browser = await chromium.launch({
      executablePath: process.env["CHROMIUM"]!,
      timeout: patience,
      args: [
        "--no-sandbox",
        "--disable-gpu",
        "--use-angle=swiftshader",
        "--enable-unsafe-swiftshader",
        "--disable-dev-shm-usage",
        "--disable-quic",
        "--no-first-run",
        "--disable-background-networking",
        "--disable-sync",
        "--disable-component-update",
      ],
    });
    return this;
  }

  /** On the same port as before, if there was one. */
  async startGateway(): Promise<void> {
    const main = join(process.cwd(), "../gateway/dist/main.js");
    const words = [
      main,
      "--arapd",
      `unix:${this.folder}/socket`,
      "--listen",
      `127.0.0.1:${new URL(this.address || "http://x:0").port || 0}`,
    ];
    // A test asks more in a minute than a visitor.
    words.push("--static", join(process.cwd(), "dist"), "--max-requests-per-minute", "100000");
    words.push("--log-level", "error");
    if (this.#hasAdmin) words.push("--arapd-admin", `http://${this.admin}`);
    [this.#gateway, this.address] = await listening(
      process.execPath,
      words,
      /^gateway listening on (.*)$/,
    );
  }

  async startServer(): Promise<void> {
    const words = ["--listen", `unix:${this.folder}/socket`, "--store", "memory"];
    words.push("--max-stream-load", "0");
    if (this.#hasAdmin) words.push("--admin", this.admin || "127.0.0.1:0");
    else words.push("--no-admin");
    // Its admin page comes last.
    const line = this.#hasAdmin ? /^arapd admin on (.*)$/ : /^arapd listening on (.*)$/;
    const [child, address] = await listening(process.env["ARAPD"]!, words, line);
    this.#server = child;
    if (this.#hasAdmin) this.admin = address;
  }
  async killGateway(): Promise<void> {
    await end(this.#gateway, "SIGKILL");
  }
  async killServer(): Promise<void> {
    await end(this.#server, "SIGKILL");
  }

  /** A page as it comes, of this path. */
  async visit(
    options: BrowserContextOptions = {},
    path = "",
    prepare: (page: Page) => unknown = () => {},
  ): Promise<Page> {
    const context = await this.#browser.newContext({ acceptDownloads: true, ...options });
    context.setDefaultTimeout(patience);
    const page = await context.newPage();
    await prepare(page);
    await page.goto(new URL(path, this.address).href);
    return page;
  }

  /** The same, with the errors of the page, which fail the test that asks for them. */
  async watched(
    options: BrowserContextOptions = {},
    path = "",
    script = "",
  ): Promise<[Page, string[]]> {
    const faults: string[] = [];
    const page = await this.visit(options, path, async (fresh) => {
      fresh.on("pageerror", (error) => faults.push(error.message));
      fresh.on("console", (message) => {
        if (/Content.Security.Policy/.test(message.text())) faults.push(message.text());
      });
      if (script) await fresh.addInitScript(script);
    });
    return [page, faults];
  }

  /** A page with the first puppet live. */
  async open(options: BrowserContextOptions = {}, path = ""): Promise<Studio> {
    const [page, faults] = await this.watched(options, path);
    const studio = new Studio(page, faults);
    // What the page says is told with what never comes.
    await page.evaluate("window.said = [], studio.onSay((text) => said.push(text))");
    await studio.until("studio.connection === 'live' && studio.puppet.body !== null");
    return studio;
  }

  /** The server answers nothing until it goes on. */
  pauseServer(): void {
    this.#server.kill("SIGSTOP");
  }
  resumeServer(): void {
    this.#server.kill("SIGCONT");
  }

  async stop(): Promise<void> {
    await this.#browser?.close();
    if (this.#gateway) await end(this.#gateway, "SIGKILL");
    if (this.#server) await end(this.#server, "SIGKILL");
    rmSync(this.folder, { recursive: true, force: true });
  }
}

/** A page, with words for what a visitor does. */
export class Visit {
  constructor(
    readonly page: Page,
    readonly faults: string[],
  ) {}

  /** Waits until an expression on what the page shows to tests is true. */
  async until(expression: string): Promise<void> {
    // Playwright's own wait would need the page to allow eval, which the gateway's headers forbid.
    const limit = Date.now() + patience;
    while (!(await this.page.evaluate(expression))) {
      if (Date.now() > limit) {
        const said = await this.page.evaluate("(window.said ?? []).join(' | ')");
        throw new Error(`this never came: ${expression}; the page said: ${said}`);
      }
      await delay(20);
    }
  }
  ask<T>(expression: string): Promise<T> {
    return this.page.evaluate(expression) as Promise<T>;
  }
  async tab(name: string): Promise<void> {
    await this.page.getByRole("tab", { name, exact: true }).click();
  }
}

/** The puppet page: `studio`, `takes` and `stage`. */
export class Studio extends Visit {
  /** Waits until the shape is that of the document. */
  settle(): Promise<void> {
    return this.until("studio.isSettled");
  }
  /** Where a place of the figure is in the window. */
  at(x: number, y: number): Promise<[number, number]> {
    return this.ask(`stage.inWindow(${x}, ${y})`);
  }
  async click(x: number, y: number): Promise<void> {
    await this.page.mouse.click(...(await this.at(x, y)));
  }
  async pinCount(count: number): Promise<void> {
    await this.until(`studio.puppet.pins.length === ${count}`);
  }

  /** Records while `drag` goes on, and waits until the shapes are computed. */
  async record(drag: () => Promise<void>): Promise<void> {
    await this.tab("Take");
    await this.page.locator("[data-take=record]").click();
    await drag();
    await this.until("takes.recorded > 0.5");
    await this.page.locator("[data-take=record]").click();
    await this.until("takes.film !== undefined && takes.film.take === takes.take");
  }
}
