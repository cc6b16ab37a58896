// StreamCall: one bidirectional call of a stream, from its opening to its status.
import { InterceptingCall, status as codes } from "@grpc/grpc-js";
import type { CallOptions, ClientDuplexStream, Interceptor, Metadata } from "@grpc/grpc-js";

import type { Channel } from "../channel.js";
import type { CallStatus } from "../errors.js";
import type { StreamDeformRequest } from "../gen/arap/v1/StreamDeformRequest.js";
import type { StreamDeformResponseAnswer } from "../gen/arap/v1/StreamDeformResponse.js";
import { deformation } from "../wire.js";
import { fold, isEdit, sequenceOf } from "./messages.js";
import type { Message, Update } from "./messages.js";

// From so many waiting messages on a "latest" stream sends few in their place.
const mostWaiting = 8;

// A stream of Node.js reads many messages ahead. This one asks for the next when somebody waits for
// it, so that a slow reader sees the newest shape and not one of a second ago: the server keeps
// nothing older.
class OnDemand extends InterceptingCall {
  #wanted = false;
  #asked = false;

  want(): void {
    this.#wanted = true;
    this.#pass();
  }
  override startRead(): void {
    this.#asked = true;
    this.#pass();
  }
  #pass(): void {
    if (!this.#wanted || !this.#asked) return;
    this.#wanted = this.#asked = false;
    super.startRead();
  }
}

/** How a call treats what waits to be sent. */
export interface Sending {
  /** Whether newer updates take the place of older ones. */
  latest: boolean;
  /** How many updates and edits may be without answer; newer ones wait, and become fewer. */
  ahead: number;
  /** Whether an update is surely a good one: the error of a bad one has to be its own. */
  mayMerge(update: Update): boolean;
  /** So many updates up to this sequence were merged into newer ones. */
  onMerged(count: number, sequence: number): void;
}

export class StreamCall {
  /** Set when the call is over. */
  status: CallStatus | undefined;
  /** Since when a message waits to be taken. */
  writingSince: number | undefined;
  readonly #sending: Sending;
  readonly #stream: ClientDuplexStream<StreamDeformRequest, StreamDeformResponseAnswer>;
  #gate!: OnDemand;
  #waiting: StreamDeformRequest[] = [];
  #unanswered: number[] = []; // sequences
  #released = 0; // so many of those that wait go out, whatever has no answer
  #shortenAt = mostWaiting; // when there are more than so many
  #endWanted = false;
  #endSent = false;
  #broken = false; // nothing more can be sent
  #ended = false; // nothing more can be read
  #final: CallStatus | undefined;
  #reader: ((message: StreamDeformResponseAnswer | undefined) => void) | undefined;
  #read: StreamDeformResponseAnswer[] = [];
  #onDrained: (() => void)[] = [];

