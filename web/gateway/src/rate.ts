// Rate: how often something may be done, as a bucket that fills steadily.

/** `perSecond` on average, and `burst` at once. */
export class Rate {
  #left: number;
  #at = performance.now();

  constructor(
    readonly perSecond: number,
    readonly burst: number,
  ) {
    this.#left = burst;
  }

  #fill(): void {
    const now = performance.now();
    this.#left = Math.min(this.burst, this.#left + ((now - this.#at) / 1000) * this.perSecond);
    this.#at = now;
  }

  /** 0 when it may be done, and counts it; else in how many milliseconds. */
  take(): number {
    this.#fill();
    if (this.#left < 1) return ((1 - this.#left) / this.perSecond) * 1000;
    this.#left--;
    return 0;
  }

  get isFull(): boolean {
    this.#fill();
    return this.#left >= this.burst;
  }
}

const mostKeys = 50_000;

/** A bucket for each key. Those that are full again are forgotten, so memory is bounded. */
export class Rates {
  readonly #rates = new Map<string, Rate>();

  constructor(
    readonly perSecond: number,
    readonly burst: number,
  ) {}

  take(key: string): number {
    let rate = this.#rates.get(key);
    if (!rate) {
      if (this.#rates.size >= mostKeys) this.#forget();
      rate = new Rate(this.perSecond, this.burst);
      this.#rates.set(key, rate);
    }
    return rate.take();
  }

  #forget(): void {
    for (const [key, rate] of this.#rates) if (rate.isFull) this.#rates.delete(key);
    // All are busy: the oldest begin again with a full bucket.
    for (const key of this.#rates.keys()) {
      if (this.#rates.size < mostKeys) return;
      this.#rates.delete(key);
    }
  }
}

/** How many of something each key has at once. */
export class Counts {
  readonly #counts = new Map<string, number>();
  total = 0;

  of(key: string): number {
    return this.#counts.get(key) ?? 0;
  }
  add(key: string): void {
    this.#counts.set(key, this.of(key) + 1);
    this.total++;
  }
  remove(key: string): void {
    const left = this.of(key) - 1;
    if (left > 0) this.#counts.set(key, left);
    else this.#counts.delete(key);
    this.total--;
  }
}
