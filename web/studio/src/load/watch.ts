// The load as it was in the last minutes, asked for every second.
import { Problem, addressOf, problemOf } from "../net/api.js";
import type { Load } from "./answer.js";
import { Pair, charts } from "./measures.js";

export const everyMs = 1000;
const keptMs = 10 * 60_000;
// Of how long quantiles are: of a second they would jump.
const quantileMs = 5000;

/** How it was at a moment. NaN: nothing can be said. */
export interface Moment {
  /** On the clock of this page, in ms. */
  at: number;
  /** By chart, then line. */
  values: number[][];
}

export type State =
  | { kind: "starting" }
  | { kind: "live" }
  | { kind: "paused" }
  /** The gateway shows nobody, or not this visitor. */
  | { kind: "hidden"; problem: Problem }
  /** Nobody answers, or something is wrong. */
  | { kind: "lost"; problem: Problem };

async function ask(): Promise<Load> {
  let response: Response;
  try {
    response = await fetch(addressOf("v1/load"), { signal: AbortSignal.timeout(10_000) });
  } catch {
    throw new Problem(0, "UNREACHABLE", "");
  }
  if (!response.ok) {
    throw problemOf(await response.json().catch(() => ({})), response.status);
  }
  return (await response.json()) as Load;
}

export class Watch {
  state: State = { kind: "starting" };
  moments: Moment[] = [];
  /** The newest answer, and the one that was first. */
  load: Load | undefined;
  first: Load | undefined;
  #recent: Load[] = [];
  #timer: ReturnType<typeof setTimeout> | undefined;
  #runs = false;
  /** What was asked in a round before is of no interest. */
  #round = 0;

  /** `changed` hears of every answer, and of every one that does not come. */
  constructor(readonly changed: () => void) {
    document.addEventListener("visibilitychange", () => this.#go());
  }

  /** The page is looked at, or not. */
  run(runs: boolean): void {
    this.#runs = runs;
    this.#go();
  }

  pause(pauses: boolean): void {
    this.state = { kind: pauses ? "paused" : "starting" };
    this.changed();
    this.#go();
  }

  #go(): void {
    const round = ++this.#round;
    clearTimeout(this.#timer);
    if (this.#runs && !document.hidden && this.state.kind !== "paused") void this.#ask(round);
  }

  async #ask(round: number): Promise<void> {
    const began = performance.now();
    let state: State;
    try {
      const load = await ask();
      if (round !== this.#round) return;
      this.#add(load);
      state = { kind: "live" };
    } catch (error) {
      if (round !== this.#round) return;
      const problem = error instanceof Problem ? error : new Problem(500, "UNKNOWN", String(error));
      state = { kind: problem.status === 404 ? "hidden" : "lost", problem };
    }
    this.state = state;
    this.changed();
    // What is hidden will hardly be shown soon.
    const pause = state.kind === "hidden" ? 10 * everyMs : everyMs;
    const wait = Math.max(50, pause - (performance.now() - began));
    this.#timer = setTimeout(() => void this.#ask(round), wait);
  }

  #add(load: Load): void {
    const last = this.#recent.at(-1);
    // Asked so soon again the gateway says the same.
    if (last && load.at <= last.at && load.gateway.startedAt === last.gateway.startedAt) return;
    const now = performance.now();
    const long = this.#recent.find(({ at }) => at >= load.at - quantileMs - everyMs / 2) ?? last;
    const [short, wide] = [new Pair(last, load), new Pair(long, load)];
    const values = charts.map(({ unit, lines }) =>
      lines.map(({ value }) => value(unit === "ms" ? wide : short) ?? NaN),
    );
    this.moments = [...this.moments.filter(({ at }) => at > now - keptMs), { at: now, values }];
    this.#recent = [...this.#recent.filter(({ at }) => at > load.at - 2 * quantileMs), load];
    this.load = load;
    if (this.first?.gateway.startedAt !== load.gateway.startedAt) this.first = load;
  }
}
