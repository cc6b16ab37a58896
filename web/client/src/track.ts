// The frames of a track, each checked as it comes.
import { CallFailed, CallHeaders, deadlineOf, pieces, workLimit } from "./calls.js";
import type { CallOptions } from "./calls.js";
import type { Channel } from "./channel.js";
import { numberRun } from "./checks.js";
import type { MeshSize } from "./checks.js";
import { badAnswer, cancelled, errorOfCall } from "./errors.js";
import { verticesOf } from "./positions.js";
import type { Numbers } from "./runs.js";
import { MeasureCount, shapeOf, shapeOptionsToWire } from "./shape.js";
import type { Shape, ShapeOptions } from "./shape.js";
import { deformation } from "./wire.js";

/** One frame: a target for every handle, in the order of the handle ids of the track. */
export interface TrackFrame {
  /** x y x y…, length 2·#handles. */
  positions: Numbers;
  /** In radians, length 0 or #handles. */
  angles?: Numbers;
  /** Length 0 or #handles. */
  scales?: Numbers;
}

/** A track of a session. */
export interface Track {
  sessionId: string;
  handleSetId: string;
  handleIds: readonly string[];
  frames: readonly TrackFrame[];
  options: ShapeOptions;
}

export async function* deformTrack(
  channel: Channel,
  track: Track,
  mesh: MeshSize | undefined,
  options: CallOptions,
): AsyncGenerator<Shape> {
  const request = {
    sessionId: track.sessionId,
    handleSetId: track.handleSetId,
    handleIds: [...track.handleIds],
    frames: track.frames.map((frame, i) => ({
      positions: numberRun(frame.positions, `frames[${i}].positions`),
      anglesRadians: numberRun(frame.angles ?? [], `frames[${i}].angles_radians`),
      scales: numberRun(frame.scales ?? [], `frames[${i}].scales`),
    })),
    options: shapeOptionsToWire(track.options),
  };
  const { signal } = options;
  const stop = cancelled("The track was cancelled.");
  if (signal?.aborted) throw stop;
  const count = track.frames.length;
  const measures = new MeasureCount(track.options);
  let next = 0;
  let vertices: Uint32Array | null = null;
  let stopped = false;
  let cancel = (): void => {};
  const unhook = channel.onStop(signal, () => {
    stopped = true;
    cancel();
  });
  const call = {
    metadata: new CallHeaders(track.sessionId, options).of(channel),
    deadline: deadlineOf(options, Infinity),
    onCancel: (how: () => void) => (cancel = how),
  };
  const late = (): string =>
    `Frame ${next} of the track did not come within ${workLimit / 1000} s.`;
  try {
    for await (const answer of pieces(
      channel,
      deformation.DeformTrack,
      request,
      call,
      workLimit,
      late,
    )) {
      if (next >= count)
        throw badAnswer(`The server answered more frames than the ${count} of the track.`);
      if (next === 0) vertices = verticesOf(answer.vertices, track.options, mesh);
      const measured = measures.isDue();
      const asked = { options: track.options, mesh, vertices, picks: 0, measured };
      const frame = shapeOf(answer.shape, asked);
      measures.answered(!frame.measured);
      if (frame.sequence !== next) {
        throw badAnswer(
          `The server answered frame ${frame.sequence} of the track where ${next} was due.`,
        );
      }
      next++;
      yield frame;
    }
  } catch (error) {
    if (stopped) throw stop;
    throw error instanceof CallFailed ? errorOfCall(error.status) : error;
  } finally {
    unhook();
  }
  if (next !== count)
    throw badAnswer(`The server ended the track after ${next} of ${count} frames.`);
}
