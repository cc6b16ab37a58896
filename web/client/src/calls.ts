// Calls: what may be said about any of them, how long they take at most, when they are made again.
import { randomBytes } from "node:crypto";
import { setTimeout as sleep } from "node:timers/promises";

import { status as codes } from "@grpc/grpc-js";
import type { ClientReadableStream, Metadata } from "@grpc/grpc-js";

import type { Channel } from "./channel.js";
import { isName } from "./channel.js";
import { ArapError, badOption, cancelled, errorOfCall, isLost, overdue } from "./errors.js";
import type { CallStatus } from "./errors.js";
import type { Method } from "./wire.js";

/**
 * What may be said about any call. Times are in milliseconds.
 *
 * A call that was lost (the server is gone, going away, or was never reached) or that the server
 * refused before it began is made again, after growing pauses of 50 ms to 2 s or as long as the
 * server asks: by what only asks and by what gives the same when it is done twice (get…, list…,
 * flatten, deform, createSession, registerMesh, compileHandles, submitFlatten, cancelJob, and
 * delete…, where nothing to delete after a lost answer means that it was done); by editHandles only
 * when the server says that it had not begun; never by deformTrack. Streams resume when asked to.
 */
export interface CallOptions {
  /**
   * How long the call may take with all its attempts. Default 30 s for look-ups and 10 min for
   * work. Infinity: ever.
   */
  timeout?: number;
  /** Aborting it cancels the call, which then fails with CANCELLED; a stream is ended by it. */
  signal?: AbortSignal;
  /** For how long after its first failure a call is made again. Default 5000; 0: not at all. */
  retryWithin?: number;
  /** W3C's "traceparent" of what the call is part of. Default: a trace of its own. */
  traceparent?: string;
  /** What the server's logs call it: a name as ids are. Default: 128 random bits. */
  requestId?: string;
}

export const quickLimit = 30_000;
export const workLimit = 600_000;

/**
 * What a method is by default: whether making it twice does harm, and how long it takes at most.
 */
export interface Manner {
  repeat: "harmless" | "removal" | "never";
  limit: number;
}
export const lookUp: Manner = { repeat: "harmless", limit: quickLimit };
export const work: Manner = { repeat: "harmless", limit: workLimit };
export const removal: Manner = { repeat: "removal", limit: quickLimit };
export const change: Manner = { repeat: "never", limit: workLimit };

export const randomHex = (bytes: number): string => randomBytes(bytes).toString("hex");

/** When a call that begins now has to be over, in milliseconds of Date.now(); Infinity: never. */
export function deadlineOf(options: CallOptions, limit: number): number {
  const time = options.timeout ?? limit;
  if (Number.isNaN(time)) throw badOption("timeout", "A timeout is a number of milliseconds.");
  return Date.now() + time;
}

/** The headers of one call, the same for all its attempts. */
export class CallHeaders {
  readonly requestId: string;
  readonly #sessionId: string;
  readonly #traceparent: string;

