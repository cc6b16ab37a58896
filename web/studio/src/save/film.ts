// The pictures of a film, and files made of them.
import { boxOf } from "../model/geometry.js";
import type { Box } from "../model/geometry.js";
import type { Body } from "../model/puppet.js";
import { fit } from "../view/camera.js";
import { painterOf } from "../view/painter.js";
import type { Painter } from "../view/scene.js";

export interface Pictures {
  body: Body;
  image: HTMLCanvasElement;
  shapes: readonly ArrayLike<number>[];
  order: ArrayLike<number>;
}

/** Paints shapes one after the other, all with the same frame around them. */
export class Projector {
  readonly canvas = document.createElement("canvas");
  readonly #painter: Painter;
  readonly #pictures: Pictures;
  readonly #box: Box;

  /** The longer side has `size` pixels. */
  constructor(pictures: Pictures, size: number) {
    this.#pictures = pictures;
    const boxes = pictures.shapes.map(boxOf);
    this.#box = {
      left: Math.min(...boxes.map((box) => box.left)) - 4,
      right: Math.max(...boxes.map((box) => box.right)) + 4,
      bottom: Math.min(...boxes.map((box) => box.bottom)) - 4,
      top: Math.max(...boxes.map((box) => box.top)) + 4,
    };
    const [width, height] = [this.#box.right - this.#box.left, this.#box.top - this.#box.bottom];
    const scale = size / Math.max(width, height);
    // Films want even numbers.
    this.canvas.width = 2 * Math.max(1, Math.round((width * scale) / 2));
    this.canvas.height = 2 * Math.max(1, Math.round((height * scale) / 2));
    this.#painter = painterOf(this.canvas, true);
    this.#painter.picture(pictures.image);
    this.#painter.body(pictures.body);
  }

  show(index: number): void {
    const { width, height } = this.canvas;
    this.#painter.paint(
      {
        camera: fit(this.#box, width, height, 0),
        shape: this.#pictures.shapes[index],
        order: this.#pictures.order,
        ghosts: [],
        layers: [],
        wire: null,
      },
      1,
    );
  }

  async png(index: number): Promise<Uint8Array> {
    this.show(index);
    return bytesOf(await blobOf(this.canvas, "image/png"));
  }

  /** As a data: address. */
  small(index: number): string {
    this.show(index);
    return this.canvas.toDataURL("image/webp", 0.85);
  }
}

export const blobOf = (canvas: HTMLCanvasElement, type: string): Promise<Blob> =>
  new Promise((resolve, reject) =>
    canvas.toBlob((blob) => (blob ? resolve(blob) : reject(new Error("no picture"))), type),
  );

export const bytesOf = async (blob: Blob): Promise<Uint8Array> =>
  new Uint8Array(await blob.arrayBuffer());

/** An SVG that shows one picture after the other, for ever. */
export function animatedSvg(
  pictures: readonly string[],
  width: number,
  height: number,
  rate: number,
  title: string,
): string {
  const count = pictures.length;
  const seconds = count / rate;
  const show = (100 / count).toFixed(4);
  // One picture alone stays. With the wish for less motion it is the first.
  const style =
    count > 1
      ? `image{visibility:hidden;animation:show ${seconds.toFixed(4)}s step-end infinite}` +
        `@keyframes show{0%{visibility:visible}${show}%{visibility:hidden}}` +
        `@media(prefers-reduced-motion:reduce){image{animation:none}image:first-of-type{visibility:visible}}`
      : "";
  const images = pictures.map((picture, i) => {
    const delay = count > 1 ? ` style="animation-delay:${(i / rate).toFixed(4)}s"` : "";
    return `<image width="${width}" height="${height}" href="${picture}"${delay}/>`;
  });
  const name = title.replace(/[<&]/g, "");
  return (
    `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${width} ${height}" width="${width}" height="${height}">` +
    `<title>${name}</title><style>${style}</style>\n${images.join("\n")}\n</svg>\n`
  );
}

/** The kind of film that this browser can record, or undefined. */
export const filmType = (): string | undefined =>
  typeof MediaRecorder === "undefined"
    ? undefined
    : ["video/webm;codecs=vp9", "video/webm;codecs=vp8", "video/webm"].find((type) =>
        MediaRecorder.isTypeSupported(type),
      );

/** Plays the film once, every picture of it, and records it. On a slow machine it is a slower film. */
export async function webm(
  projector: Projector,
  count: number,
  rate: number,
  type: string,
  progress: (part: number) => void,
): Promise<Blob> {
  const stream = projector.canvas.captureStream(0);
  const [track] = stream.getVideoTracks() as CanvasCaptureMediaStreamTrack[];
  const recorder = new MediaRecorder(stream, { mimeType: type, videoBitsPerSecond: 6_000_000 });
  const parts: Blob[] = [];
  recorder.ondataavailable = ({ data }) => parts.push(data);
  const ended = new Promise((resolve) => (recorder.onstop = resolve));
  const started = new Promise((resolve) => (recorder.onstart = resolve));
  projector.show(0);
  recorder.start();
  track.requestFrame();
  await started;
  const began = performance.now();
  for (let i = 0; i < count; ++i) {
    projector.show(i);
    track.requestFrame();
    progress(i / count);
    const due = began + (1000 * (i + 1)) / rate;
    await new Promise((resolve) => setTimeout(resolve, Math.max(8, due - performance.now())));
  }
  track.requestFrame();
  recorder.stop();
  await ended;
  return new Blob(parts, { type });
}
