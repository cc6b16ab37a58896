// The first visit: three steps, which go on by themselves when they are done.
import type { Studio } from "../studio.js";
import { words } from "../words.js";
import { button, h } from "./dom.js";

const memory = "arapd-studio-guide";

export class Guide {
  readonly element: HTMLElement;
  readonly #studio: Studio;
  readonly #count = h("p", { class: "count" });
  readonly #title = h("h2", {});
  readonly #text = h("p", {});
  readonly #next: HTMLButtonElement;
  #step = 0;
  #figure: number | undefined;

  constructor(studio: Studio) {
    this.#studio = studio;
    this.#next = button(words.guide.next, () => this.#go(this.#step + 1), { class: "main" });
    const skip = button(words.guide.skip, () => this.close());
    this.element = h(
      "section",
      { class: "guide", "aria-label": words.guide.title, hidden: true },
      h("div", { class: "say" }, this.#count, this.#title, this.#text),
      h("div", { class: "row" }, this.#next, skip),
    );
    studio.listen(() => this.#watch());
    let seen = false;
    try {
      seen = localStorage.getItem(memory) !== null;
    } catch {
      // A browser that keeps nothing shows it every time.
    }
    if (!seen) this.open();
  }

  open(): void {
    this.#figure = undefined;
    this.element.hidden = false;
    this.#go(0);
  }
  close(): void {
    this.element.hidden = true;
    try {
      localStorage.setItem(memory, "seen");
    } catch {
      // Then not.
    }
  }

  #go(step: number): void {
    if (step >= words.guide.steps.length) return this.close();
    this.#step = step;
    const [title, text] = words.guide.steps[step];
    this.#count.textContent = words.guide.of(step + 1);
    this.#title.textContent = title;
    this.#text.textContent = text;
    this.#next.textContent = step === 2 ? words.guide.done : words.guide.next;
  }

  #watch(): void {
    if (this.element.hidden || !this.#studio.puppet.body) return;
    const { figure, pins } = this.#studio.puppet;
    this.#figure ??= figure;
    if (this.#step === 0 && (figure !== this.#figure || pins.length > 0)) this.#go(1);
    else if (this.#step === 1 && pins.length >= 3) this.#go(2);
  }
}

const list = (entries: readonly (readonly [string, string])[]): HTMLElement =>
  h("dl", {}, ...entries.flatMap(([key, what]) => [h("dt", {}, key), h("dd", {}, what)]));

/** What pointers and keys do, in a dialog of its own. */
export function keyHelp(): HTMLDialogElement {
  const dialog = h(
    "dialog",
    { "aria-label": words.help },
    h("h2", {}, words.guide.pointer),
    list(words.guide.pointerList),
    h("h2", {}, words.guide.keys),
    list(words.guide.keyList),
    button(words.close, () => dialog.close(), { class: "main" }),
  );
  return dialog;
}
