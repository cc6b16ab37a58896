// One socket: one stream on one handle set. It knows what it has said, and says what has changed.
import { sameHandle } from "../model/puppet.js";
import type { Motion, Pin } from "../model/puppet.js";
import { Problem, addressOf, handleOf, problemOf, shapeOptions, targetOf } from "./api.js";
import { readShape } from "./shape.js";
import type { Shape } from "./shape.js";

export interface SocketEvents {
  opened(): void;
  /** `after` is how long ago its update was sent, in ms; undefined when that is not known. */
  shape(shape: Shape, after: number | undefined): void;
  /** An update or edit that changed nothing. `edit` of the pins that it was about. */
  refused(problem: Problem): void;
  resumed(): void;
  draining(): void;
  /** The end. A problem, if it was said; passing ones are worth another try. */
  closed(problem: Problem): void;
}

const sameTarget = (a: Pin, b: Pin): boolean =>
  a.x === b.x && a.y === b.y && a.angle === b.angle && a.scale === b.scale;

/** `compiled` pins are in the handle set already. */
export class Socket {
  readonly #socket: WebSocket;
  readonly #events: SocketEvents;
  readonly #sentAt = new Map<number, number>();
  // What the other side holds by now, and before every edit that is not answered yet.
  #told = new Map<string, Pin>();
  readonly #before = new Map<number, Map<string, Pin>>();
  #sequence = 0;
  #answered = 0;
  #problem: Problem | undefined;
  #isOpen = false;
  #isClosed = false;

  constructor(
    session: string,
    handleSet: string,
    motion: Motion,
    delivery: "latest" | "every",
    events: SocketEvents,
    compiled: readonly Pin[] = [],
  ) {
    this.#events = events;
    // Where they are is not said yet.
    this.#told = new Map(compiled.map((pin) => [pin.id, { ...pin, x: NaN }]));
    const address = addressOf(`v1/sessions/${session}/stream`);
    address.protocol = address.protocol === "https:" ? "wss:" : "ws:";
    this.#socket = new WebSocket(address, "arapd.v1");
    this.#socket.binaryType = "arraybuffer";
    this.#socket.onopen = () => {
      const window = delivery === "latest" ? { window: 2 } : {};
      this.#say({ type: "open", handleSet, delivery, ...window, ...shapeOptions(motion) });
    };
    this.#socket.onmessage = ({ data }: MessageEvent<string | ArrayBuffer>) => {
      if (typeof data === "string") this.#hear(JSON.parse(data) as Heard);
      else this.#take(data);
    };
    this.#socket.onclose = ({ code }) => this.#end(code);
  }

  get isOpen(): boolean {
    return this.#isOpen && !this.#isClosed;
  }

  /** Whether all that was said is answered. */
  get isQuiet(): boolean {
    return this.isOpen && this.#answered >= this.#sequence && this.#sequence > 0;
  }

  /** For how many ms the oldest of what was said waits for an answer; 0: nothing does. */
  get waiting(): number {
    for (const at of this.#sentAt.values()) return performance.now() - at;
    return 0;
  }

  /** The pins are these, here. Says what is new of it and gives the sequence, or undefined. */
  say(pins: readonly Pin[], evenIfNothing = false): number | undefined {
    if (!this.isOpen) return undefined;
    const now = new Map(pins.map((pin) => [pin.id, pin]));
    const remove: string[] = [];
    for (const [id, told] of this.#told) {
      const pin = now.get(id);
      if (!pin || !sameHandle(pin, told)) remove.push(id);
    }
    const gone = new Set(remove);
    const add = pins.filter((pin) => gone.has(pin.id) || !this.#told.has(pin.id));
    const fresh = new Set(add.map((pin) => pin.id));
    const moved = pins.filter((pin) => {
      const told = this.#told.get(pin.id);
      return fresh.has(pin.id) || !told || !sameTarget(pin, told);
    });
    let sequence: number | undefined;
    if (remove.length > 0 || add.length > 0) {
      sequence = this.#next();
      this.#before.set(sequence, this.#told);
      this.#say({ type: "edit", sequence, remove, add: add.map(handleOf) });
    }
    if (moved.length > 0 || evenIfNothing) {
      sequence = this.#next();
      this.#say({ type: "update", sequence, targets: moved.map(targetOf) });
    }
    if (sequence !== undefined) this.#told = now;
    return sequence;
  }

  close(): void {
    this.#isClosed = true;
    this.#socket.close();
  }

  #next(): number {
    this.#sentAt.set(++this.#sequence, performance.now());
    return this.#sequence;
  }

  #say(message: unknown): void {
    if (this.#socket.readyState === WebSocket.OPEN) this.#socket.send(JSON.stringify(message));
  }

  #take(data: ArrayBuffer): void {
    if (this.#isClosed) return;
    const shape = readShape(data);
    this.#say({ type: "seen", sequence: shape.sequence });
    const sent = this.#sentAt.get(shape.sequence);
    this.#answer(shape.sequence);
    for (const sequence of this.#before.keys()) {
      if (sequence <= shape.sequence) this.#before.delete(sequence);
    }
    this.#events.shape(shape, sent === undefined ? undefined : performance.now() - sent);
  }

  // Answers come in order: what was said before is answered, or replaced.
  #answer(last: number): void {
    this.#answered = Math.max(this.#answered, last);
    for (const sequence of this.#sentAt.keys()) {
      if (sequence <= last) this.#sentAt.delete(sequence);
    }
  }

  #hear(message: Heard): void {
    if (this.#isClosed) return;
    switch (message.type) {
      case "opened":
        this.#isOpen = true;
        this.#events.opened();
        break;
      case "error": {
        const before = message.sequence === null ? undefined : this.#before.get(message.sequence);
        if (before) this.#told = before;
        this.#answer(message.sequence ?? 0);
        this.#events.refused(problemOf(message.problem));
        break;
      }
      case "problem":
        this.#problem = problemOf(message.problem);
        break;
      case "resumed":
        this.#events.resumed();
        break;
      case "draining":
        this.#events.draining();
        break;
      case "pong":
        break;
    }
  }

  #end(code: number): void {
    if (this.#isClosed) return;
    this.#isClosed = true;
    const status = code >= 4000 ? code - 4000 : 0;
    this.#events.closed(this.#problem ?? new Problem(status, "UNREACHABLE", ""));
  }
}

type Heard =
  | { type: "opened" | "resumed" | "draining" | "pong" }
  | { type: "error"; sequence: number | null; problem: object }
  | { type: "problem"; problem: object };
