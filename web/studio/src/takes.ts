// Recording, playing and editing the take of the document.
import type { Puppet } from "./model/puppet.js";
import { frameOf, playedFrames } from "./model/take.js";
import type { Take } from "./model/take.js";
import { bake } from "./net/bake.js";
import type { Film } from "./net/bake.js";
import { Problem } from "./net/api.js";
import type { Studio } from "./studio.js";
import { words } from "./words.js";

/** Frames in a second of a recording. */
export const recordingRate = 30;
/** Longer takes end by themselves: two minutes. */
const mostFrames = 120 * recordingRate;

export class Takes {
  readonly #studio: Studio;
  readonly #listeners = new Set<() => void>();
  // What is recorded, of the puppet as it was when it began.
  #recording: { frames: Float64Array[]; began: number; puppet: Puppet } | undefined;
  /** The shapes of the take, once they are computed. */
  film: Film | undefined;
  baking: number | undefined;
  #baker: AbortController | undefined;
  // The take whose shapes are to be computed when the server is back.
  #waits: Take | undefined;
  playing = false;
  /** Which frame of the film the stage shows; undefined: the live puppet. */
  frame: number | undefined;
  #playedFrom = 0;
  // The puppet when the stage began to show the film.
  #seen: Puppet | undefined;

  constructor(studio: Studio) {
    this.#studio = studio;
    studio.listen(() => {
      // Another puppet, or one with other pins: what is recorded ends here.
      const recorded = this.#recording?.puppet.pins;
      const { pins } = studio.puppet;
      const same =
        recorded?.length === pins.length && recorded.every((pin, i) => pin.id === pins[i].id);
      if (recorded && !same) this.stop();
      // What is changed is to be seen: on the live puppet.
      const now = studio.puppet;
      const seen = this.#seen;
      if (this.film && this.film.take !== this.take) this.leave();
      else if (
        seen &&
        (now.pins !== seen.pins || now.body !== seen.body || now.motion !== seen.motion)
      ) {
        this.leave();
      }
    });
  }

