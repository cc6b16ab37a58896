// The thread that reads a large file.
import { parentPort, workerData } from "node:worker_threads";

import { readSurface } from "./format.js";
import type { WorkerAnswer } from "./read.js";
import { FileFault } from "./surface.js";
import type { FileLimits } from "./surface.js";

const { bytes, name, limits } = workerData as {
  bytes: Uint8Array;
  name: string;
  limits: FileLimits;
};

try {
  const surface = await readSurface(
    Buffer.from(bytes.buffer, bytes.byteOffset, bytes.length),
    name,
    limits,
  );
  const answer: WorkerAnswer = { surface };
  parentPort?.postMessage(answer, [
    surface.vertices.buffer as ArrayBuffer,
    surface.triangles.buffer as ArrayBuffer,
  ]);
} catch (error) {
  if (!(error instanceof FileFault)) throw error;
  const answer: WorkerAnswer = { fault: error.message, tooLarge: error.tooLarge };
  parentPort?.postMessage(answer);
}
