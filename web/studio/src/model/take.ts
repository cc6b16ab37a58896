// A take: where the pins went, frame by frame, and what can be done to it.
import type { Body, Motion, Pin } from "./puppet.js";

/** What a frame says of every pin: x, y, angle, scale. */
export const perPin = 4;

export interface Take {
  /** Frames in a second. */
  rate: number;
  /** With which the take was recorded. */
  body: Body;
  starch: Float32Array | null;
  motion: Motion;
  pins: readonly Pin[];
  /** x y angle scale of every pin, in their order. All that was recorded. */
  frames: readonly Float64Array[];
  /** What of it is used: frames from `first` to before `end`. */
  first: number;
  end: number;
  /** How many rounds of smoothing. */
  smooth: number;
  /** In how many frames the end goes over into the beginning; 0: it does not. */
  loop: number;
}

export const frameOf = (pins: readonly Pin[]): Float64Array =>
  Float64Array.from(pins.flatMap((pin) => [pin.x, pin.y, pin.angle, pin.scale]));

/** The pins as a frame has them. */
export const pinsAt = (pins: readonly Pin[], frame: Float64Array): Pin[] =>
  pins.map((pin, i) => ({
    ...pin,
    x: frame[perPin * i],
    y: frame[perPin * i + 1],
    angle: frame[perPin * i + 2],
    scale: frame[perPin * i + 3],
  }));

/** The frames as they are played: trimmed, then smoothed, then looped. The take has one at least. */
export function playedFrames(take: Take): Float64Array[] {
  const first = Math.max(0, Math.min(take.first, take.frames.length - 1));
  const end = Math.max(first + 1, Math.min(take.end, take.frames.length));
  return looped(smoothed(take.frames.slice(first, end), take.smooth), take.loop);
}

/**
 * Every round takes a quarter of both neighbours. The first frame and the last stay where they are.
 */
export function smoothed(frames: readonly Float64Array[], rounds: number): Float64Array[] {
  let now = frames.map((frame) => frame.slice());
  for (let round = 0; round < rounds; ++round) {
    now = now.map((frame, i) => {
      const before = now[i - 1];
      const after = now[i + 1];
      if (!before || !after) return frame;
      return frame.map((value, k) => (before[k] + 2 * value + after[k]) / 4);
    });
  }
  return now;
}

/**
 * The last frames go over into those before the first: after the last comes the first without a
 * jump. The take becomes shorter by as many frames as it goes over in.
 */
export function looped(frames: readonly Float64Array[], overlap: number): Float64Array[] {
  const shared = Math.min(Math.max(0, Math.floor(overlap)), Math.floor(frames.length / 2));
  if (shared === 0) return frames.map((frame) => frame.slice());
  const kept = frames.length - shared;
  return frames.slice(0, kept).map((frame, i) => {
    if (i >= shared) return frame.slice();
    // In the beginning still what comes after the end, and less and less of it.
    const t = (i + 1) / (shared + 1);
    return frame.map((value, k) => (1 - t) * frames[kept + i][k] + t * value);
  });
}
