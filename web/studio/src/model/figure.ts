// Figures: pictures that become puppets. They live beside the document, which names them by number.
import type { Picture } from "../outline/field.js";

export interface Figure {
  name: string;
  /** Its pixels, at most `mostPixels` on the longer side. */
  canvas: HTMLCanvasElement;
  /** Where pins do well, x y with y up; often none. */
  pins: readonly (readonly [number, number])[];
  /** Whether it was larger. */
  scaled: boolean;
}

export const mostPixels = 1024;

/** Rejects when the browser cannot read it. */
export async function figureOf(
  name: string,
  source: string | Blob,
  pins: readonly (readonly [number, number])[] = [],
): Promise<Figure> {
  const image = new Image();
  image.src = typeof source === "string" ? source : await dataAddress(source);
  await image.decode();
  const [width, height] = [image.naturalWidth || 512, image.naturalHeight || 512];
  const scale = Math.min(1, mostPixels / Math.max(width, height));
  const canvas = document.createElement("canvas");
  canvas.width = Math.max(1, Math.round(width * scale));
  canvas.height = Math.max(1, Math.round(height * scale));
  const context = canvas.getContext("2d", { willReadFrequently: true })!;
  context.imageSmoothingQuality = "high";
  context.drawImage(image, 0, 0, canvas.width, canvas.height);
  const up = pins.map(([x, y]) => [x, canvas.height - y] as const);
  return { name, canvas, pins: up, scaled: scale < 1 };
}

const dataAddress = (blob: Blob): Promise<string> =>
  new Promise((resolve, reject) => {
    const reader = new FileReader();
    reader.onload = () => resolve(reader.result as string);
    reader.onerror = () => reject(reader.error as Error);
    reader.readAsDataURL(blob);
  });

export function pictureOf(figure: Figure): Picture {
  const { width, height } = figure.canvas;
  const { data } = figure.canvas.getContext("2d")!.getImageData(0, 0, width, height);
  const alpha = new Uint8Array(width * height);
  for (let i = 0; i < alpha.length; ++i) alpha[i] = data[4 * i + 3];
  return { width, height, alpha };
}
