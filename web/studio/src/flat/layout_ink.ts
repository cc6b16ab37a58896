// What is written and drawn on the flat pieces besides their lines, in pixels of the view.
import { words } from "../words.js";
import { mark } from "./palette.js";
import type { Palette } from "./palette.js";

type Point = readonly [number, number];

/** A line with a head at both ends. */
export function drawGrain(context: CanvasRenderingContext2D, a: Point, b: Point): void {
  const angle = Math.atan2(b[1] - a[1], b[0] - a[0]);
  context.beginPath();
  context.moveTo(...a);
  context.lineTo(...b);
  for (const [end, turn] of [
    [b, 0],
    [a, Math.PI],
  ] as const) {
    for (const side of [-0.4, 0.4]) {
      context.moveTo(...end);
      const to = angle + turn + Math.PI + side;
      context.lineTo(end[0] + 12 * Math.cos(to), end[1] + 12 * Math.sin(to));
    }
  }
  for (const [colour, width] of [
    ["#ffffff", 5],
    [mark.grain, 2.2],
  ] as const) {
    context.strokeStyle = colour;
    context.lineWidth = width;
    context.stroke();
  }
}

/** The name of a piece, where it has room. */
export function drawName(
  context: CanvasRenderingContext2D,
  name: string,
  [x, y]: Point,
  room: number,
): void {
  const wide = name === "" ? 0 : context.measureText(name).width;
  if (wide === 0 || wide > 0.8 * room) return;
  context.strokeStyle = mark.paper;
  context.fillStyle = mark.grain;
  context.lineWidth = 4;
  context.strokeText(name, x - wide / 2, y + 5);
  context.fillText(name, x - wide / 2, y + 5);
}

/** How long a round number of millimetres is here, in the lower left corner. `pixels` has one of them. */
export function drawScale(
  context: CanvasRenderingContext2D,
  { ink, veil }: Palette,
  pixels: number,
  height: number,
): void {
  const wanted = 90 / pixels;
  const power = 10 ** Math.floor(Math.log10(wanted));
  const step = power * ([5, 2].find((one) => one * power <= wanted) ?? 1);
  const [x, y, length] = [14, height - 14, step * pixels];
  const text = words.flat.mm(step);
  context.fillStyle = veil;
  const wide = Math.max(length, context.measureText(text).width + 6) + 12;
  context.fillRect(x - 6, y - 26, wide, 32);
  context.strokeStyle = context.fillStyle = ink;
  context.lineWidth = 1.5;
  context.beginPath();
  context.moveTo(x, y - 5);
  context.lineTo(x, y);
  context.lineTo(x + length, y);
  context.lineTo(x + length, y - 5);
  context.stroke();
  context.fillText(text, x + 6, y - 6);
}
