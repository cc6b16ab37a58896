// Frames: shapes in binary, as docs/web.md lays them out. 16 bytes, the positions, and JSON.
import { endianness } from "node:os";

import type { Shape } from "@arapd/client";

import { toJson } from "../json.js";

export const frameVersion = 1;
export const headBytes = 16;
const swaps = endianness() === "BE";

function bytesOf(local: Shape["local"]): Buffer {
  const bytes = Buffer.from(local.buffer, local.byteOffset, local.byteLength);
  if (!swaps) return bytes;
  return local.BYTES_PER_ELEMENT === 2 ? Buffer.from(bytes).swap16() : Buffer.from(bytes).swap32();
}

const measuresOf = (shape: Shape): object => ({
  flippedCount: shape.flippedCount,
  ...(shape.flippedIds.length > 0 && { flippedIds: shape.flippedIds }),
  energy: shape.energy,
  meanStretch: shape.meanStretch,
  maxStretch: shape.maxStretch,
});

/** Since the last frame `skipped` shapes were not sent, and `replaced` updates not computed. */
export function frameOf(shape: Shape, skipped: number, replaced: number): Buffer {
  const facts = toJson({
    origin: shape.origin,
    scale: shape.scale,
    positionError: shape.positionError,
    replaced,
    skipped,
    measured: shape.measured,
    ...(shape.measured && measuresOf(shape)),
    worstHandleError: shape.worstHandleError,
    worstHandleId: shape.worstHandleId,
    queueMicros: shape.queueMicros,
    solveMicros: shape.solveMicros,
    ...(shape.picks.length > 0 && { picks: shape.picks }),
    handleSetRevision: shape.handleSetRevision,
  });
  const { local } = shape;
  return joined(shape.sequence, local, facts);
}

/** A frame without a shape: the problem because of which none follows. */
export const lastFrameOf = (sequence: number, problem: object): Buffer =>
  joined(sequence, new Float32Array(0), toJson({ problem }));

function joined(sequence: number, local: Shape["local"], facts: string): Buffer {
  const tail = Buffer.from(facts);
  const head = Buffer.alloc(headBytes);
  head.writeUInt8(frameVersion, 0);
  head.writeUInt8(local instanceof Int16Array ? 1 : 0, 1);
  head.writeUInt32LE(sequence >>> 0, 4);
  head.writeUInt32LE(local.length / 2, 8);
  head.writeUInt32LE(tail.length, 12);
  return Buffer.concat([head, bytesOf(local), tail]);
}
