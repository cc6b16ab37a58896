// LiveStream: what a DeformStream holds. The call of the moment, and what outlives it: which
// answers are due, what would have to be said again, and who is still there.
import { CallHeaders, deadlineOf } from "../calls.js";
import type { CallOptions } from "../calls.js";
import type { Channel } from "../channel.js";
import type { MeshSize } from "../checks.js";
import { badAnswer, errorOf, isFull, outOfOrder } from "../errors.js";
import type { ArapError } from "../errors.js";
import type { OpenStream } from "../gen/arap/v1/OpenStream.js";
import type { ShapeAnswer } from "../gen/arap/v1/Shape.js";
import type { StreamDeformResponseAnswer } from "../gen/arap/v1/StreamDeformResponse.js";
import { handleSetOf } from "../handles.js";
import type { HandleSetInfo } from "../handles.js";
import { verticesOf } from "../positions.js";
import { MeasureCount, shapeOf } from "../shape.js";
import type { KnownSizes } from "../sizes.js";
import { AwaitedAnswers, SignsOfLife } from "./awaited.js";
import { Ending, Trouble, endingOf, errorFrom, overdueOf, streamCancelled } from "./ending.js";
import { MergeRule } from "./merge_rule.js";
import { isEdit, sequenceOf } from "./messages.js";
import type { Message } from "./messages.js";
import type { StreamEvent, StreamOptions } from "./options.js";
import { ReplayLog } from "./replay_log.js";
import { StreamCall } from "./stream_call.js";

/** The options with their defaults. */
export type Settings = StreamOptions & {
  heartbeat: number;
  silence: number;
  answer: number;
  resumeWithin: number;
};

const now = (): number => performance.now();
export class LiveStream {
  handleSet!: HandleSetInfo; // as it was when the stream opened
  vertices: Uint32Array | null = null; // which ones the shapes are of; null: all
  #channel: Channel;
  #ownChannel: Channel | undefined; // one that was made after silence
  readonly #sizes: KnownSizes;
  readonly #settings: Settings;
  readonly #deadline: number;
  readonly #headers: CallHeaders;
  readonly #openMessage: OpenStream;
  readonly #log: ReplayLog | undefined; // when it resumes
  readonly #awaited: AwaitedAnswers;
  readonly #life: SignsOfLife;
  readonly #merge = new MergeRule();
  readonly #stopping = new AbortController(); // no more attempts
  readonly #unhook: () => void;
  #watch: NodeJS.Timeout | undefined;
  #mesh: MeshSize | undefined; // once it is known
  #measures: MeasureCount; // of the call of the moment
  #call: StreamCall | undefined; // of the moment
  #open = false; // it may be pushed on
  #onOpen: (() => void)[] = [];
  #sendingClosed = false;
  #cancelled = false;
  #silent = false; // for so long that the call was given up
  #overdue: ArapError | undefined; // why it was given up for good
  #waitingSince: number | undefined; // since when an opening or an event is waited for
  #reading = false;
  #trouble: Trouble | undefined;
  #end: { error: ArapError | undefined } | undefined; // how the stream ended

  constructor(
    channel: Channel,
    sizes: KnownSizes,
    open: OpenStream,
    settings: Settings,
    call: CallOptions,
  ) {
    this.#channel = channel;
    this.#sizes = sizes;
    this.#settings = settings;
    this.#deadline = deadlineOf(call, Infinity);
    this.#headers = new CallHeaders(open.sessionId ?? "", call);
    this.#openMessage = open;
    const latest = settings.delivery !== "every";
    this.#log = settings.resumeWithin > 0 ? new ReplayLog(latest) : undefined;
    this.#awaited = new AwaitedAnswers(!latest);
    this.#measures = new MeasureCount(settings);
    this.#life = new SignsOfLife(settings.heartbeat, settings.silence);
    this.#unhook = channel.onStop(call.signal, () => this.cancel());
  }

