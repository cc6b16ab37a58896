// LiveSocket: one WebSocket and the stream of arapd that it is for.
import type { RawData, WebSocket } from "ws";

import type { DeformStream, HandleEdit, HandleUpdate, StreamOptions } from "@arapd/client";

import type { Caller } from "../caller.js";
import type { Lease } from "../connections.js";
import type { Context } from "../context.js";
import { Problem, detailsOf, foreseen, unforeseen } from "../problems.js";
import { Rate } from "../rate.js";
import { messages } from "../schemas/handles.js";
import type { Open, Said } from "../schemas/handles.js";
import { check } from "../validate.js";
import { Outbox } from "./outbox.js";

export interface SocketFacts {
  session: string;
  caller: Caller;
  requestId: string;
  traceparent: string | undefined;
  /** Something that nobody foresaw. */
  log: (error: unknown) => void;
}

// What edits may take in memory: a stream that is resumed says all of them again.
const mostEditMessages = 16;

const optionsOf = (open: Open, resumeWithin: number): StreamOptions => {
  const { type: _, handleSet: _set, encoding, window: _window, ...rest } = open;
  return {
    ...rest,
    encoding: encoding === "int16" ? "int16_le" : "float32_le",
    relativeToOrigin: true,
    // One that is computed and one that waits: what is newer waits here, so that a busy server has
    // no queue of old updates before it.
    ahead: 2,
    resumeWithin,
  };
};

export class LiveSocket {
  readonly #context: Context;
  readonly #socket: WebSocket;
  readonly #facts: SocketFacts;
  readonly #outbox: Outbox;
  readonly #rate: Rate;
  readonly #stop = new AbortController();
  #stream: DeformStream | undefined;
  #lease: Lease | undefined;
  #opened = false; // an open was said
  #early: Said[] = []; // what was said before the stream was open
  #editBytes = 0;
  #delivery: "latest" | "every" = "latest";
  #answered = true; // the last ping
  readonly #timers: NodeJS.Timeout[] = [];

