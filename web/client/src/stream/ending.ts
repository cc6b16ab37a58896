// How a call of a stream has ended, and the trouble that a lost one begins.
import { setTimeout as sleep } from "node:timers/promises";

import { Backoff } from "../calls.js";
import { ArapError, badAnswer, cancelled, errorOfCall, isLost, overdue } from "../errors.js";
import type { CallStatus } from "../errors.js";

/**
 * Without an error it ended well. Lost: it may do better elsewhere. Thrown while a call is opened.
 */
export class Ending {
  constructor(
    readonly error: ArapError | undefined,
    readonly lost: boolean,
  ) {}
}

export const errorFrom = (thrown: unknown): ArapError =>
  thrown instanceof ArapError
    ? thrown
    : badAnswer(`The answer of the server cannot be taken: ${String(thrown)}.`);
export const streamCancelled = (): ArapError => cancelled("The stream was cancelled.");

/** What a stream knows of a call that is over. */
export interface Circumstances {
  cancelled: boolean;
  /** The call was given up after so many milliseconds without a word. */
  silence: number | undefined;
  /** Why it was given up for good. */
  overdue: ArapError | undefined;
  /** Something was said that has no answer. */
  awaiting: boolean;
}

export function endingOf(status: CallStatus, at: Circumstances): Ending {
  const lost = !at.overdue && (at.silence !== undefined || isLost(status));
  if (at.cancelled && (lost || at.overdue)) return new Ending(streamCancelled(), false);
  if (at.overdue) return new Ending(at.overdue, false);
  if (at.silence !== undefined) {
    const message = `Nothing was heard from the server for ${at.silence / 1000} s.`;
    return new Ending(new ArapError({ reason: "DRAINING", code: "UNAVAILABLE", message }), true);
  }
  if (status.code !== 0) return new Ending(errorOfCall(status), lost);
  if (!at.awaiting) return new Ending(undefined, false);
  return new Ending(
    badAnswer("The server ended the stream early: what was sent on it has no answer."),
    false,
  );
}

/** What is waited for, and since when. */
export interface Waiting {
  /** A message to be taken. */
  writingSince: number | undefined;
  /** An opening or an event. */
  waitingSince: number | undefined;
  open: boolean;
  /** The oldest update or edit that has no answer. */
  oldest: number | undefined;
  sendingClosed: boolean;
}

/** Why a call is given up for good after `answer` milliseconds; nothing before. */
export function overdueOf(time: number, answer: number, at: Waiting): ArapError | undefined {
  const late = (what: string): ArapError =>
    overdue(`The server has not ${what} for ${answer / 1000} s.`);
  const isLong = (since: number): boolean => time - since >= answer;
  if (at.writingSince !== undefined && isLong(at.writingSince)) return late("taken a message");
  if (at.waitingSince === undefined || !isLong(at.waitingSince)) return undefined;
  if (!at.open) return late("opened the stream");
  if (at.oldest === undefined) return at.sendingClosed ? late("ended the stream") : undefined;
  return isLong(at.oldest) ? late("answered an update or edit") : undefined;
}

/** From a loss until the server has answered what was said again. */
export class Trouble {
  readonly #until: number;
  readonly #backoff = new Backoff();
  #opened: number | undefined; // again, the last time
  #lastSaid = 0; // the sequence

  /** For so many milliseconds from now on. */
  constructor(within: number) {
    this.#until = performance.now() + within;
  }

  /** Opened again, with messages up to this sequence. */
  opened(lastSaid: number): void {
    this.#opened = performance.now();
    this.#lastSaid = lastSaid;
  }
  /**
   * Whether it was opened a short while ago: who is lost again comes back neither at once nor for
   * ever.
   */
  isRecent(within: number): boolean {
    return this.#opened !== undefined && performance.now() - this.#opened < within;
  }
  /** Whether the server has caught up when it has answered this sequence. */
  isOver(sequence: number): boolean {
    return sequence >= this.#lastSaid;
  }

  /**
   * Waits before the next attempt, to `deadline` of Date.now() at most; throws `last` when it is
   * time to give up.
   */
  async pause(last: ArapError, deadline: number, signal: AbortSignal): Promise<void> {
    const pause = this.#backoff.next();
    if (performance.now() + pause >= this.#until) throw last;
    const wait = Math.max(0, Math.min(pause, deadline - Date.now()));
    await sleep(wait, undefined, { signal }).catch(() => {});
    if (signal.aborted) throw streamCancelled();
  }
}
