// Reading a stream in tests.
import assert from "node:assert/strict";

import type { ArapError, DeformStream, Reason, Shape, StreamEvent } from "@arapd/client";

/** The next event, which has to be of that kind. */
export async function next<Kind extends StreamEvent["kind"]>(
  stream: DeformStream,
  kind: Kind,
): Promise<Extract<StreamEvent, { kind: Kind }>> {
  const event = await stream.read();
  assert.equal(event?.kind, kind, `got ${JSON.stringify(event)?.slice(0, 300)}`);
  return event as Extract<StreamEvent, { kind: Kind }>;
}

export const nextShape = async (stream: DeformStream): Promise<Shape> =>
  (await next(stream, "shape")).shape;

/** The ArapError that something fails with, which has to have this reason. */
export async function failure(
  what: Promise<unknown> | (() => unknown),
  reason: Reason,
): Promise<ArapError> {
  try {
    await (typeof what === "function" ? what() : what);
  } catch (error) {
    assert.equal((error as Error).name, "ArapError", String(error));
    assert.equal((error as ArapError).reason, reason, String(error));
    return error as ArapError;
  }
  assert.fail(`nothing failed; ${reason} was due`);
}