  constructor(context: Context, socket: WebSocket, facts: SocketFacts) {
    const { metrics, settings } = context;
    this.#context = context;
    this.#socket = socket;
    this.#facts = facts;
    this.#rate = new Rate(settings.maxMessagesPerSecond, settings.maxMessagesPerSecond);
    this.#outbox = new Outbox(socket, {
      sent: () => metrics.shapes.inc(),
      skipped: () => metrics.skipped.inc(),
    });
    socket.on("message", (data, isBinary) => void this.#hear(data, isBinary));
    socket.on("pong", () => (this.#answered = true));
    socket.on("error", () => socket.terminate());
    socket.once("close", () => this.#gone());
    const late = setTimeout(() => {
      if (!this.#opened)
        this.#fail(new Problem("TOO_LATE", "The first message did not come in time."));
    }, settings.openWithinMs);
    const beat = setInterval(() => this.#beat(), settings.socketPingMs);
    this.#timers.push(late.unref(), beat.unref());
  }

  /** The gateway is going away. */
  drain(): void {
    this.#outbox.say({ type: "draining" });
  }

  /** Ends it now. */
  close(code: number): void {
    this.#socket.close(code);
  }
  terminate(): void {
    this.#socket.terminate();
  }

  #beat(): void {
    // A socket that is not read tells nothing.
    if (!this.#answered && !this.#socket.isPaused) return this.#socket.terminate();
    this.#answered = false;
    this.#socket.ping();
  }

  #gone(): void {
    this.#stop.abort();
    for (const timer of this.#timers) clearTimeout(timer);
    this.#outbox.drop();
    this.#stream?.cancel();
    this.#lease?.release();
    this.#early = [];
  }

  #problemOf(error: unknown): Problem {
    const problem = foreseen(error);
    if (!problem) this.#facts.log(error);
    const told = problem ?? unforeseen();
    this.#context.metrics.problems.inc({ reason: told.reason });
    return told;
  }

  // The stream cannot go on.
  #fail(error: unknown): void {
    if (this.#socket.readyState !== this.#socket.OPEN) return;
    const problem = this.#problemOf(error);
    const { requestId } = this.#facts;
    this.#outbox.say({
      type: "problem",
      problem: detailsOf(problem, this.#context.settings.prefix, requestId),
    });
    this.#socket.close(4000 + problem.status, problem.reason);
  }

  // A message was wrong; the stream goes on.
  #refuse(error: unknown, sequence: number | null): void {
    const problem = detailsOf(
      this.#problemOf(error),
      this.#context.settings.prefix,
      this.#facts.requestId,
    );
    this.#outbox.say({ type: "error", sequence, problem });
  }

  async #hear(data: RawData, isBinary: boolean): Promise<void> {
    if (this.#socket.readyState !== this.#socket.OPEN) return;
    const wait = this.#rate.take();
    if (wait > 0) {
      return this.#fail(
        new Problem("RATE_LIMITED", "Too many messages came at once.", { retryAfterMs: wait }),
      );
    }
    let said: Said;
    try {
      said = read(data, isBinary);
    } catch (error) {
      if (!this.#opened) return this.#fail(error);
      return this.#refuse(error, null);
    }
    if (!this.#opened) {
      if (said.type !== "open") {
        return this.#fail(new Problem("MALFORMED", "The first message has to be open."));
      }
      this.#opened = true;
      return this.#open(said);
    }
    if (!this.#stream) {
      this.#early.push(said); // what was read with `open`; the socket waits since
      return;
    }
    await this.#take(said, (data as Buffer).length);
  }

  async #open(open: Open): Promise<void> {
    const { connections, settings } = this.#context;
    const { session, caller, requestId, traceparent } = this.#facts;
    this.#socket.pause();
    try {
      this.#delivery = open.delivery ?? "latest";
      this.#outbox.begin(open.window ?? 0, this.#delivery === "every");
      this.#lease = connections.lease(caller.owner);
      const call = {
        signal: this.#stop.signal,
        requestId,
        ...(traceparent !== undefined && { traceparent }),
      };
      const options = optionsOf(open, settings.resumeWithinMs);
      const stream = await this.#lease.client
        .attachSession(session)
        .openStream(open.handleSet, options, call);
      if (this.#socket.readyState !== this.#socket.OPEN) return stream.cancel();
      this.#stream = stream;
      this.#outbox.say({ type: "opened", handleSet: stream.handleSet, vertices: stream.vertices });
      void this.#read(stream);
      for (const said of this.#early.splice(0)) await this.#take(said, 0);
      this.#socket.resume();
    } catch (error) {
      this.#socket.resume();
      this.#fail(error);
    }
  }

  async #take(said: Said, bytes: number): Promise<void> {
    const stream = this.#stream!;
    try {
      switch (said.type) {
        case "open":
          throw new Problem("MALFORMED", "The stream is open already.");
        case "seen":
          return this.#outbox.seen(said.sequence);
        case "ping":
          return stream.ping(said.nonce ?? 0);
        case "close":
          return stream.closeSending();
        case "update": {
          const { type: _, ...update } = said;
          stream.send(update as HandleUpdate);
          break;
        }
        case "edit": {
          this.#editBytes += bytes;
          if (this.#editBytes > mostEditMessages * this.#context.settings.maxMessageBytes) {
            throw new Problem(
              "RATE_LIMITED",
              "The edits of one stream are too large together; edit the handle set, and open anew.",
            );
          }
          const { type: _, ...edit } = said;
          stream.edit(edit as HandleEdit);
          break;
        }
      }
      // Every update of such a stream is answered, so none may pile up here.
      if (this.#delivery === "every") {
        this.#socket.pause();
        await stream.drained();
        this.#socket.resume();
      }
    } catch (error) {
      const sequence = "sequence" in said ? said.sequence : undefined;
      this.#refuse(error, sequence ?? null);
    }
  }

  async #read(stream: DeformStream): Promise<void> {
    const { metrics } = this.#context;
    try {
      for await (const event of stream) {
        switch (event.kind) {
          case "shape":
            this.#outbox.offer(event.shape);
            if (this.#delivery === "every") await this.#outbox.room();
            break;
          case "error":
            this.#refuse(event.error, event.sequence);
            break;
          case "pong":
            this.#outbox.say({ type: "pong", nonce: event.nonce });
            break;
          case "resumed": {
            const { handleSet, attempts, unanswered } = event;
            metrics.resumed.inc();
            this.#outbox.say({ type: "resumed", handleSet, attempts, unanswered });
            break;
          }
        }
      }
      this.#outbox.finish();
      await this.#outbox.room();
      this.#socket.close(1000);
    } catch (error) {
      if (this.#stop.signal.aborted) return;
      this.#outbox.finish();
      this.#fail(error);
    }
  }
}

// MALFORMED for what is no message.
function read(data: RawData, isBinary: boolean): Said {
  if (isBinary) throw new Problem("MALFORMED", "Messages are texts.");
  let value: unknown;
  try {
    value = JSON.parse((data as Buffer).toString("utf8"));
  } catch (error) {
    throw new Problem("MALFORMED", `The message is no JSON: ${(error as Error).message}.`);
  }
  const type = (value as { type?: unknown } | null)?.type;
  if (typeof type !== "string" || !Object.hasOwn(messages, type)) {
    const known = Object.keys(messages).join(", ");
    throw new Problem("MALFORMED", `The type of a message is one of ${known}.`, { field: "type" });
  }
  check(messages[type as keyof typeof messages], value, "The message");
  return value as Said;
}
