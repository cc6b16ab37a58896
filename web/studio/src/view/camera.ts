// How the figure's pixels, y up, lie on the canvas.
import type { Box } from "../model/geometry.js";

export interface Camera {
  /** The place of the figure in the middle of the view. */
  x: number;
  y: number;
  /** CSS pixels per pixel of the figure. */
  zoom: number;
}

export function fit(box: Box, width: number, height: number, margin = 0.16): Camera {
  const [w, h] = [box.right - box.left, box.top - box.bottom];
  const room = 1 - margin;
  return {
    x: (box.left + box.right) / 2,
    y: (box.bottom + box.top) / 2,
    zoom: Math.max(1e-3, Math.min((width * room) / w, (height * room) / h)),
  };
}

/** From the figure to the view, in CSS pixels from its upper left corner. */
export const toView = (
  camera: Camera,
  width: number,
  height: number,
  x: number,
  y: number,
): [number, number] => [
  width / 2 + (x - camera.x) * camera.zoom,
  height / 2 - (y - camera.y) * camera.zoom,
];

export const toFigure = (
  camera: Camera,
  width: number,
  height: number,
  x: number,
  y: number,
): [number, number] => [
  camera.x + (x - width / 2) / camera.zoom,
  camera.y - (y - height / 2) / camera.zoom,
];

/** Closer or farther; the place so many CSS pixels from the middle of the view stays where it is. */
export function zoomed(
  { x, y, zoom: before }: Camera,
  factor: number,
  dx: number,
  dy: number,
): Camera {
  const zoom = Math.min(40, Math.max(0.05, before * factor));
  const shift = 1 / before - 1 / zoom;
  return { x: x + dx * shift, y: y - dy * shift, zoom };
}

/** What is seen moves by so many CSS pixels. */
export const moved = ({ x, y, zoom }: Camera, dx: number, dy: number): Camera => ({
  x: x - dx / zoom,
  y: y + dy / zoom,
  zoom,
});
