// DeformStream: live deformation. Updates go out, shapes come back, in the order of the updates.
import { workLimit } from "../calls.js";
import type { CallOptions } from "../calls.js";
import type { Channel } from "../channel.js";
import { numberRun } from "../checks.js";
import { badOption } from "../errors.js";
import { Delivery } from "../gen/arap/v1/Delivery.js";
import type { OpenStream } from "../gen/arap/v1/OpenStream.js";
import { handlesToWire, targetsToWire } from "../handles.js";
import type { HandleSetInfo } from "../handles.js";
import { picksToWire, shapeOptionsToWire } from "../shape.js";
import type { KnownSizes } from "../sizes.js";
import { LiveStream } from "./live_stream.js";
import type { Settings } from "./live_stream.js";
import { sequenceOf } from "./messages.js";
import type { Message } from "./messages.js";
import type { HandleEdit, HandleUpdate, StreamEvent, StreamOptions } from "./options.js";

function settingsOf(options: StreamOptions): Settings {
  const { heartbeat = 5000, silence = 30_000, answer = workLimit, resumeWithin = 0 } = options;
  for (const [name, time] of Object.entries({ heartbeat, silence, answer, resumeWithin })) {
    if (!(time >= 0))
      throw badOption(name, `${name} is ${time}, which is no number of milliseconds.`);
  }
  if (options.delivery && options.delivery !== "latest" && options.delivery !== "every") {
    throw badOption(
      "delivery",
      `delivery is ${JSON.stringify(options.delivery)}, which is none of latest, every.`,
    );
  }
  if (options.ahead !== undefined && !(options.ahead >= 1)) {
    throw badOption("ahead", `ahead is ${options.ahead}; it has to be 1 or more.`);
  }
  // The caller's own list may change meanwhile.
  const subset = options.vertexSubset && { vertexSubset: Uint32Array.from(options.vertexSubset) };
  return { ...options, ...subset, heartbeat, silence, answer, resumeWithin };
}

/**
 * A live stream, made by Session.openStream.
 *
 * ```ts
 * stream.send({ targets: [{ id: "hand", x: 3, y: 4 }] });
 * for await (const event of stream) if (event.kind === "shape") draw(event.shape.positions);
 * ```
 *
 * One that is asked to resume (StreamOptions.resumeWithin) survives its server: reading opens it
 * again, on whichever server answers, says again what the new one has to know (targets, the
 * stream's own edits, whatever has no answer yet), and answers "resumed". The shapes that follow
 * are those of an uninterrupted stream, and no answer comes twice. Somebody has to read for that.
 * Memory: a target per handle and edit, and what has no answer yet; of the updates to a "latest"
 * stream, which newer ones replace, a few hundred.
 */
export class DeformStream implements AsyncIterable<StreamEvent> {
  readonly #live: LiveStream;
  #sequence = 0; // the last that was sent

  /** Waits until the server has opened the stream. Session.openStream calls it. */
  static async open(
    channel: Channel,
    sizes: KnownSizes,
    sessionId: string,
    handleSetId: string,
    options: StreamOptions,
    call: CallOptions,
  ): Promise<DeformStream> {
    const open: OpenStream = {
      sessionId,
      handleSetId,
      delivery: options.delivery === "every" ? Delivery.DELIVERY_EVERY : Delivery.DELIVERY_LATEST,
      options: shapeOptionsToWire(options),
    };
    const live = new LiveStream(channel, sizes, open, settingsOf(options), call);
    await live.open();
    return new DeformStream(live);
  }

  private constructor(live: LiveStream) {
    this.#live = live;
  }

  /** The handle set as it was when the stream opened. */
  get handleSet(): HandleSetInfo {
    return this.#live.handleSet;
  }

  /** Which vertices all shapes of the stream are of, in their order; null: all. */
  get vertices(): Uint32Array | null {
    return this.#live.vertices;
  }

  /**
   * Sends an update, and answers its sequence. Never waits: on a "latest" stream updates that the
   * transport has not taken yet are merged, their targets kept; on an "every" stream they queue up,
   * so wait for `drained` between them. PROTOCOL: the stream is over, reading tells why.
   * INVALID_OPTION: the sequence has not grown.
   */
  send(update: HandleUpdate): number {
    return this.#say({
      update: {
        sequence: this.#next(update.sequence),
        targets: targetsToWire(update.targets ?? []),
        positions: numberRun(update.positions ?? [], "positions"),
        pickPoints: picksToWire(update.pickPoints ?? [], "pick_points"),
        measure: update.measure ?? false,
      },
    });
  }

  /**
   * Changes the handle set of this stream, and answers the sequence. The answer is a shape with the
   * next revision, always measured.
   */
  edit(edit: HandleEdit): number {
    const { remove = [], add = [] } = edit;
    const sequence = this.#next(edit.sequence);
    return this.#say({ edit: { sequence, remove: [...remove], add: handlesToWire(add, "add") } });
  }

  /** Asks for a sign of life. */
  ping(nonce = 0): void {
    if (!Number.isSafeInteger(nonce) || nonce < 0)
      throw badOption("nonce", `The nonce ${nonce} is no whole number.`);
    this.#live.ping(nonce);
  }

  /**
   * Says that nothing more will be sent. The server answers what is pending and ends the stream.
   */
  closeSending(): void {
    this.#live.closeSending();
  }

  /** Waits until everything that was sent is handed to the transport, or the stream is over. */
  drained(): Promise<void> {
    return this.#live.drained();
  }

  /**
   * Waits for the next event; one reader at a time. Undefined: the stream ended well. Rejects when
   * it is broken, when the server sent what was not asked for (INTERNAL), or when it could not be
   * resumed in time; further reads do the same.
   */
  read(): Promise<StreamEvent | undefined> {
    return this.#live.read();
  }

  /** Ends the stream at once; a waiting read rejects with CANCELLED. */
  cancel(): void {
    this.#live.cancel();
  }

  /**
   * The events until the stream ends. Leaving the loop leaves the stream open: read on later, or
   * cancel it.
   */
  async *[Symbol.asyncIterator](): AsyncGenerator<StreamEvent, void> {
    for (let event = await this.read(); event; event = await this.read()) yield event;
  }

  #next(sequence = this.#sequence + 1): number {
    if (Number.isSafeInteger(sequence) && sequence > this.#sequence) return sequence;
    throw badOption(
      "sequence",
      `The sequence ${sequence} is no whole number above the last one, ${this.#sequence}.`,
    );
  }

  #say(message: Message): number {
    this.#live.send(message);
    return (this.#sequence = sequenceOf(message));
  }
}
