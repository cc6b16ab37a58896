// From the opaque part of a picture to outlines that can be meshed.
import { fieldOf } from "./field.js";
import type { Picture } from "./field.js";
import { doCross, simplify } from "./simplify.js";
import { areaOf, trace } from "./trace.js";
import type { Loop } from "./trace.js";

export interface OutlineOptions {
  /** From which alpha on a pixel belongs to the figure, 1 to 255. */
  threshold: number;
  /** How far the outlines may be from the pixels' border. */
  tolerance: number;
  /** How far around the figure the mesh reaches. In pixels, as the tolerance. */
  expansion: number;
}

export interface Outlines {
  /** x y x y… with y up, in pixels: (0, 0) is the lower left corner of the picture. */
  loops: Loop[];
  /** Specks and pinholes that were left out. */
  dropped: number;
  /** How far the outlines are from the pixels' border at most. */
  error: number;
}

/** Smaller pieces and holes, in square pixels, are left out. */
export const speck = 24;

/** No loops where everything is transparent. */
export function outlinesOf(picture: Picture, options: OutlineOptions): Outlines {
  const field = fieldOf(picture, options.threshold, options.expansion);
  const all = trace(field.values, field.width, field.height);
  const traced = all.filter((loop) => Math.abs(areaOf(loop)) >= speck);
  const offset = field.margin - 0.5;
  for (const loop of traced) {
    for (let i = 0; i < loop.length; i += 2) {
      loop[i] -= offset;
      loop[i + 1] = picture.height - (loop[i + 1] - offset);
    }
  }
  // What is simplified too far may cross itself; what was traced does not.
  let error = options.tolerance;
  for (let tries = 0; tries < 6; ++tries, error /= 2) {
    const loops = traced.map((loop) => simplify(loop, error));
    if (!doCross(loops)) return { loops, dropped: all.length - traced.length, error };
  }
  return { loops: traced, dropped: all.length - traced.length, error: 0 };
}
