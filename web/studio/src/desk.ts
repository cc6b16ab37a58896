// What every page with a document has: its history, who listens, and what is said.
import { History } from "./model/history.js";
import { words } from "./words.js";

export abstract class Desk<T> {
  readonly history: History<T>;
  readonly #listeners = new Set<() => void>();
  readonly #speakers = new Set<(text: string, urgent: boolean) => void>();

  constructor(document: T) {
    this.history = new History(document);
  }

  /** Hears of every change. */
  listen(listener: () => void): void {
    this.#listeners.add(listener);
  }
  onSay(speaker: (text: string, urgent: boolean) => void): void {
    this.#speakers.add(speaker);
  }
  say(text: string, urgent = false): void {
    for (const speaker of this.#speakers) speaker(text, urgent);
  }

  undo(): void {
    this.#jump(this.history.undo(), words.said.undone);
  }
  redo(): void {
    this.#jump(this.history.redo(), words.said.redone);
  }
  #jump(what: string | undefined, sentence: (what: string) => string): void {
    if (what === undefined) return;
    this.say(sentence(what));
    this.jumped();
  }

  /** The document is that of another step now. */
  protected abstract jumped(): void;
  protected changed(): void {
    for (const listener of this.#listeners) listener();
  }
}
