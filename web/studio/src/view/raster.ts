// Triangles as pixels, without a graphics processor: each pixel whose middle a triangle covers, so that neighbours
// leave no gap and cover no pixel twice. Pixels are RGBA in memory, one number each, colours times alpha.

/** Pixels row by row from above, colours times alpha. At least 2 × 2. */
export interface Image {
  readonly width: number;
  readonly height: number;
  readonly pixels: Uint32Array;
}

/** What becomes of a pixel of a picture: `part` of its colour is the tint (0 to 255). Above 1: nothing else. */
export interface Tone {
  tint: readonly [number, number, number];
  part: number;
  strength: number;
}

/** Draws the pixels of a row from the first to before the end. */
type Row = (y: number, first: number, end: number) => void;

const [pairs, other] = [0x00ff00ff, 0xff00ff00];
const halves = 0x00800080;
const fine = 65536; // parts of a texel

export const packed = (red: number, green: number, blue: number, alpha = 255): number =>
  ((alpha << 24) | (blue << 16) | (green << 8) | red) >>> 0;

/** A pixel over another. */
export function over(pixel: number, below: number): number {
  const alpha = pixel >>> 24;
  const rest = 256 - alpha - (alpha >> 7);
  // Rounded, so that what is opaque stays so.
  const even = ((Math.imul(below & pairs, rest) + halves) >>> 8) & pairs;
  const odd = (Math.imul((below >>> 8) & pairs, rest) + halves) & other;
  return pixel + ((even | odd) >>> 0);
}

export class Raster {
  readonly width: number;
  readonly height: number;
  readonly pixels: Uint32Array;
  readonly bytes: Uint8ClampedArray<ArrayBuffer>;
  // The box of what is drawn.
  #left = 0;
  #top = 0;
  #right = 0;
  #bottom = 0;

  constructor(width: number, height: number) {
    [this.width, this.height] = [width, height];
    const memory = new ArrayBuffer(4 * width * height);
    this.pixels = new Uint32Array(memory);
    this.bytes = new Uint8ClampedArray(memory);
    this.clear();
  }

