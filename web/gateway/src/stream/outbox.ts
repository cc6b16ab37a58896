// Outbox: what goes out on a socket. Of shapes at most one waits, the newest; texts go at once.
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

export class Outbox {
  readonly #socket: WebSocket;
  readonly #events: OutboxEvents;
  /** How many shapes may be on their way without being seen; 0: as many as the network takes. */
  #window = 0;
  #keepsAll = false;
  #writing = false; // the network has not taken the last shape
  #unseen: number[] = []; // sequences
  #waiting: Shape | undefined;
  // Since the last one that was sent: shapes that were not, and what those had replaced.
  #skipped = 0;
  #replaced = 0;
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

  /** A shape takes the place of the one that waits. */
  offer(shape: Shape): void {
    if (this.#waiting && !this.#keepsAll) {
      this.#skipped++;
      this.#replaced += this.#waiting.replaced;
      this.#events.skipped();
    }
    this.#waiting = shape;
    this.#flush();
  }

  /** The page has all shapes up to this one. */
  seen(sequence: number): void {
    this.#unseen = this.#unseen.filter((one) => one > sequence);
    this.#flush();
  }

  /** Waits until no shape waits, or the socket is gone. */
  async room(): Promise<void> {
    while (this.#waiting && this.#socket.readyState === this.#socket.OPEN) {
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
    this.#waiting = undefined;
    this.#wake();
  }

  #wake(): void {
    for (const resolve of this.#idle.splice(0)) resolve();
  }

  #flush(): void {
    const shape = this.#waiting;
    const full = this.#window > 0 && this.#unseen.length >= this.#window;
    if (!shape || this.#writing || full || this.#socket.readyState !== this.#socket.OPEN) return;
    this.#waiting = undefined;
    const frame = frameOf(shape, this.#skipped, shape.replaced + this.#replaced);
    this.#skipped = 0;
    this.#replaced = 0;
    if (this.#window > 0) this.#unseen.push(shape.sequence);
    this.#writing = true;
    this.#events.sent();
    this.#socket.send(frame, () => {
      this.#writing = false;
      this.#flush();
      if (!this.#waiting) this.#wake();
    });
  }
}
