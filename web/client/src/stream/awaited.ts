// What a stream waits for. AwaitedAnswers: which updates and edits have no answer yet, by which an
// answer is known for one that was asked for. SignsOfLife: when to ask the server for one, whose
// its answers are, when it was silent for too long.
import { badAnswer } from "../errors.js";
import { isEdit, sequenceOf } from "./messages.js";
import type { Message } from "./messages.js";

// So many are known one by one; older ones of a "latest" stream as a range.
const mostApart = 4096;

interface Awaited {
  first: number;
  last: number; // the same for a single one
  asked: Asked;
  since: number;
}

/** What was asked of an answer. */
export interface Asked {
  /** How many picks, when that is known. */
  picks: number | undefined;
  /** For an edit, or an update that asks for it; or it comes in the place of such a one. */
  measured: boolean;
}

/**
 * Answers come in the order of what they answer; with `every` nothing is left out, else newer ones
 * replace older ones.
 */
export class AwaitedAnswers {
  readonly #every: boolean;
  #awaited: Awaited[] = [];

  constructor(every: boolean) {
    this.#every = every;
  }

  sent(message: Message, now: number): void {
    const sequence = sequenceOf(message);
    const picks = isEdit(message) ? 0 : message.update.pickPoints.length / 16;
    const measured = isEdit(message) || message.update.measure;
    this.#awaited.push({
      first: sequence,
      last: sequence,
      asked: { picks, measured },
      since: now,
    });
    if (!this.#every && this.#awaited.length > mostApart) this.#shorten();
  }
  /** A new call begins, on which these are said first. */
  restart(messages: readonly Message[], now: number): void {
    this.#awaited = [];
    for (const message of messages) this.sent(message, now);
  }

  /** The answer to this sequence came: what was asked of it. INTERNAL when none is due. */
  take(sequence: number): Asked {
    const candidates = this.#every ? this.#awaited.slice(0, 1) : this.#awaited;
    const at = candidates.findIndex(({ first, last }) => first <= sequence && sequence <= last);
    if (at < 0)
      throw badAnswer(`The server answered the sequence ${sequence}, for which it was not asked.`);
    const { first, last, asked } = this.#awaited[at]!;
    const measured = this.#awaited.slice(0, at + 1).some((one) => one.asked.measured);
    // More of a range may be answered yet.
    this.#awaited.splice(0, first === last ? at + 1 : at);
    return { picks: asked.picks, measured };
  }

  /** Since when the oldest waits. */
  get oldest(): number | undefined {
    return this.#awaited[0]?.since;
  }

  // The older half becomes a range.
  #shorten(): void {
    const older = this.#awaited.splice(0, this.#awaited.length / 2);
    const first = Math.min(...older.map((one) => one.first));
    const last = Math.max(...older.map((one) => one.last));
    const asked = { picks: undefined, measured: false };
    this.#awaited.unshift({ first, last, asked, since: older[0]!.since });
  }
}

/**
 * Of the user's pings and the stream's own, which have no nonce. The server answers each, in order.
 */
export class SignsOfLife {
  readonly #heartbeat: number;
  readonly #silence: number;
  #asked: (number | undefined)[] = []; // without answer
  #waiting = false; // somebody reads
  #heard = 0; // while waiting, since when nothing was heard
  #lastAsked = 0; // or when the call was begun

  constructor(heartbeat: number, silence: number) {
    this.#heartbeat = heartbeat;
    this.#silence = silence;
  }

  /** A new call begins. Our own questions were lost with the call before. */
  restart(now: number): void {
    this.#asked = this.unanswered();
    this.#lastAsked = now;
  }
  /** Somebody begins to wait for a message, or has got one, or knows that there is none. */
  setWaiting(waiting: boolean, now: number): void {
    this.#waiting = waiting;
    this.#heard = now;
  }

  /**
   * A question goes out. While the call is not open yet, only our own do; the user's are kept and
   * come behind them.
   */
  ask(nonce: number | undefined, open: boolean, now: number): void {
    if (nonce !== undefined || open) this.#asked.push(nonce);
    else this.#asked.unshift(nonce);
    this.#lastAsked = now;
  }
  /** Whether an answer with this nonce is due. Our own questions have the nonce 0. */
  isDueAnswer(nonce: number): boolean {
    return this.#asked.length > 0 && (this.#asked[0] ?? 0) === nonce;
  }
  /** An answer came: the nonce of the user's question, undefined for one of our own. */
  answered(): number | undefined {
    return this.#asked.shift();
  }
  /** The user's questions without answer, in order. */
  unanswered(): number[] {
    return this.#asked.filter((nonce) => nonce !== undefined);
  }

  /** Whether the server counts as gone. */
  isSilent(now: number): boolean {
    return this.#waiting && now - this.#heard >= this.#silence;
  }
  /** Whether to ask. `clear`: the transport takes more. */
  isDue(clear: boolean, now: number): boolean {
    // While nobody reads, answers are not seen: we go on asking as long as the server takes it.
    if (this.#asked.includes(undefined) && (this.#waiting || !clear)) return false;
    return now - (this.#waiting ? this.#heard : this.#lastAsked) >= this.#heartbeat;
  }
}