  /** Opens the first call. Once, first. */
  async open(): Promise<void> {
    const { heartbeat, silence, answer } = this.#settings;
    const shortest = heartbeat > 0 ? Math.min(heartbeat, silence, answer) : answer;
    this.#watch = setInterval(
      () => this.#look(),
      Math.min(Math.max(shortest / 2, 1), 3_600_000),
    ).unref();
    try {
      this.handleSet = await this.#openCall();
    } catch (ending) {
      const error = ending instanceof Ending ? ending.error : errorFrom(ending);
      this.#finish(error);
      throw error;
    }
    this.#merge.restart(this.handleSet);
    this.#mesh = this.#sizes.ofMesh(this.handleSet.meshId);
    this.#waitingSince = undefined;
    this.#open = true;
  }

  /** Sequences grow. */
  send(message: Message): void {
    this.#checkSending();
    this.#log?.sent(message);
    if (!this.#open) return; // said again when it is
    if (isEdit(message)) this.#merge.sent(message.edit);
    this.#awaited.sent(message, now());
    this.#call?.push(message);
  }

  ping(nonce: number): void {
    this.#checkSending();
    this.#pushPing(nonce);
  }

  closeSending(): void {
    if (this.#sendingClosed) return;
    this.#checkSending();
    this.#sendingClosed = true;
    if (this.#open) this.#call?.pushEnd();
  }

  async drained(): Promise<void> {
    while (!this.#end && !this.#cancelled) {
      const call = this.#open ? this.#call : undefined;
      await (call ? call.drained() : new Promise<void>((resolve) => this.#onOpen.push(resolve)));
      if (call && this.#open && call === this.#call) return;
    }
  }

  cancel(): void {
    this.#cancelled = true;
    this.#call?.cancel();
    this.#stopping.abort();
    this.#wake();
    // Who waits for a message ends the stream when the call has ended.
    if (!this.#reading) this.#finish(streamCancelled());
  }

  async read(): Promise<StreamEvent | undefined> {
    if (this.#reading) throw outOfOrder("Somebody reads this stream already.");
    this.#reading = true;
    try {
      for (;;) {
        if (this.#end?.error) throw this.#end.error;
        if (this.#end) return undefined;
        this.#waitingSince ??= now();
        const event = await this.#readOne(this.#call!);
        if (event) {
          this.#waitingSince = undefined;
          return event;
        }
      }
    } finally {
      this.#reading = false;
    }
  }

  #checkSending(): void {
    if (this.#sendingClosed) throw outOfOrder("Sending on this stream was closed.");
    if (this.#end || this.#cancelled) throw outOfOrder("The stream is over; reading tells why.");
  }

  #finish(error: ArapError | undefined): void {
    this.#end ??= { error };
    this.#open = false;
    clearInterval(this.#watch);
    this.#unhook();
    this.#call?.cancel();
    this.#ownChannel?.close();
    this.#wake();
  }

  #wake(): void {
    for (const resolve of this.#onOpen.splice(0)) resolve();
  }

  // The event of the next message; nothing when it is not the user's, or when the stream is over.
  async #readOne(call: StreamCall): Promise<StreamEvent | undefined> {
    let ending: Ending;
    const message = await this.#next(call);
    if (message) {
      try {
        return this.#eventOf(message);
      } catch (thrown) {
        call.cancel();
        const error = errorFrom(thrown);
        ending = new Ending(error, isFull(error));
      }
    } else {
      ending = this.#endOf(call);
    }
    if (ending.lost && ending.error && this.#log) {
      try {
        return await this.#resume(ending.error, this.#log);
      } catch (thrown) {
        ending = new Ending(errorFrom(thrown), false);
      }
    }
    this.#finish(ending.error);
    return undefined;
  }

  // The next message, with the silence watched.
  async #next(call: StreamCall): Promise<StreamDeformResponseAnswer | undefined> {
    this.#life.setWaiting(true, now());
    const message = await call.read();
    this.#life.setWaiting(false, now());
    return message;
  }

  #endOf(call: StreamCall): Ending {
    return endingOf(call.status!, {
      cancelled: this.#cancelled,
      silence: this.#silent ? this.#settings.silence : undefined,
      overdue: this.#overdue,
      awaiting: this.#awaited.oldest !== undefined,
    });
  }

  // Notes the answer to a sequence. Whether there was one before.
  #known(sequence: number, good: boolean): boolean {
    this.#merge.answered(sequence, good);
    const seen = this.#log !== undefined && !this.#log.answered(sequence, good);
    if ((good || !seen) && this.#trouble?.isOver(sequence)) this.#trouble = undefined;
    return seen;
  }

  #eventOf(message: StreamDeformResponseAnswer): StreamEvent | undefined {
    if (message.shape) return this.#shapeOf(message.shape);
    if (message.error?.status) {
      const { sequence, status } = message.error;
      const error = errorOf(status);
      this.#awaited.take(sequence);
      // What had worked does not work again: the shapes would be others.
      if (this.#known(sequence, false)) throw error;
      return { kind: "error", sequence, error };
    }
    if (message.pong) return this.#takePong(message.pong.nonce);
    throw badAnswer("The server sent a message that does not belong here.");
  }

  #shapeOf(answer: ShapeAnswer): StreamEvent | undefined {
    const asked = this.#awaited.take(answer.sequence);
    const measured = asked.measured || this.#measures.isDue();
    this.#measures.answered(answer.unmeasured);
    if (this.#known(answer.sequence, true)) return undefined;
    const vertices = this.vertices;
    const shape = shapeOf(answer, {
      options: this.#settings,
      mesh: this.#mesh,
      vertices,
      picks: asked.picks,
      measured,
    });
    // Of a mesh that was never seen, the shapes have at least one size.
    if (!vertices) this.#mesh ??= { vertices: shape.local.length / 2, triangles: Infinity };
    shape.replaced += this.#merge.takeMerged(shape.sequence);
    return { kind: "shape", shape };
  }

  // A new call, opened by the server; its handle set. It is the call of the moment, but nothing is
  // pushed before #open.
  async #openCall(): Promise<HandleSetInfo> {
    const call = new StreamCall(this.#channel, this.#headers.of(this.#channel), this.#deadline, {
      latest: this.#settings.delivery !== "every",
      ahead: this.#settings.delivery === "every" ? Infinity : (this.#settings.ahead ?? Infinity),
      mayMerge: this.#merge.allows,
      onMerged: (count, sequence) => this.#merge.merged(count, sequence),
    });
    call.push({ open: this.#openMessage });
    this.#call?.cancel();
    this.#call = call;
    this.#measures = new MeasureCount(this.#settings);
    this.#silent = false;
    this.#waitingSince = now();
    this.#life.restart(now());
    if (this.#cancelled) call.cancel();
    // The server may have much to compute before it has opened; meanwhile it answers pings.
    for (;;) {
      const message = await this.#next(call);
      if (!message) {
        const ending = this.#endOf(call);
        throw ending.error
          ? ending
          : new Ending(badAnswer("The server ended the stream without opening it."), false);
      }
      if (message.opened) {
        const asked = { id: this.#openMessage.handleSetId ?? "" };
        const set = handleSetOf(message.opened.handleSet, asked, this.#sizes.ofMesh);
        this.#sizes.knowSet(set.id, set.meshId);
        this.vertices = verticesOf(
          message.opened.vertices,
          this.#settings,
          this.#sizes.ofMesh(set.meshId),
        );
        return set;
      }
      if (!message.pong)
        throw new Ending(badAnswer("The server answered before it opened the stream."), false);
      this.#takePong(message.pong.nonce);
    }
  }

  // Opens again after the loss that `error` tells of, for as long as the options say. The event, or
  // throws the last error.
  async #resume(error: ArapError, log: ReplayLog): Promise<StreamEvent> {
    this.#open = false;
    const { resumeWithin } = this.#settings;
    const again = this.#trouble?.isRecent(resumeWithin) === true;
    if (!again || !this.#trouble) this.#trouble = new Trouble(resumeWithin);
    const trouble = this.#trouble;
    const unanswered = log.pending;
    for (let attempts = 1; ; attempts++) {
      if (again || attempts > 1) await trouble.pause(error, this.#deadline, this.#stopping.signal);
      if (this.#silent) {
        this.#ownChannel?.close();
        this.#channel = this.#ownChannel = this.#channel.another();
      }
      try {
        const handleSet = await this.#openCall();
        this.#sayAgain(handleSet, trouble, log);
        return { kind: "resumed", handleSet, attempts, unanswered };
      } catch (thrown) {
        const ending = thrown instanceof Ending ? thrown : new Ending(errorFrom(thrown), false);
        error = ending.error ?? error;
        if (!ending.lost && !isFull(error)) throw error;
      }
    }
  }

  #sayAgain(handleSet: HandleSetInfo, trouble: Trouble, log: ReplayLog): void {
    const messages = log.messages();
    const last = messages.at(-1);
    if (last) trouble.opened(sequenceOf(last));
    else this.#trouble = undefined;
    this.#merge.restart(handleSet);
    this.#awaited.restart(messages, now());
    this.#open = true;
    for (const message of messages) {
      if (isEdit(message)) this.#merge.sent(message.edit);
      this.#call?.push(message);
    }
    for (const nonce of this.#life.unanswered()) this.#call?.push({ ping: { nonce } });
    if (this.#sendingClosed) this.#call?.pushEnd();
    this.#wake();
  }

  #pushPing(nonce: number | undefined): void {
    this.#life.ask(nonce, this.#open, now());
    if (this.#open || nonce === undefined) this.#call?.push({ ping: { nonce: nonce ?? 0 } });
  }

  #takePong(nonce: number): StreamEvent | undefined {
    if (!this.#life.isDueAnswer(nonce))
      throw badAnswer("The server answered a ping that was not sent.");
    return this.#life.answered() === undefined ? undefined : { kind: "pong", nonce };
  }

  // Why the call is not to be waited for any longer; nothing as long as it is.
  #overdueAt(call: StreamCall, time: number): ArapError | undefined {
    return overdueOf(time, this.#settings.answer, {
      writingSince: call.writingSince,
      waitingSince: this.#waitingSince,
      open: this.#open,
      oldest: this.#awaited.oldest,
      sendingClosed: this.#sendingClosed,
    });
  }

  // Asks for signs of life, and gives up a call on which nothing happens.
  #look(): void {
    const call = this.#call;
    if (!call || this.#end || this.#cancelled) return;
    const time = now();
    const asks = this.#settings.heartbeat > 0;
    if (asks && this.#life.isSilent(time)) {
      this.#silent = true;
      call.cancel();
    } else if (!this.#overdue && (this.#overdue = this.#overdueAt(call, time))) {
      call.cancel();
    } else if (
      asks &&
      !(this.#open && this.#sendingClosed) &&
      this.#life.isDue(call.isClear, time)
    ) {
      this.#pushPing(undefined);
    }
  }
}
