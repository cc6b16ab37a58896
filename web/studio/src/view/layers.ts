// What is shown over the figure: starch, and triangles that are flipped.
import type { Studio } from "../studio.js";
import type { Colour, Layer } from "./scene.js";

const red: Colour = [0.86, 0.1, 0.12];
const blue: Colour = [0.1, 0.36, 0.85];

/** `filmed`: a take plays, whose flipped triangles nobody knows. */
export function layersOf({ looks, puppet, flipped }: Studio, filmed: boolean): Layer[] {
  const layers: Layer[] = [];
  if (puppet.starch && (looks.tool === "starch" || looks.wire)) {
    const levels = new Map<number, number[]>();
    puppet.starch.forEach((amount, triangle) => {
      if (amount === 1) return;
      const level = Math.round(Math.log2(Math.max(1, amount)));
      levels.set(level, [...(levels.get(level) ?? []), triangle]);
    });
    for (const [level, triangles] of levels) {
      const part = 0.25 + Math.min(0.45, level * 0.07);
      layers.push({ triangles, tint: blue, part, strength: 1 });
    }
  }
  if (looks.flips && !filmed && flipped.length > 0) {
    layers.push({ triangles: flipped, tint: red, part: 2, strength: 0.8 });
  }
  return layers;
}
