// The first visit: three steps, which go on by themselves when they are done.
import { words } from "../words.js";
import { button, h } from "./dom.js";

type Steps = readonly (readonly [string, string])[];

export class Guide {
  readonly element: HTMLElement;
  readonly #steps: Steps;
  readonly #memory: string;
  readonly #count = h("p", { class: "count" });
  readonly #title = h("h2", {});
  readonly #text = h("p", {});
  readonly #next: HTMLButtonElement;
  #step = 0;

  /** The browser remembers under this name that it has been seen. */
  constructor(steps: Steps, memory: string) {
    this.#steps = steps;
    this.#memory = memory;
    this.#next = button(words.guide.next, () => this.#go(this.#step + 1), { class: "main" });
    const skip = button(words.guide.skip, () => this.close());
    this.element = h(
      "section",
      { class: "guide", "aria-label": words.guide.title, hidden: true },
      h("div", { class: "say" }, this.#count, this.#title, this.#text),
      h("div", { class: "row" }, this.#next, skip),
    );
    let seen = false;
    try {
      seen = localStorage.getItem(this.#memory) !== null;
    } catch {
      // A browser that keeps nothing shows it every time.
    }
    if (!seen) this.open();
  }

  open(): void {
    this.element.hidden = false;
    this.#go(0);
  }
  close(): void {
    this.element.hidden = true;
    try {
      localStorage.setItem(this.#memory, "seen");
    } catch {
      // Then not.
    }
  }

  #go(step: number): void {
    if (step >= this.#steps.length) return this.close();
    this.#step = step;
    const [title, text] = this.#steps[step];
    this.#count.textContent = words.guide.of(step + 1);
    this.#title.textContent = title;
    this.#text.textContent = text;
    this.#next.textContent = step === this.#steps.length - 1 ? words.guide.done : words.guide.next;
  }

  /** The visitor has done so many of the steps. */
  done(steps: number): void {
    if (!this.element.hidden && this.#step < steps && steps < this.#steps.length) this.#go(steps);
  }
}

const list = (entries: Steps): HTMLElement =>
  h("dl", {}, ...entries.flatMap(([key, what]) => [h("dt", {}, key), h("dd", {}, what)]));

/** What pointers and keys do, in a dialog of its own. */
export function keyHelp(pointers: Steps, keys: Steps): HTMLDialogElement {
  const dialog = h(
    "dialog",
    { "aria-label": words.help },
    h("h2", {}, words.guide.pointer),
    list(pointers),
    h("h2", {}, words.guide.keys),
    list(keys),
    button(words.close, () => dialog.close(), { class: "main" }),
  );
  return dialog;
}
