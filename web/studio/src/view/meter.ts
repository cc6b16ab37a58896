// What is measured of the last moments.

/** Numbers of the last two seconds. */
export class Recent {
  #values: { at: number; value: number }[] = [];

  add(value: number, now = performance.now()): void {
    this.#values.push({ at: now, value });
    this.#forget(now);
  }
  /** The middle one; undefined when there are none. */
  median(now = performance.now()): number | undefined {
    return this.part(0.5, now);
  }
  /** The one that this part of them is below. */
  part(part: number, now = performance.now()): number | undefined {
    this.#forget(now);
    const values = this.#values.map(({ value }) => value).sort((a, b) => a - b);
    return values.length > 0
      ? values[Math.min(values.length - 1, Math.floor(part * values.length))]
      : undefined;
  }
  /** How many in a second. */
  rate(now = performance.now()): number {
    this.#forget(now);
    return this.#values.length / 2;
  }
  #forget(now: number): void {
    while (this.#values.length > 0 && this.#values[0].at < now - 2000) this.#values.shift();
  }
}

export class Meter {
  /** ms in the server: waiting and computing. */
  readonly server = new Recent();
  /** ms on the way there and back, and in the gateway. */
  readonly network = new Recent();
  /** ms to draw a picture. */
  readonly frame = new Recent();
  /** ms from moving a pointer to the picture that shows it. */
  readonly lag = new Recent();
  readonly shapes = new Recent();
}
