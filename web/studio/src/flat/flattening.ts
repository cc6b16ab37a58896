// Layouts that follow a document: the newest is worked on, what it takes the place of is cancelled.
import { Problem } from "../net/api.js";
import { words } from "../words.js";
import { layoutOf } from "./layout.js";
import type { Layout } from "./layout.js";
import { flattened } from "./net.js";
import type { Answer, Progress } from "./net.js";
import { requestOf, sameLayout } from "./pattern.js";
import type { Method, Pattern } from "./pattern.js";
import { rangeOf } from "./strain.js";
import { edgesOf } from "./surface.js";
import type { Edges, Surface } from "./surface.js";

export type State = "empty" | "reading" | "waiting" | "working" | "done" | "failed" | "cancelled";

const restMs = 200; // Changes that follow each other are one.

export const sentenceOf = (error: unknown): string =>
  error instanceof Problem && error.status === 0
    ? words.state.unreachable
    : words.wentWrong((error as Error).message);

export class Flattening {
  state: State = "empty";
  progress: Progress | null = null;
  problem: Problem | null = null;
  /** Of the method, then of the other; of an earlier document while a newer one is worked on. */
  layouts: readonly Layout[] = [];
  /** The end of the colours, in percent. */
  range = 1;
  readonly #edges = new WeakMap<Surface, Map<boolean, Edges>>();
  readonly #keys = new WeakMap<Surface, string>();
  readonly #changed: () => void;
  #wanted: Pattern | null = null;
  #stop = new AbortController();
  #timer: ReturnType<typeof setTimeout> | undefined;

  constructor(changed: () => void) {
    this.#changed = changed;
  }

  isOf(pattern: Pattern): boolean {
    return this.state === "done" && this.#wanted !== null && sameLayout(this.#wanted, pattern);
  }

  /** The layouts are made anew when the document asks for others. */
  follow(pattern: Pattern): void {
    const wanted = this.#wanted;
    if (pattern.surface && !(wanted && sameLayout(wanted, pattern))) {
      if (wanted?.surface !== pattern.surface || wanted.mend !== pattern.mend) this.layouts = [];
      this.halt("waiting");
      this.#wanted = pattern;
      this.#timer = setTimeout(() => void this.#run(pattern), restMs);
    }
    this.#changed();
  }

  /** Tries again, after it was cancelled or has failed. */
  again(pattern: Pattern): void {
    this.#wanted = null;
    this.follow(pattern);
  }

  /** Ends what is under way. The answer ends with what comes next. */
  halt(state: State): AbortSignal {
    clearTimeout(this.#timer);
    this.#stop.abort();
    this.#stop = new AbortController();
    this.progress = null;
    this.problem = null;
    this.state = state;
    this.#changed();
    return this.#stop.signal;
  }

  async #run(pattern: Pattern): Promise<void> {
    const { signal } = this.#stop;
    const surface = pattern.surface!;
    const edges = this.edgesOf(surface, pattern.mend);
    const wanted = [pattern.method, ...(pattern.other ? [pattern.other] : [])];
    this.state = "working";
    this.#changed();
    const tell = (progress: Progress): void => {
      this.progress = progress;
      this.#changed();
    };
    try {
      const layouts: Layout[] = [];
      for (const method of wanted) {
        const answer = await this.ask(pattern, method, {}, "application/json", tell, signal);
        layouts.push(layoutOf((await answer.json()) as Answer, method, surface, edges));
      }
      if (signal.aborted) return;
      this.layouts = layouts;
      this.range = rangeOf(layouts.map(({ strain }) => strain));
      this.state = "done";
    } catch (error) {
      if (signal.aborted) return;
      this.state = "failed";
      const known = error instanceof Problem;
      this.problem = known ? error : new Problem(-1, "UNKNOWN", (error as Error).message);
      if (this.problem.passes) {
        const wait = this.problem.retryAfterMs ?? 3000;
        this.#timer = setTimeout(() => this.again(pattern), wait);
      }
    }
    this.progress = null;
    this.#changed();
  }

  /** The answer for a document and a method, with more than the layout where that is asked. */
  ask(
    pattern: Pattern,
    method: Method,
    more: Record<string, unknown>,
    accept: string,
    tell: (progress: Progress) => void,
    signal: AbortSignal,
  ): Promise<Response> {
    const surface = pattern.surface!;
    let key = this.#keys.get(surface);
    if (!key) {
      key = `studio-${crypto.getRandomValues(new Uint32Array(4)).join("-")}`;
      this.#keys.set(surface, key);
    }
    const request = requestOf(pattern, this.edgesOf(surface, pattern.mend), method, key);
    return flattened(surface, { ...request, ...more }, accept, tell, signal);
  }

  edgesOf(surface: Surface, join: boolean): Edges {
    let known = this.#edges.get(surface);
    if (!known) this.#edges.set(surface, (known = new Map<boolean, Edges>()));
    let edges = known.get(join);
    if (!edges) known.set(join, (edges = edgesOf(surface, join)));
    return edges;
  }
}
