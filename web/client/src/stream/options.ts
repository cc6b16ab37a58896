// What is said on a live stream, and what comes back.
import type { ArapError } from "../errors.js";
import type { Handle, HandleSetInfo, HandleTarget } from "../handles.js";
import type { Numbers } from "../runs.js";
import type { Shape, ShapeOptions } from "../shape.js";

/** How to stream. Times are in milliseconds. */
export interface StreamOptions extends ShapeOptions {
  /**
   * "latest", the default: a new update replaces one that has not started, on the server and on its
   * way to it. "every": every update is answered.
   */
  delivery?: "latest" | "every";
  /**
   * On a "latest" stream, how many updates and edits may be without answer, 1 or more: newer updates
   * wait here meanwhile and become one, so that nothing queues up on the way to a server that has
   * much to do. Somebody has to read for that. Default: any number.
   */
  ahead?: number;
  /**
   * After this much silence the server is asked for a sign of life. Default 5000; 0: never. The
   * stream then counts as used also when nobody moves a handle, and a server that is gone is
   * noticed also behind a proxy that answers for it.
   */
  heartbeat?: number;
  /**
   * A read, or an opening, that hears nothing for so long counts the server as gone. Default 30
   * 000. Longer than the longest frame. Ignored when heartbeat is 0.
   */
  silence?: number;
  /**
   * For how long an opening, an update, an edit or the end may be without answer while somebody
   * reads, and a message without being taken, whatever signs of life there are. The stream then
   * ends with DEADLINE_EXCEEDED. Default 10 min.
   */
  answer?: number;
  /**
   * For how long a stream that was lost is opened again and again, growing pauses of up to 2 s
   * apart, until the server has caught up. Default 0: not at all. Lost is what ended with the
   * server gone or going away; after silence the next attempt is made over a new connection. A
   * server that has no room is asked again too. Anything else is final.
   */
  resumeWithin?: number;
}

/** Moves handles: give targets, or positions. */
export interface HandleUpdate {
  /** Grows with every update and edit; answers repeat it. Default: one more than the last. */
  sequence?: number;
  /** Any subset of the handles; the others stay where they are. */
  targets?: readonly HandleTarget[];
  /** All handles in the order of the set, x y x y…; angles and scales stay. */
  positions?: Numbers;
  /** Deformed points x y x y… to map back to rest, at most 1024. */
  pickPoints?: Numbers;
  /**
   * Measure the shape whatever measureEvery says, or the one that answers a newer update in its
   * place. Where a hand rests, an update of this alone asks for the quality of what stays.
   */
  measure?: boolean;
}

/** Changes the handles of this stream; removals come first. */
export interface HandleEdit {
  /** As that of an update. */
  sequence?: number;
  remove?: readonly string[];
  /** Each starts where the current shape has it. */
  add?: readonly Handle[];
}

/** What a stream answers. */
export type StreamEvent =
  | { kind: "shape"; shape: Shape }
  /** A bad update or edit. The stream goes on. */
  | { kind: "error"; sequence: number; error: ArapError }
  | { kind: "pong"; nonce: number }
  /**
   * The stream was lost and goes on, perhaps on another server. The set is as the session holds it
   * now, without the stream's own edits. `unanswered` updates and edits were on their way and have
   * been said again.
   */
  | { kind: "resumed"; handleSet: HandleSetInfo; attempts: number; unanswered: number };