  constructor(sessionId: string, options: CallOptions) {
    this.#sessionId = sessionId;
    const { requestId = "" } = options;
    this.requestId = isName(requestId) ? requestId : randomHex(16);
    const given = options.traceparent ?? "";
    const own = `00-${randomHex(16)}-${randomHex(8)}-01`;
    this.#traceparent = /^00-[0-9a-f]{32}-[0-9a-f]{16}-[0-9a-f]{2}$/.test(given) ? given : own;
  }
  of(channel: Channel): Metadata {
    const metadata = channel.metadata();
    // A header cannot carry everything; the server refuses what is no name anyway.
    if (isName(this.#sessionId)) metadata.set("x-session-id", this.#sessionId);
    metadata.set("x-request-id", this.requestId);
    metadata.set("traceparent", this.#traceparent);
    return metadata;
  }
}

/**
 * Pauses: from 50 ms on twice as long each time, up to 2 s, and between half of that and all of it.
 */
export class Backoff {
  #next = 50;
  next(): number {
    const most = this.#next;
    this.#next = Math.min(2 * most, 2000);
    return most * (0.5 + Math.random() / 2);
  }
}

/** One attempt of a call: its metadata, its deadline, and where to say how to cancel it. */
export interface Attempt {
  metadata: Metadata;
  deadline: number;
  onCancel(cancel: () => void): void;
}
export class CallFailed extends Error {
  constructor(readonly status: CallStatus) {
    super(status.details);
  }
}

// Whether the server itself says that it has not begun, and that trying again helps.
const isRefused = (error: ArapError): boolean =>
  (error.reason === "OVERLOADED" || error.reason === "DRAINING") && error.retryAfter !== undefined;

/**
 * Makes a call, and again as its manner allows. `attempt` makes it once and rejects with
 * CallFailed; where the answer comes in pieces, `heard` says whether one came since: then
 * retryWithin counts anew.
 */
export async function makeCall<T>(
  channel: Channel,
  manner: Manner,
  options: CallOptions,
  sessionId: string,
  attempt: (call: Attempt) => Promise<T>,
  heard: () => boolean = () => false,
): Promise<T | undefined> {
  const deadline = deadlineOf(options, manner.limit);
  const headers = new CallHeaders(sessionId, options);
  const backoff = new Backoff();
  const { signal } = options;
  const stopping = new AbortController();
  let cancel = (): void => {};
  const unhook = channel.onStop(signal, () => {
    stopping.abort();
    cancel();
  });
  if (signal?.aborted) stopping.abort();
  let giveUp: number | undefined; // from the first failure on, or the last piece
  let inDoubt = false; // an attempt may have been carried out
  // For how long to wait before the next attempt; throws the error with which to give up.
  // Undefined: it was done before.
  const pauseAfter = (failed: CallFailed): number | undefined => {
    const error = withId(errorOfCall(failed.status), headers);
    if (inDoubt && manner.repeat === "removal" && error.reason === "NOT_FOUND") return undefined;
    const lost = manner.repeat !== "never" && isLost(failed.status);
    if (!isRefused(error) && !lost) throw error;
    inDoubt ||= !isRefused(error);
    const pause = Math.max(backoff.next(), error.retryAfter ?? 0);
    const now = Date.now();
    if (giveUp === undefined || heard()) giveUp = now + (options.retryWithin ?? 5000);
    if (now + pause >= giveUp || now + pause >= deadline) throw error;
    return pause;
  };
  try {
    for (;;) {
      if (stopping.signal.aborted) throw withId(cancelled("The call was cancelled."), headers);
      try {
        return await attempt({
          metadata: headers.of(channel),
          deadline,
          onCancel: (how) => (cancel = how),
        });
      } catch (failed) {
        if (failed instanceof ArapError) throw withId(failed, headers);
        if (!(failed instanceof CallFailed)) throw failed;
        if (stopping.signal.aborted) continue;
        const pause = pauseAfter(failed);
        if (pause === undefined) return undefined;
        await sleep(pause, undefined, { signal: stopping.signal }).catch(() => {});
      }
    }
  } finally {
    unhook();
  }
}

function withId(error: ArapError, headers: CallHeaders): ArapError {
  error.requestId = headers.requestId;
  return error;
}

/** One unary call. Undefined after a removal whose answer was lost. */
export function unary<Request, Answer>(
  channel: Channel,
  method: Method<Request, Answer>,
  request: Request,
  manner: Manner,
  options: CallOptions,
  sessionId = "",
): Promise<Answer | undefined> {
  const attempt = ({ metadata, deadline, onCancel }: Attempt): Promise<Answer> =>
    new Promise((resolve, reject) => {
      const call = channel.grpc.makeUnaryRequest(
        method.path,
        method.requestSerialize,
        method.responseDeserialize,
        request,
        metadata,
        { deadline },
        (error, answer) => (error ? reject(new CallFailed(error)) : resolve(answer as Answer)),
      );
      onCancel(() => call.cancel());
    });
  return makeCall(channel, manner, options, sessionId, attempt);
}

/** The answer of a call that always has one. */
export async function ask<Request, Answer>(
  channel: Channel,
  method: Method<Request, Answer>,
  request: Request,
  manner: Manner,
  options: CallOptions,
  sessionId = "",
): Promise<Answer> {
  return (await unary(channel, method, request, manner, options, sessionId)) as Answer;
}

/**
 * Reads an answer in pieces to its end; `take` gets each. A piece that does not come within
 * `patience` is DEADLINE_EXCEEDED with the sentence `late`.
 */
export async function* pieces<Request, Answer>(
  channel: Channel,
  method: Method<Request, Answer>,
  request: Request,
  call: Attempt,
  patience: number,
  late: () => string,
): AsyncGenerator<Answer> {
  const stream: ClientReadableStream<Answer & object> = channel.grpc.makeServerStreamRequest(
    method.path,
    method.requestSerialize,
    method.responseDeserialize,
    request,
    call.metadata,
    { deadline: call.deadline },
  );
  call.onCancel(() => stream.cancel());
  const ended = new Promise<CallStatus>((resolve) => stream.on("status", resolve));
  stream.on("error", () => {});
  let isLate = false;
  let timer: NodeJS.Timeout | undefined;
  const wait = (): void => {
    timer = setTimeout(() => {
      isLate = true;
      stream.cancel();
    }, patience);
  };
  try {
    wait();
    try {
      for await (const piece of stream) {
        clearTimeout(timer);
        yield piece as Answer;
        wait();
      }
    } catch {
      // The status says why.
    }
    const status = await ended;
    if (isLate) throw overdue(late());
    if (status.code !== codes.OK) throw new CallFailed(status);
  } finally {
    clearTimeout(timer);
    stream.cancel();
  }
}
