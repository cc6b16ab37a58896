// What the pages of the studio share: the head with the way to the other pages, undo and redo, and what is
// said. A page is an HTML file beside index.html and a line here.
import { words } from "../words.js";
import { button, h } from "./dom.js";

/** Named as in `words.pages`. */
export type Page = "puppet" | "flatten" | "load";
const pages: readonly (readonly [Page, string])[] = [
  ["puppet", "./"],
  ["flatten", "./flatten.html"],
  ["load", "./load.html"],
];

/** The head of a page: a way past it to the element with the id `main`, its name, the other pages, tools. */
export function head(page: Page, main: string, skip: string, ...tools: HTMLElement[]): HTMLElement {
  const title = words.pages[page].title;
  document.title = title;
  const links = pages.map(([name, address]) =>
    h(
      "a",
      { href: address, "aria-current": name === page ? "page" : false },
      words.pages[name].name,
    ),
  );
  return h(
    "header",
    {},
    h("a", { class: "skip", href: `#${main}` }, skip),
    h("h1", {}, title),
    h("nav", { "aria-label": words.pageList }, ...links),
    h("div", { class: "row tools" }, ...tools),
  );
}

/** What can be taken back, as the page has it. */
export interface Steps {
  undo(): void;
  redo(): void;
  history: { readonly undoable: string | undefined; readonly redoable: string | undefined };
}

/** Buttons and keys for undo and redo. */
export function undoing(steps: Steps): { buttons: HTMLButtonElement[]; sync(): void } {
  const undo = button(words.undo, () => steps.undo());
  const redo = button(words.redo, () => steps.redo());
  document.addEventListener("keydown", (event) => {
    if (!(event.ctrlKey || event.metaKey) || event.altKey) return;
    const key = event.key.toLowerCase();
    if (key === "z" && event.shiftKey) steps.redo();
    else if (key === "z") steps.undo();
    else if (key === "y") steps.redo();
    else return;
    event.preventDefault();
  });
  return {
    buttons: [undo, redo],
    sync() {
      const { undoable, redoable } = steps.history;
      undo.disabled = undoable === undefined;
      redo.disabled = redoable === undefined;
      undo.title = undoable ? words.undoWhat(undoable) : "";
      redo.title = redoable ? words.redoWhat(redoable) : "";
    },
  };
}

/** Where sentences are said: politely, or so that nobody misses them. */
export function speaker(): { elements: HTMLElement[]; say(text: string, urgent: boolean): void } {
  const polite = h("p", { class: "unseen", role: "status" });
  const toast = h("div", { class: "toast", role: "alert" });
  let hide: ReturnType<typeof setTimeout>;
  return {
    elements: [polite, toast],
    say(text, urgent) {
      if (!urgent) {
        polite.textContent = text;
        return;
      }
      clearTimeout(hide);
      toast.replaceChildren(
        h("p", {}, text),
        button("×", () => toast.replaceChildren(), { "aria-label": words.close }),
      );
      hide = setTimeout(() => toast.replaceChildren(), 12_000);
    },
  };
}

/** A file dropped anywhere on the page is opened. */
export function onDrop(open: (file: File) => void): void {
  for (const kind of ["dragover", "drop"] as const) {
    document.addEventListener(kind, (event) => {
      event.preventDefault();
      const file = kind === "drop" ? event.dataTransfer?.files[0] : undefined;
      if (file) open(file);
    });
  }
}

/** Once per picture, however often it is asked for. */
export function oncePerPicture(act: () => void): () => void {
  let asked = false;
  return () => {
    if (asked) return;
    asked = true;
    requestAnimationFrame(() => {
      asked = false;
      act();
    });
  };
}