  /** x, y, width, height of the box that holds all that is drawn. */
  get box(): [number, number, number, number] {
    const { width, height } = this;
    const [x, y] = [Math.max(0, this.#left), Math.max(0, this.#top)];
    const [right, bottom] = [Math.min(width, this.#right), Math.min(height, this.#bottom)];
    return right > x && bottom > y ? [x, y, right - x, bottom - y] : [0, 0, 0, 0];
  }

  clear(): void {
    this.pixels.fill(0);
    this.#left = this.#top = Infinity;
    this.#right = this.#bottom = -Infinity;
  }

  protected reach(places: ArrayLike<number>, corners: ArrayLike<number>): void {
    for (let i = 0; i < corners.length; ++i) {
      const x = places[2 * corners[i]];
      const y = places[2 * corners[i] + 1];
      if (x < this.#left) this.#left = Math.floor(x);
      if (x >= this.#right) this.#right = Math.ceil(x) + 1;
      if (y < this.#top) this.#top = Math.floor(y);
      if (y >= this.#bottom) this.#bottom = Math.ceil(y) + 1;
    }
  }

  // Both ends of a row come from the upper end of an edge, whichever triangle asks: neighbours agree.
  protected scan(
    ax: number,
    ay: number,
    bx: number,
    by: number,
    cx: number,
    cy: number,
    row: Row,
  ): void {
    if (by < ay || cy < ay) {
      if (by < cy) this.scan(bx, by, cx, cy, ax, ay, row);
      else this.scan(cx, cy, ax, ay, bx, by, row);
      return;
    }
    if (cy < by) {
      let swap = bx;
      bx = cx;
      cx = swap;
      swap = by;
      by = cy;
      cy = swap;
    }
    const first = Math.max(0, Math.ceil(ay - 0.5));
    const end = Math.min(this.height, Math.ceil(cy - 0.5));
    if (!(first < end)) return;
    const long = (cx - ax) / (cy - ay);
    const upper = (bx - ax) / (by - ay);
    const lower = (cx - bx) / (cy - by);
    for (let y = first; y < end; ++y) {
      const middle = y + 0.5;
      const one = ax + (middle - ay) * long;
      const two = middle < by ? ax + (middle - ay) * upper : bx + (middle - by) * lower;
      const from = Math.max(0, Math.ceil((one < two ? one : two) - 0.5));
      const to = Math.min(this.width, Math.ceil((one < two ? two : one) - 0.5));
      if (from < to) row(y, from, to);
    }
  }

  /** Triangles, three corners each, of one opaque colour each. `places` has x and y of a corner, y down. */
  flat(corners: ArrayLike<number>, places: ArrayLike<number>, colours: ArrayLike<number>): void {
    this.reach(places, corners);
    const { pixels, width } = this;
    let colour = 0;
    const row: Row = (y, first, end) => pixels.fill(colour, y * width + first, y * width + end);
    for (let i = 0; i < corners.length; i += 3) {
      const a = 2 * corners[i];
      const b = 2 * corners[i + 1];
      const c = 2 * corners[i + 2];
      colour = colours[i / 3];
      this.scan(places[a], places[a + 1], places[b], places[b + 1], places[c], places[c + 1], row);
    }
  }

  /** Triangles of a picture: `texels` has the place of a corner on it, y down. */
  textured(
    corners: ArrayLike<number>,
    places: ArrayLike<number>,
    texels: ArrayLike<number>,
    image: Image,
    tone: Tone | null,
  ): void {
    this.reach(places, corners);
    const { pixels, width } = this;
    const { pixels: from, width: across } = image;
    const [lastX, lastY] = [image.width - 2, image.height - 2];
    const [mostU, mostV] = [fine * (lastX + 1) - 1, fine * (lastY + 1) - 1];
    // At the middle of the first pixel, and from one to the next, in fine parts.
    let [u0, v0, ux, vx, uy, vy] = [0, 0, 0, 0, 0, 0];
    const row: Row = (y, first, end) => {
      let u = (fine * (u0 + first * ux + y * uy)) | 0;
      let v = (fine * (v0 + first * vx + y * vy)) | 0;
      const du = (fine * ux) | 0;
      const dv = (fine * vx) | 0;
      const last = y * width + end;
      for (let i = y * width + first; i < last; ++i) {
        const x = u < 0 ? 0 : u > mostU ? lastX : u >> 16;
        const fx = u < 0 ? 0 : u > mostU ? 256 : (u >> 8) & 255;
        const line = v < 0 ? 0 : v > mostV ? lastY : v >> 16;
        const fy = v < 0 ? 0 : v > mostV ? 256 : (v >> 8) & 255;
        u = (u + du) | 0;
        v = (v + dv) | 0;
        const at = line * across + x;
        const a = from[at];
        const b = from[at + 1];
        const c = from[at + across];
        const d = from[at + across + 1];
        let pixel = a;
        if (a !== b || a !== c || a !== d) {
          const wd = (fx * fy) >> 8;
          const wb = fx - wd;
          const wc = fy - wd;
          const wa = 256 - wb - wc - wd;
          const even =
            Math.imul(a & pairs, wa) +
            Math.imul(b & pairs, wb) +
            Math.imul(c & pairs, wc) +
            Math.imul(d & pairs, wd);
          const odd =
            Math.imul((a >>> 8) & pairs, wa) +
            Math.imul((b >>> 8) & pairs, wb) +
            Math.imul((c >>> 8) & pairs, wc) +
            Math.imul((d >>> 8) & pairs, wd);
          pixel = (((even >>> 8) & pairs) | (odd & other)) >>> 0;
        }
        if (tone) pixel = toned(pixel, tone);
        if (pixel >= 0xff000000) pixels[i] = pixel;
        else if (pixel !== 0) pixels[i] = over(pixel, pixels[i]);
      }
    };
    for (let i = 0; i < corners.length; i += 3) {
      const a = 2 * corners[i];
      const b = 2 * corners[i + 1];
      const c = 2 * corners[i + 2];
      const ax = places[a];
      const ay = places[a + 1];
      const bx = places[b];
      const by = places[b + 1];
      const cx = places[c];
      const cy = places[c + 1];
      const twice = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay);
      if (!(Math.abs(twice) > 1e-9)) continue;
      const ua = texels[a];
      const va = texels[a + 1];
      const ub = texels[b] - ua;
      const vb = texels[b + 1] - va;
      const uc = texels[c] - ua;
      const vc = texels[c + 1] - va;
      ux = (ub * (cy - ay) - uc * (by - ay)) / twice;
      uy = (uc * (bx - ax) - ub * (cx - ax)) / twice;
      vx = (vb * (cy - ay) - vc * (by - ay)) / twice;
      vy = (vc * (bx - ax) - vb * (cx - ax)) / twice;
      // From middles of pixels to middles of texels.
      u0 = ua + (0.5 - ax) * ux + (0.5 - ay) * uy - 0.5;
      v0 = va + (0.5 - ax) * vx + (0.5 - ay) * vy - 0.5;
      this.scan(ax, ay, bx, by, cx, cy, row);
    }
  }

  /** Lines, two corners each, a pixel wide. */
  lines(ends: ArrayLike<number>, places: ArrayLike<number>, colour: number): void {
    this.reach(places, ends);
    const { pixels, width, height } = this;
    for (let i = 0; i < ends.length; i += 2) {
      const x = places[2 * ends[i]];
      const y = places[2 * ends[i] + 1];
      const dx = places[2 * ends[i + 1]] - x;
      const dy = places[2 * ends[i + 1] + 1] - y;
      const count = Math.min(1e4, Math.ceil(Math.max(Math.abs(dx), Math.abs(dy))));
      for (let k = 0; k < count; ++k) {
        const px = Math.floor(x + (dx * k) / count);
        const py = Math.floor(y + (dy * k) / count);
        if (px < 0 || py < 0 || px >= width || py >= height) continue;
        pixels[py * width + px] = over(colour, pixels[py * width + px]);
      }
    }
  }

  /** Colours no longer times alpha, as a canvas takes them. Then nothing more is drawn. */
  finish(): void {
    const { pixels, bytes, width } = this;
    const [left, top, across, down] = this.box;
    for (let y = top; y < top + down; ++y) {
      for (let i = y * width + left; i < y * width + left + across; ++i) {
        const alpha = pixels[i] >>> 24;
        if (alpha === 0 || alpha === 255) continue;
        for (let k = 4 * i; k < 4 * i + 3; ++k) bytes[k] = (bytes[k] * 255) / alpha;
      }
    }
  }
}

function toned(pixel: number, { tint, part, strength }: Tone): number {
  const alpha = part > 1.5 ? 255 : pixel >>> 24;
  const most = Math.min(1, part);
  const mixed = (shift: number, colour: number): number => {
    const own = (pixel >>> shift) & 255;
    return Math.round((own + most * ((colour * alpha) / 255 - own)) * strength);
  };
  return packed(
    mixed(0, tint[0]),
    mixed(8, tint[1]),
    mixed(16, tint[2]),
    Math.round(alpha * strength),
  );
}
