// Files of meshes that were uploaded. Small ones are read at once, larger ones in a thread of their
// own, so that no drag waits for an upload; with as much memory as a file of that size may need, and
// no longer than somebody waits.
import { Worker } from "node:worker_threads";

import { Problem } from "../problems.js";
import type { Settings } from "../options.js";
import { readSurface } from "./format.js";
import { FileFault } from "./surface.js";
import type { FileLimits, Surface } from "./surface.js";

const smallBytes = 256 * 1024;
const mostWaiting = 16;

/** What a thread answers. */
export type WorkerAnswer = { surface: Surface } | { fault: string; tooLarge: boolean };

export class FileReader {
  readonly #limits: FileLimits;
  readonly #most: number;
  #running = 0;
  readonly #waiting: (() => void)[] = [];

  constructor(settings: Settings) {
    this.#limits = { vertices: settings.maxFileVertices, triangles: settings.maxFileTriangles };
    this.#most = settings.maxConcurrentUploads;
  }

  /** FILE or TOO_LARGE for what is wrong with it; GATEWAY_BUSY where too many wait. */
  async read(bytes: Buffer, name: string, signal: AbortSignal): Promise<Surface> {
    if (bytes.length === 0) throw new Problem("FILE", "The file is empty.");
    try {
      if (bytes.length <= smallBytes) return await readSurface(bytes, name, this.#limits);
      return await this.#inTurn(() => this.#inThread(bytes, name, signal));
    } catch (error) {
      if (error instanceof FileFault)
        throw new Problem(error.tooLarge ? "TOO_LARGE" : "FILE", error.message);
      throw error;
    }
  }

  async #inTurn<T>(work: () => Promise<T>): Promise<T> {
    if (this.#running >= this.#most) {
      if (this.#waiting.length >= mostWaiting) {
        throw new Problem("GATEWAY_BUSY", "Too many files wait to be read.", {
          retryAfterMs: 2000,
        });
      }
      await new Promise<void>((resolve) => this.#waiting.push(resolve));
    } else {
      this.#running++;
    }
    try {
      return await work();
    } finally {
      const next = this.#waiting.shift();
      if (next) next();
      else this.#running--;
    }
  }

  #inThread(bytes: Buffer, name: string, signal: AbortSignal): Promise<Surface> {
    signal.throwIfAborted();
    return new Promise((resolve, reject) => {
      const megabytes = 64 + Math.ceil((24 * bytes.length) / (1 << 20));
      const worker = new Worker(new URL("./worker.js", import.meta.url), {
        workerData: { bytes, name, limits: this.#limits },
        resourceLimits: { maxOldGenerationSizeMb: megabytes },
      });
      const stop = (): void => {
        void worker.terminate();
        reject(signal.reason as Error);
      };
      signal.addEventListener("abort", stop);
      worker.once("message", (answer: WorkerAnswer) => {
        if ("surface" in answer) resolve(answer.surface);
        else reject(new FileFault(answer.fault, answer.tooLarge));
      });
      worker.once("error", (error: NodeJS.ErrnoException) => {
        const full = error.code === "ERR_WORKER_OUT_OF_MEMORY";
        reject(
          full
            ? new FileFault("The file takes more memory than the gateway gives it.", true)
            : error,
        );
      });
      worker.once("exit", () => {
        signal.removeEventListener("abort", stop);
        reject(new Error("The thread that reads a file ended without an answer."));
      });
    });
  }
}
