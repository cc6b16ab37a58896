// ReplayLog: what has to be said again on a new stream, so that it goes on where a lost one ended.
import { Pose, fold, isEdit, sequenceOf } from "./messages.js";
import type { Message } from "./messages.js";

// From so many on, updates of a "latest" stream that newer ones replace anyway become few.
const mostPending = 256;

/**
 * A stream's state on the server is its targets and what its edits have made of the handle set; a
 * handle that is added starts where the shape of that moment has it. So the edits that were
 * answered are kept, with the last targets before each; the targets after them, merged; and what
 * was not answered, as it was sent.
 */
export class ReplayLog {
  readonly #latest: boolean;
  readonly #edits: { before: Pose; edit: Message }[] = [];
  #pose = new Pose(); // since the last edit
  #pending: Message[] = [];
  #answered = -1; // the last sequence

  constructor(latest: boolean) {
    this.#latest = latest;
  }

  /** An update or an edit goes out; sequences grow. */
  sent(message: Message): void {
    this.#pending.push(message);
    if (this.#latest && this.#pending.length > mostPending) this.#pending = fold(this.#pending);
  }

  /**
   * The answer to `sequence` came: a shape, or an error, which means that nothing was changed.
   * False: it had come before.
   */
  answered(sequence: number, good: boolean): boolean {
    if (sequence <= this.#answered) return false;
    this.#answered = sequence;
    let count = 0;
    for (; count < this.#pending.length && sequenceOf(this.#pending[count]!) <= sequence; count++) {
      const message = this.#pending[count]!;
      if (good || sequenceOf(message) < sequence) this.#keep(message);
    }
    this.#pending.splice(0, count);
    return true;
  }

  /** How many have no answer. */
  get pending(): number {
    return this.#pending.length;
  }

  /** What to send behind the opening of a new stream, in this order; sequences grow. */
  messages(): Message[] {
    const messages: Message[] = [];
    for (const { before, edit } of this.#edits) {
      before.say(messages);
      messages.push(edit);
    }
    this.#pose.say(messages);
    return [...messages, ...this.#pending];
  }

  #keep(message: Message): void {
    if (!isEdit(message)) return this.#pose.add(message.update);
    this.#edits.push({ before: this.#pose, edit: message });
    this.#pose = new Pose();
  }
}
