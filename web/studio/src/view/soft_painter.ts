// The textured mesh on a canvas, drawn by the page itself. Where there is no graphics processor a browser's WebGL
// also computes every pixel here, in threads that wait for each other, and the page waits until they are read back.
import type { Body } from "../model/puppet.js";
import { Raster, packed } from "./raster.js";
import type { Image, Tone } from "./raster.js";
import { Ordered, cornersOf, endsOf } from "./scene.js";
import type { Colour, Painter, Scene } from "./scene.js";

const to255 = ([red, green, blue]: Colour): [number, number, number] => [
  255 * red,
  255 * green,
  255 * blue,
];

export class SoftPainter implements Painter {
  readonly isFast = false;
  readonly #canvas: HTMLCanvasElement;
  readonly #context: CanvasRenderingContext2D;
  readonly #ordered = new Ordered();
  #raster = new Raster(1, 1);
  #shown: [number, number, number, number] = [0, 0, 0, 0];
  #picture: HTMLCanvasElement | null = null;
  // Each half as wide as the one before, made when it is needed.
  #levels: Image[] = [];
  #body: Body | null = null;
  #texels: Float64Array = new Float64Array(0);
  #level = 0;
  #edges: Uint32Array | null = null;

  constructor(canvas: HTMLCanvasElement) {
    this.#canvas = canvas;
    this.#context = canvas.getContext("2d", { willReadFrequently: true })!;
  }

  picture(image: HTMLCanvasElement): void {
    this.#picture = image;
    this.#levels = [];
    this.#body = null;
  }

  body(body: Body): void {
    if (body === this.#body) return;
    if (body.triangles !== this.#body?.triangles) this.#edges = null;
    if (body.picture !== this.#body?.picture) this.#texels = new Float64Array(0);
    this.#body = body;
  }

  paint(scene: Scene, ratio: number): void {
    const { width, height } = this.#canvas;
    if (this.#raster.width !== width || this.#raster.height !== height) {
      this.#raster = new Raster(width, height);
      this.#shown = [0, 0, width, height];
    } else this.#raster.clear();
    if (this.#body && this.#picture) this.#draw(this.#body, scene, ratio);
    this.#raster.finish();
    // What was there before goes as well.
    const now = this.#raster.box;
    const [x, y, across, down] = around(now, this.#shown);
    this.#shown = now;
    if (across === 0) return;
    const image = new ImageData(this.#raster.bytes, width, height);
    this.#context.putImageData(image, 0, 0, x, y, across, down);
  }

  #draw(body: Body, scene: Scene, ratio: number): void {
    const { width, height } = this.#canvas;
    const { camera } = scene;
    const zoom = camera.zoom * ratio;
    const placed = (shape: ArrayLike<number>): Float64Array => {
      const places = new Float64Array(shape.length);
      for (let i = 0; i < shape.length; i += 2) {
        places[i] = width / 2 + (shape[i] - camera.x) * zoom;
        places[i + 1] = height / 2 - (shape[i + 1] - camera.y) * zoom;
      }
      return places;
    };
    const image = this.#imageFor(body, zoom);
    const all = this.#ordered.of(body.triangles, scene.order);
    const draw = (corners: Uint32Array, places: Float64Array, tone: Tone | null): void =>
      this.#raster.textured(corners, places, this.#texels, image, tone);
    for (const { shape, strength } of scene.ghosts)
      draw(all, placed(shape), { tint: [0, 0, 0], part: 0, strength });
    const places = placed(scene.shape);
    draw(all, places, null);
    for (const { triangles, tint, part, strength } of scene.layers) {
      if (triangles.length === 0) continue;
      draw(cornersOf(body.triangles, triangles), places, { tint: to255(tint), part, strength });
    }
    if (scene.wire) {
      this.#edges ??= endsOf(body.triangles);
      const [red, green, blue] = to255(scene.wire).map((value) => Math.round(0.45 * value));
      this.#raster.lines(this.#edges, places, packed(red, green, blue, Math.round(0.45 * 255)));
    }
  }

  /** The picture at about the size at which it is seen; `#texels` are places on it. */
  #imageFor(body: Body, zoom: number): Image {
    const { width, height } = this.#picture!;
    const wanted = Math.round(Math.log2(1 / zoom));
    const least = Math.floor(Math.log2(Math.max(2, Math.min(width, height)) / 2));
    const level = Math.min(Math.max(0, wanted), least);
    const image = (this.#levels[level] ??= imageOf(
      this.#picture!,
      Math.max(2, width >> level),
      Math.max(2, height >> level),
    ));
    if (this.#texels.length !== body.picture.length || this.#level !== level) {
      this.#level = level;
      const [sx, sy] = [image.width / width, image.height / height];
      this.#texels = Float64Array.from(body.picture, (value, i) =>
        i % 2 === 0 ? value * sx : (height - value) * sy,
      );
    }
    return image;
  }
}

type Box = readonly [number, number, number, number];

function around(a: Box, b: Box): Box {
  if (a[2] === 0) return b;
  if (b[2] === 0) return a;
  const [x, y] = [Math.min(a[0], b[0]), Math.min(a[1], b[1])];
  return [x, y, Math.max(a[0] + a[2], b[0] + b[2]) - x, Math.max(a[1] + a[3], b[1] + b[3]) - y];
}

function imageOf(picture: HTMLCanvasElement, width: number, height: number): Image {
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [width, height];
  const context = canvas.getContext("2d", { willReadFrequently: true })!;
  context.imageSmoothingQuality = "high";
  context.drawImage(picture, 0, 0, width, height);
  const { data } = context.getImageData(0, 0, width, height);
  for (let i = 0; i < data.length; i += 4) {
    const alpha = data[i + 3];
    if (alpha < 255) for (let k = i; k < i + 3; ++k) data[k] = (data[k] * alpha) / 255;
  }
  return { width, height, pixels: new Uint32Array(data.buffer) };
}