  get take(): Take | null {
    return this.#studio.puppet.take;
  }
  get recording(): boolean {
    return this.#recording !== undefined;
  }
  /** Seconds so far. */
  get recorded(): number {
    return (this.#recording?.frames.length ?? 0) / recordingRate;
  }

  listen(listener: () => void): void {
    this.#listeners.add(listener);
  }

  record(): void {
    const { puppet } = this.#studio;
    if (!puppet.body || puppet.pins.length === 0) {
      this.#studio.say(words.take.noPins, true);
      return;
    }
    this.leave();
    this.#recording = { frames: [frameOf(puppet.pins)], began: performance.now(), puppet };
    this.#changed();
  }

  stop(): void {
    const recording = this.#recording;
    if (!recording) return;
    this.#recording = undefined;
    const { body, starch, motion, pins, figure } = recording.puppet;
    const { frames } = recording;
    if (body && figure === this.#studio.puppet.figure) {
      const whole = { frames, first: 0, end: frames.length, smooth: 0, loop: 0 };
      const take: Take = { rate: recordingRate, body, starch, motion, pins, ...whole };
      this.#studio.step({ ...this.#studio.puppet, take }, words.steps.take);
      void this.bakeIt();
    }
    this.#changed();
  }

  /** A change of what of the take is played. While it is still moving it is not computed. */
  edit(change: Partial<Pick<Take, "first" | "end" | "smooth" | "loop">>, done: boolean): void {
    const { puppet } = this.#studio;
    if (!puppet.take) return;
    const take = { ...puppet.take, ...change };
    this.#studio.step({ ...puppet, take }, words.steps.edit, `take-${Object.keys(change).join()}`);
    if (done) {
      this.#studio.history.seal();
      void this.bakeIt();
    }
  }

  remove(): void {
    this.leave();
    this.#studio.step({ ...this.#studio.puppet, take: null }, words.steps.removeTake);
  }

  /** The film of the take as it is now; undefined when there is none or it cannot be had. */
  async bakeIt(): Promise<Film | undefined> {
    const { take } = this;
    if (!take) return undefined;
    if (this.film?.take === take) return this.film;
    this.#baker?.abort();
    const baker = new AbortController();
    this.#baker = baker;
    this.baking = 0;
    this.#changed();
    try {
      const film = await bake(this.#studio.session, take, baker.signal, (part) => {
        this.baking = part;
        this.#changed();
      });
      if (this.#baker !== baker) return undefined;
      // That of a take which is gone by now, and may come back, takes no other's place.
      if (this.take !== take && this.film?.take === this.take) return undefined;
      this.film = film;
      this.#waits = undefined;
      if (this.take !== take) return undefined;
      if (this.frame !== undefined) this.frame = Math.min(this.frame, film.frames.length - 1);
      return film;
    } catch (error) {
      if (error instanceof Problem && error.reason === "CANCELLED") return undefined;
      const gone = error instanceof Problem && error.status === 404;
      if (gone) this.#studio.session.forget();
      if (error instanceof Problem && (gone || error.passes)) {
        if (this.#waits !== take) this.#studio.say(words.take.later, true);
        this.#waits = take;
        // As long as nothing newer is wanted; a take that was undone may come back.
        const again = (): void => {
          if (this.#baker !== baker) return;
          if (this.take === take) void this.bakeIt();
          else setTimeout(again, 2000);
        };
        setTimeout(again, error.retryAfterMs ?? 2000);
      } else this.#studio.say(words.wentWrong((error as Error).message), true);
      return undefined;
    } finally {
      if (this.#baker === baker) {
        this.baking = undefined;
        this.#changed();
      }
    }
  }

  async play(): Promise<void> {
    const film = await this.bakeIt();
    if (!film) return;
    const from = this.frame !== undefined && this.frame + 1 < film.frames.length ? this.frame : 0;
    this.frame = from;
    this.#playedFrom = performance.now() - (1000 * from) / film.take.rate;
    this.playing = true;
    this.#seen = this.#studio.puppet;
    this.#changed();
    this.#studio.onShape();
  }

  pause(): void {
    this.playing = false;
    this.#changed();
  }

  async seek(frame: number): Promise<void> {
    const film = await this.bakeIt();
    if (!film) return;
    this.playing = false;
    this.#seen = this.#studio.puppet;
    this.frame = Math.max(0, Math.min(frame, film.frames.length - 1));
    this.#changed();
    this.#studio.onShape();
  }

  /** Back to the live puppet. */
  leave(): void {
    if (this.frame === undefined && !this.playing) return;
    this.playing = false;
    this.frame = undefined;
    this.#changed();
    this.#studio.onShape();
  }

  /** Once for every picture. True while there is something to show next. */
  tick(now: number): boolean {
    const recording = this.#recording;
    if (recording) {
      const due = Math.floor(((now - recording.began) / 1000) * recordingRate) + 1;
      if (recording.frames.length < due) {
        const frame = frameOf(this.#studio.puppet.pins);
        while (recording.frames.length < Math.min(due, mostFrames)) recording.frames.push(frame);
        this.#changed();
        if (recording.frames.length >= mostFrames) this.stop();
      }
      return true;
    }
    if (!this.playing || !this.film) return false;
    const { frames, take } = this.film;
    let frame = Math.floor(((now - this.#playedFrom) / 1000) * take.rate);
    if (frame >= frames.length) {
      if (take.loop === 0) {
        this.frame = frames.length - 1;
        this.pause();
        return false;
      }
      frame %= frames.length;
    }
    if (frame !== this.frame) {
      this.frame = Math.max(0, frame);
      this.#changed();
    }
    return true;
  }

  /** How many frames are played. */
  get count(): number {
    const { take } = this;
    return this.film?.frames.length ?? (take ? playedFrames(take).length : 0);
  }

  #changed(): void {
    for (const listener of this.#listeners) listener();
  }
}
