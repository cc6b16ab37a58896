// The live stream behind the page: wants something, and gets there whatever the network does.
import type { Motion, Pin } from "../model/puppet.js";
import { Problem } from "./api.js";
import type { Session, Stuff } from "./session.js";
import type { Shape } from "./shape.js";
import { Socket } from "./socket.js";

export interface Rig extends Stuff {
  pins: readonly Pin[];
}

export type Connection = "idle" | "connecting" | "live" | "lost";

export interface LiveEvents {
  connection(state: Connection, problem?: Problem): void;
  /** A shape of the body that is wanted now. */
  shape(shape: Shape, after: number | undefined): void;
  /** Triangles back to front; empty: as they are numbered. */
  order(order: readonly number[]): void;
  /** What was wanted last is refused. */
  refused(problem: Problem): void;
}

const streamOf = (a: Motion, b: Motion): boolean => a.mode === b.mode && a.refine === b.refine;

export class Live {
  readonly #session: Session;
  readonly #events: LiveEvents;
  #wanted: Rig | undefined;
  #made: { rig: Rig; mesh: string; set: string; socket: Socket } | undefined;
  #busy = false;
  #pause = 250;
  #timer: ReturnType<typeof setTimeout> | undefined;
  #ordered: readonly Pin[] | undefined;
  #ordering = false;

  constructor(session: Session, events: LiveEvents) {
    this.#session = session;
    this.#events = events;
  }

  /** Says what is to be. Gives the sequence of the update when it is on its way at once. */
  want(rig: Rig): number | undefined {
    this.#wanted = rig;
    if (this.#fits(rig) && this.#made!.socket.isOpen) {
      const sequence = this.#made!.socket.say(rig.pins);
      void this.#orderTriangles();
      return sequence;
    }
    // While the next try is set for later, what is wanted waits for it.
    if (this.#timer === undefined) void this.#converge();
    return undefined;
  }

  /** For how many ms the server owes an answer. */
  get waiting(): number {
    return this.#made?.socket.waiting ?? 0;
  }

  /** Whether the newest shape is that of what is wanted. */
  get isSettled(): boolean {
    const wanted = this.#wanted;
    return wanted !== undefined && this.#fits(wanted) && this.#made!.socket.isQuiet;
  }

  #fits(rig: Rig): boolean {
    const made = this.#made?.rig;
    return (
      made !== undefined &&
      made.body === rig.body &&
      made.starch === rig.starch &&
      made.motion.basis === rig.motion.basis &&
      made.motion.weights === rig.motion.weights &&
      streamOf(made.motion, rig.motion)
    );
  }

  async #converge(): Promise<void> {
    if (this.#busy) return;
    this.#busy = true;
    clearTimeout(this.#timer);
    this.#timer = undefined;
    try {
      while (this.#wanted && !this.#fits(this.#wanted)) await this.#open(this.#wanted);
    } catch (error) {
      this.#fail(error instanceof Problem ? error : new Problem(500, "UNKNOWN", String(error)));
    } finally {
      this.#busy = false;
    }
  }

  async #open(rig: Rig): Promise<void> {
    if (!this.#made) this.#events.connection("connecting");
    const mesh = await this.#session.mesh(rig);
    const set = await this.#session.handleSet(mesh, []);
    const session = await this.#session.id();
    if (this.#wanted !== rig && this.#wanted && !sameStream(this.#wanted, rig)) {
      void this.#session.dropHandleSet(set.id);
      return;
    }
    const old = this.#made;
    const socket = new Socket(session, set.id, rig.motion, "latest", {
      opened: () => {
        this.#pause = 250;
        this.#events.connection("live");
        const { pins } = this.#wanted ?? rig;
        socket.say(pins, true);
        this.#ordered = undefined;
        void this.#orderTriangles();
      },
      shape: (shape, after) => {
        if (this.#made?.socket === socket) this.#events.shape(shape, after);
      },
      refused: (problem) => this.#events.refused(problem),
      resumed: () => this.#events.connection("live"),
      draining: () => this.#again(socket),
      closed: (problem) => {
        if (this.#made?.socket !== socket) return;
        this.#made = undefined;
        this.#fail(problem);
      },
    });
    this.#made = { rig, mesh, set: set.id, socket };
    if (old) {
      old.socket.close();
      void this.#session.dropHandleSet(old.set);
    }
  }

  #again(socket: Socket): void {
    if (this.#made?.socket !== socket) return;
    this.#made = undefined;
    socket.close();
    void this.#converge();
  }

  #fail(problem: Problem): void {
    // A session that has expired, or a server that has forgotten it, is made anew.
    const gone = problem.status === 404;
    if (gone) this.#session.forget();
    if (!gone && !problem.passes) {
      this.#events.connection("lost", problem);
      this.#events.refused(problem);
      return;
    }
    this.#events.connection("lost", problem);
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => void this.#converge(), problem.retryAfterMs ?? this.#pause);
    this.#pause = Math.min(2 * this.#pause, 5000);
  }

  // Depths make an order in which triangles are drawn. The stream does not tell it after an edit,
  // so a handle set of its own is asked for it.
  async #orderTriangles(): Promise<void> {
    const made = this.#made;
    const pins = this.#wanted?.pins;
    if (!made || !pins || this.#ordering) return;
    const deep = (list: readonly Pin[]): Pin[] => list.filter((pin) => pin.depth !== 0);
    const before = this.#ordered;
    const now = deep(pins);
    const same =
      before !== undefined &&
      before.length === now.length &&
      before.every((pin, i) => pin.hold === now[i].hold && pin.depth === now[i].depth);
    if (same) return;
    this.#ordered = now;
    if (now.length === 0) {
      this.#events.order([]);
      return;
    }
    this.#ordering = true;
    try {
      // The pins without a depth hold the rest of the figure at 0.
      const set = await this.#session.handleSet(made.mesh, pins);
      void this.#session.dropHandleSet(set.id);
      if (this.#made === made) this.#events.order(set.drawOrder);
    } catch {
      this.#ordered = undefined;
    } finally {
      this.#ordering = false;
    }
    if (this.#ordered) void this.#orderTriangles();
  }
}

const sameStream = (a: Rig, b: Rig): boolean =>
  a.body === b.body &&
  a.starch === b.starch &&
  a.motion.basis === b.motion.basis &&
  a.motion.weights === b.motion.weights &&
  streamOf(a.motion, b.motion);
