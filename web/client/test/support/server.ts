// The real arapd in a process of its own, to be stopped, frozen and killed.
import { spawn } from "node:child_process";
import type { ChildProcess } from "node:child_process";
import { once } from "node:events";
import { mkdtempSync, readFileSync, readdirSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { createInterface } from "node:readline";
import { setImmediate as nextTurn } from "node:timers/promises";

import { Client } from "@arapd/client";

const program = process.env["ARAPD"] ?? "arapd";
const running = new Set<ChildProcess>();
process.on("exit", () => running.forEach((child) => child.kill("SIGKILL")));

export class Server {
  /** Of this test alone; goes with stop(). */
  readonly folder = mkdtempSync(join(tmpdir(), "arapd-web-"));
  address = "";
  /** Where its admin page is, when the flags have --admin. */
  admin = "";
  readonly #flags: readonly string[];
  readonly #listen: string;
  #child: ChildProcess | undefined;
  #log = "";

  /**
   * "{}" in flags is the folder. It listens on a unix socket there, which is the same after every
   * start.
   */
  constructor(flags: readonly string[] = ["--store", "memory"], listen = "unix:{}/socket") {
    this.#flags = flags.map((flag) => flag.replace("{}", this.folder));
    this.#listen = listen.replace("{}", this.folder);
  }

  /** Starts it and waits until it listens. */
  async start(): Promise<this> {
    const hasAdmin = this.#flags.includes("--admin");
    const always = ["--listen", this.#listen, "--max-stream-load", "0"];
    const words = [...always, ...(hasAdmin ? [] : ["--no-admin"]), ...this.#flags];
    this.address = this.admin = "";
    const child = spawn(program, words, {
      stdio: ["ignore", "pipe", "pipe"],
    });
    this.#child = child;
    running.add(child);
    child.once("exit", () => running.delete(child));
    child.once("error", (error) => (this.#log += `${program}: ${error.message}`));
    child.stderr.on("data", (text: Buffer) => (this.#log += text.toString()));
    const limit = setTimeout(() => child.kill("SIGKILL"), 60_000);
    for await (const line of createInterface({ input: child.stdout })) {
      const address = /^arapd listening on (.*)$/.exec(line)?.[1];
      if (address !== undefined) this.address = address;
      this.admin = /^arapd admin on (.*)$/.exec(line)?.[1] ?? this.admin;
      if (this.address === "" || (hasAdmin && this.admin === "")) continue;
      clearTimeout(limit);
      child.stdout.resume();
      return this;
    }
    clearTimeout(limit);
    throw new Error(`arapd did not begin to listen within a minute:\n${this.#log}`);
  }

  signal(signal: NodeJS.Signals): void {
    this.#child?.kill(signal);
  }
  /** Stops every thread of it, and waits until they stand: a signal alone lets it answer a little longer. */
  async freeze(): Promise<void> {
    this.signal("SIGSTOP");
    const tasks = `/proc/${this.#child!.pid}/task`;
    const stands = (task: string): boolean => {
      try {
        return /\) [TtZX] /.test(readFileSync(`${tasks}/${task}/stat`, "latin1"));
      } catch {
        return false; // a thread that has just ended
      }
    };
    const limit = Date.now() + 60_000;
    while (!readdirSync(tasks).every(stands)) {
      if (Date.now() > limit) throw new Error("arapd does not stop within a minute");
      await nextTurn();
    }
  }
  /** Signals it and waits for its end. */
  async end(signal: NodeJS.Signals): Promise<void> {
    const child = this.#child;
    if (!child || child.exitCode !== null || child.signalCode !== null) return;
    const ended = once(child, "exit");
    child.kill(signal);
    await ended;
  }
  async stop(): Promise<void> {
    this.signal("SIGCONT");
    await this.end("SIGKILL");
    rmSync(this.folder, { recursive: true, force: true });
  }
}

/** A server and a client of it for one test, which ends both. */
export async function serve<T>(
  use: (client: Client, server: Server) => Promise<T>,
  flags?: readonly string[],
  listen?: string,
): Promise<T> {
  const server = new Server(flags, listen);
  try {
    await server.start();
    const client = Client.connect(server.address);
    try {
      return await use(client, server);
    } finally {
      client.close();
    }
  } finally {
    await server.stop();
  }
}
