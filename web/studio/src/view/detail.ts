// How many pixels the stage draws. Where the processor draws, a picture costs what its pixels cost: as soon as
// pictures of a drag take too long they have fewer, and all again when the hand rests.

const slowMs = 11; // for a picture, so that the page can do something else before the next
const restMs = 250;
const parts = [1, 0.7, 0.5]; // of the length of a side
const pictures = 6; // in a row, before there is another step

export class Detail {
  readonly #canvas: HTMLCanvasElement;
  readonly #again: () => void;
  #step = 0;
  #took: number[] = [];
  #timer: ReturnType<typeof setTimeout> | undefined;
  #rests = false;
  #counts = false;

  /** `again` draws once more. */
  constructor(canvas: HTMLCanvasElement, again: () => void) {
    this.#canvas = canvas;
    this.#again = again;
  }

  /** Whether the canvas has other pixels than it is to have now, in CSS pixels. `drags`: they may be fewer. */
  isOff(width: number, height: number, drags: boolean): boolean {
    const [w, h] = sizeOf(width, height, drags && !this.#rests ? parts[this.#step] : 1);
    return this.#canvas.width !== w || this.#canvas.height !== h;
  }

  /** For the picture that is drawn now, so that no empty canvas is seen between. */
  resize(width: number, height: number, drags: boolean): void {
    this.#counts = drags && !this.#rests;
    const [w, h] = sizeOf(width, height, this.#counts ? parts[this.#step] : 1);
    this.#rests = false;
    if (this.#canvas.width !== w) this.#canvas.width = w;
    if (this.#canvas.height !== h) this.#canvas.height = h;
  }

  /** So long that picture has taken. */
  took(ms: number): void {
    if (!this.#counts) return;
    this.#took.push(ms);
    if (this.#took.length === pictures) {
      const middle = this.#took.sort((a, b) => a - b)[pictures >> 1];
      this.#took = [];
      // What was too slow once is so for the rest of the visit: nobody wants it to flicker.
      if (middle > slowMs) this.#step = Math.min(this.#step + 1, parts.length - 1);
    }
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => {
      this.#rests = this.#step > 0;
      if (this.#rests) this.#again();
    }, restMs);
  }
}

const sizeOf = (width: number, height: number, part: number): number[] =>
  [width, height].map((length) =>
    Math.max(1, Math.round(length * part * Math.min(2, devicePixelRatio))),
  );
