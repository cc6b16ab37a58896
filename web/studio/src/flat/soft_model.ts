// The surface in space, drawn by the page itself where there is no graphics processor: what is nearer is in front,
// light comes from the side of the eye.
import { Raster, over, packed } from "../view/raster.js";
import type { Sight } from "./sight.js";

export interface Strokes {
  /** x y z from and to, and so on. */
  ends: readonly number[];
  colour: string;
  width: number;
  opacity: number;
}

export interface Dot {
  place: readonly [x: number, y: number, z: number];
  colour: string;
}

export interface SoftScene {
  sight: Sight;
  triangles: Uint32Array;
  /** x y z of each vertex, of length 1. */
  normals: Float32Array;
  /** The way to the light, of length 1. */
  light: readonly [x: number, y: number, z: number];
  /** Of each triangle. */
  colours: Uint32Array;
  strokes: readonly Strokes[];
  dots: readonly Dot[];
  dotRadius: number;
  /** Takes a place of strokes and dots to the clip space of WebGL, column by column. */
  clip: ArrayLike<number>;
}

const pairs = 0x00ff00ff;
const onSurface = 1.004; // Lines on the surface are in front of it.

// As bright as three.js has it with an ambient light of 1.6 and one of 1.9 from a side, in 256 parts.
const bright = Uint16Array.from({ length: 513 }, (_, i) => {
  const lit = (1.6 + 1.9 * Math.max(0, (i - 256) / 256)) / Math.PI;
  return Math.round(256 * Math.min(1, lit) ** (1 / 2.2));
});

class DeepRaster extends Raster {
  readonly #near: Float32Array;

  constructor(width: number, height: number) {
    super(width, height);
    this.#near = new Float32Array(width * height);
  }

  begin(): void {
    this.clear();
    this.#near.fill(0);
  }

  lit(
    { triangles, normals, light: towards, colours }: SoftScene,
    places: Float64Array,
    nearness: Float64Array,
  ): void {
    const near = this.#near;
    const { pixels, width } = this;
    // How much each vertex faces the light.
    const facing = new Float32Array(normals.length / 3);
    for (let i = 0; i < facing.length; ++i) {
      const [x, y, z] = [normals[3 * i], normals[3 * i + 1], normals[3 * i + 2]];
      const cosine = x * towards[0] + y * towards[1] + z * towards[2];
      facing[i] = cosine < -1 ? -1 : cosine > 1 ? 1 : cosine || 0;
    }
    let [n0, nx, ny, l0, lx, ly, colour] = [0, 0, 0, 0, 0, 0, 0];
    const row = (y: number, first: number, end: number): void => {
      let n = n0 + first * nx + y * ny;
      let light = l0 + first * lx + y * ly;
      const last = y * width + end;
      for (let i = y * width + first; i < last; ++i) {
        if (n > near[i]) {
          near[i] = n;
          const k = light < 0 ? 0 : light > 256 ? 256 : light | 0;
          const even = (Math.imul(colour & pairs, k) >>> 8) & pairs;
          const green = (((colour >>> 8) & 255) * k) & 0xff00;
          pixels[i] = (0xff000000 | even | green) >>> 0;
        }
        n += nx;
        light += lx;
      }
    };
    for (let t = 0; 3 * t < triangles.length; ++t) {
      const a = triangles[3 * t];
      const b = triangles[3 * t + 1];
      const c = triangles[3 * t + 2];
      const ax = places[2 * a];
      const ay = places[2 * a + 1];
      const bx = places[2 * b] - ax;
      const by = places[2 * b + 1] - ay;
      const cx = places[2 * c] - ax;
      const cy = places[2 * c + 1] - ay;
      const twice = bx * cy - cx * by;
      if (!(Math.abs(twice) > 1e-9)) continue;
      // From behind the other side is lit. Rows go down, so that a front is the other way round.
      const side = twice < 0 ? 256 : -256;
      const la = bright[256 + Math.round(side * facing[a])];
      const lb = bright[256 + Math.round(side * facing[b])] - la;
      const lc = bright[256 + Math.round(side * facing[c])] - la;
      const na = nearness[a];
      const nb = nearness[b] - na;
      const nc = nearness[c] - na;
      nx = (nb * cy - nc * by) / twice;
      ny = (nc * bx - nb * cx) / twice;
      lx = (lb * cy - lc * by) / twice;
      ly = (lc * bx - lb * cx) / twice;
      n0 = na + (0.5 - ax) * nx + (0.5 - ay) * ny;
      l0 = la + (0.5 - ax) * lx + (0.5 - ay) * ly;
      colour = colours[t];
      this.scan(ax, ay, ax + bx, ay + by, ax + cx, ay + cy, row);
    }
  }

