// Outbox: what goes out on a socket. Of shapes the newest waits, and before it the newest that was
// measured, if that is an older one: a page would else wait in vain for the measures that it has
// asked for. Texts go at once.
import type { WebSocket } from "ws";

import type { Shape } from "@arapd/client";

import { toJson } from "../json.js";
import { frameOf } from "./frame.js";

/** Texts that a socket does not take: who asks without reading is cut off. */
const mostTextBytes = 1 << 20;

export interface OutboxEvents {
  sent(): void;
  skipped(): void;
}

interface Waiting {
  shape: Shape;
  /** Shapes in whose place it is, and the updates that they and it had replaced. */
  skipped: number;
  replaced: number;
}

export class Outbox {
  readonly #socket: WebSocket;
  readonly #events: OutboxEvents;
  /** How many shapes may be on their way without being seen; 0: as many as the network takes. */
  #window = 0;
  #keepsAll = false;
  #writing = false; // the network has not taken the last shape
  #unseen: number[] = []; // sequences
  #waiting: Waiting[] = [];
  #textBytes = 0;
  #idle: (() => void)[] = [];

  constructor(socket: WebSocket, events: OutboxEvents) {
    this.#socket = socket;
    this.#events = events;
  }

  /** Before the first shape. `keepsAll`: none is skipped, so wait for `room` between them. */
  begin(window: number, keepsAll: boolean): void {
    this.#window = window;
    this.#keepsAll = keepsAll;
  }

  say(message: object): void {
    if (this.#socket.readyState !== this.#socket.OPEN) return;
    const text = toJson(message);
    const bytes = Buffer.byteLength(text);
    this.#textBytes += bytes;
    if (this.#textBytes > mostTextBytes + bytes) {
      this.#socket.terminate();
      return;
    }
    this.#socket.send(text, () => (this.#textBytes -= bytes));
  }

  /** A shape takes the place of those that wait, but of a measured one only if it is measured too. */
  offer(shape: Shape): void {
    const offered = { shape, skipped: 0, replaced: shape.replaced };
    let last = this.#waiting.at(-1);
    while (last && this.#yields(last.shape, shape)) {
      offered.skipped += last.skipped + 1;
      offered.replaced += last.replaced;
      this.#events.skipped();
      this.#waiting.pop();
      last = this.#waiting.at(-1);
    }
    this.#waiting.push(offered);
    this.#flush();
  }

  #yields(older: Shape, newer: Shape): boolean {
    return !this.#keepsAll && (newer.measured || !older.measured);
  }

  /** The page has all shapes up to this one. */
  seen(sequence: number): void {
    this.#unseen = this.#unseen.filter((one) => one > sequence);
    this.#flush();
  }

  /** Waits until no shape waits, or the socket is gone. */
  async room(): Promise<void> {
    while (this.#waiting.length > 0 && this.#socket.readyState === this.#socket.OPEN) {
      await new Promise<void>((resolve) => this.#idle.push(resolve));
    }
  }

  /** What waits goes out without being asked for: nothing more comes. */
  finish(): void {
    this.#window = 0;
    this.#flush();
  }

  /** The socket is gone. */
  drop(): void {
    this.#waiting = [];
    this.#wake();
  }

  #wake(): void {
    for (const resolve of this.#idle.splice(0)) resolve();
  }

  #flush(): void {
    const full = this.#window > 0 && this.#unseen.length >= this.#window;
    if (this.#writing || full || this.#socket.readyState !== this.#socket.OPEN) return;
    const next = this.#waiting.shift();
    if (!next) return;
    const frame = frameOf(next.shape, next.skipped, next.replaced);
    if (this.#window > 0) this.#unseen.push(next.shape.sequence);
    this.#writing = true;
    this.#events.sent();
    this.#socket.send(frame, () => {
      this.#writing = false;
      this.#flush();
      if (this.#waiting.length === 0) this.#wake();
    });
  }
}