  constructor(channel: Channel, metadata: Metadata, deadline: number, sending: Sending) {
    this.#sending = sending;
    const gate: Interceptor = (options, next) => (this.#gate = new OnDemand(next(options)));
    const options: CallOptions = { deadline, interceptors: [gate] };
    const { path, requestSerialize, responseDeserialize } = deformation.StreamDeform;
    this.#stream = channel.grpc.makeBidiStreamRequest(
      path,
      requestSerialize,
      responseDeserialize,
      metadata,
      options,
    );
    this.#stream.on("data", (message: StreamDeformResponseAnswer) => this.#take(message));
    this.#stream.on("error", () => {}); // the status says the same
    this.#stream.on("status", (status: CallStatus) => {
      this.#final = status;
      if (this.#ended || status.code !== codes.OK) this.#finish();
    });
    this.#stream.on("end", () => {
      this.#ended = true;
      if (this.#final) this.#finish();
    });
  }

  /** Sends behind what waits. Nothing happens when the call is over. */
  push(request: StreamDeformRequest): void {
    if (this.status || this.#broken || this.#endWanted) return;
    this.#waiting.push(request);
    if (this.#sending.latest && this.#waiting.length > this.#shortenAt) this.#shorten();
    this.#write();
  }
  /** Says that nothing more comes. */
  pushEnd(): void {
    this.#endWanted = true;
    this.#write();
  }

  /** Whether the transport takes more. */
  get isClear(): boolean {
    return (
      !this.status && !this.#broken && this.#waiting.length === 0 && this.writingSince === undefined
    );
  }
  /** Waits until everything is handed to the transport, or the call is over. */
  drained(): Promise<void> {
    if (this.isClear || this.status || this.#broken) return Promise.resolve();
    return new Promise((resolve) => this.#onDrained.push(resolve));
  }

  /** The next message; undefined when the call is over, then `status` is set. One at a time. */
  read(): Promise<StreamDeformResponseAnswer | undefined> {
    const message = this.#read.shift();
    if (message || this.status) return Promise.resolve(message);
    return new Promise((resolve) => {
      this.#reader = resolve;
      this.#gate.want();
    });
  }

  cancel(): void {
    if (!this.status) this.#stream.cancel();
  }

  #take(message: StreamDeformResponseAnswer): void {
    const answered = message.shape?.sequence ?? message.error?.sequence;
    if (answered !== undefined) this.#answered(answered);
    const reader = this.#reader;
    this.#reader = undefined;
    if (reader) reader(message);
    else this.#read.push(message);
  }

  // What waited for the answer goes out together, as few messages as can be: of these the server
  // answers the newest.
  #answered(sequence: number): void {
    const isHeld = this.#isHeld();
    this.#unanswered = this.#unanswered.filter((one) => one > sequence);
    if (!isHeld || this.#isHeld()) return;
    if (this.#waiting.length > 1) this.#shorten();
    this.#released = this.#waiting.length;
    this.#write();
  }
  #isHeld(): boolean {
    const next = this.#waiting[0];
    const needsAnswer = next !== undefined && (next.update ?? next.edit) != null;
    return needsAnswer && this.#released === 0 && this.#unanswered.length >= this.#sending.ahead;
  }

  #finish(): void {
    if (this.status) return;
    this.status = this.#final;
    this.#stop();
    const reader = this.#reader;
    this.#reader = undefined;
    reader?.(this.#read.shift());
  }

  #stop(): void {
    this.#broken = true;
    this.#waiting = [];
    this.writingSince = undefined;
    for (const resolve of this.#onDrained.splice(0)) resolve();
  }

  #write(): void {
    if (this.status || this.#broken || this.writingSince !== undefined) return;
    // Pings overtake what waits for an answer: by them a server is known to be there.
    const at = this.#isHeld() ? this.#waiting.findIndex(({ ping }) => ping) : 0;
    if (at < 0) return;
    const [request] = this.#waiting.splice(at, 1);
    this.#released = Math.max(0, this.#released - 1);
    if (!request) {
      for (const resolve of this.#onDrained.splice(0)) resolve();
      if (this.#endWanted && !this.#endSent) {
        this.#endSent = true;
        this.#stream.end();
      }
      return;
    }
    if (request.update || request.edit) this.#unanswered.push(sequenceOf(request as Message));
    this.writingSince = performance.now();
    this.#stream.write(request, (error?: Error | null) => {
      this.writingSince = undefined;
      if (error) this.#stop();
      else this.#write();
    });
  }

  // Pings in between are answered one by one, so they part what may become one.
  #shorten(): void {
    const shorter: StreamDeformRequest[] = [];
    let run: Message[] = [];
    const close = (): void => {
      const folded = fold(run, this.#sending.mayMerge);
      if (folded.length < run.length) {
        const last = run.filter((message) => !isEdit(message)).at(-1);
        if (last && !isEdit(last))
          this.#sending.onMerged(run.length - folded.length, last.update.sequence);
        run = folded;
      }
      shorter.push(...run);
      run = [];
    };
    for (const request of this.#waiting) {
      if (request.update || request.edit) {
        run.push(request as Message);
      } else {
        close();
        shorter.push(request);
      }
    }
    close();
    this.#waiting = shorter;
    this.#released = Math.min(this.#released, shorter.length);
    // What could not be merged is not looked at again with every push.
    this.#shortenAt = Math.max(mostWaiting, 2 * shorter.length);
  }
}