  /** A line of square dots, where nothing is in front of it. */
  stroke(from: ArrayLike<number>, to: ArrayLike<number>, colour: number, wide: number): void {
    const { width, height, pixels } = this;
    const [dx, dy, dn] = [to[0] - from[0], to[1] - from[1], to[2] - from[2]];
    const steps = Math.min(1e4, Math.ceil(Math.max(Math.abs(dx), Math.abs(dy), 1)));
    const half = (wide - 1) / 2;
    for (let k = 0; k <= steps; ++k) {
      const x = from[0] + (dx * k) / steps;
      const y = from[1] + (dy * k) / steps;
      const [px, py] = [Math.floor(x), Math.floor(y)];
      if (!(px >= 0 && py >= 0 && px < width && py < height)) continue;
      const n = (from[2] + (dn * k) / steps) * onSurface;
      if (n < this.#near[py * width + px]) continue;
      const left = Math.max(0, Math.round(x - half - 0.5));
      const top = Math.max(0, Math.round(y - half - 0.5));
      for (let j = top; j < Math.min(height, top + wide); ++j) {
        for (let i = left; i < Math.min(width, left + wide); ++i) {
          pixels[j * width + i] = over(colour, pixels[j * width + i]);
        }
      }
    }
  }
}

const inkOf = (colour: string): [number, number, number] => {
  const value = Number.parseInt(colour.trim().slice(1), 16);
  return [value >> 16, (value >> 8) & 255, value & 255];
};

export class SoftModel {
  readonly #context: CanvasRenderingContext2D;
  readonly #canvas: HTMLCanvasElement;
  #raster = new DeepRaster(1, 1);

  constructor(canvas: HTMLCanvasElement) {
    this.#canvas = canvas;
    this.#context = canvas.getContext("2d", { willReadFrequently: true })!;
  }

  /** `ratio` of its pixels are one of the view. */
  draw(scene: SoftScene, ratio: number): void {
    const { width, height } = this.#canvas;
    if (this.#raster.width !== width || this.#raster.height !== height)
      this.#raster = new DeepRaster(width, height);
    const raster = this.#raster;
    raster.begin();
    const { sight, strokes, dots, dotRadius, clip: m } = scene;
    const seen = (x: number, y: number, z: number): [number, number, number] => {
      const w = m[3] * x + m[7] * y + m[11] * z + m[15];
      const near = w > 0 ? 1 / w : NaN;
      const right = (m[0] * x + m[4] * y + m[8] * z + m[12]) * near;
      const up = (m[1] * x + m[5] * y + m[9] * z + m[13]) * near;
      return [((right + 1) / 2) * width, ((1 - up) / 2) * height, near];
    };
    raster.lit(
      scene,
      sight.places.map((value) => value * ratio),
      sight.nearness,
    );
    for (const { ends, colour, width: wide, opacity } of strokes) {
      const [red, green, blue] = inkOf(colour).map((value) => Math.round(opacity * value));
      const ink = packed(red, green, blue, Math.round(255 * opacity));
      const at = (i: number): number[] => seen(ends[i], ends[i + 1], ends[i + 2]);
      const pixels = Math.max(1, Math.round(wide * ratio));
      for (let i = 0; i < ends.length; i += 6) raster.stroke(at(i), at(i + 3), ink, pixels);
    }
    this.#context.putImageData(new ImageData(raster.bytes, width, height), 0, 0);
    for (const { place, colour } of dots) {
      const [x, y, nearness] = seen(...place);
      if (!(nearness > 0)) continue;
      this.#context.fillStyle = colour;
      this.#context.beginPath();
      this.#context.arc(x, y, dotRadius * ratio, 0, 2 * Math.PI);
      this.#context.fill();
    }
  }
}
