// A small picture of a surface, drawn without WebGL.
import { h } from "../ui/dom.js";
import { extentOf } from "./surface.js";
import type { Surface } from "./surface.js";

const [width, height] = [120, 120];

/** An address of it: seen from the front, a little from the side and from above. */
export function thumbnail(surface: Surface): string {
  const { vertices, triangles } = surface;
  const { middle } = extentOf(vertices);
  const count = vertices.length / 3;
  const seen = new Float64Array(vertices.length);
  const [ca, sa, cb, sb] = [Math.cos(0.5), Math.sin(0.5), Math.cos(0.3), Math.sin(0.3)];
  for (let i = 0; i < count; ++i) {
    const [x, y, z] = [0, 1, 2].map((axis) => vertices[3 * i + axis] - middle[axis]);
    const [turned, deep] = [ca * x - sa * z, sa * x + ca * z];
    seen.set([turned, cb * y - sb * deep, sb * y + cb * deep], 3 * i);
  }
  const { middle: centre, size } = extentOf(seen);
  const scale = 0.96 * Math.min(width / size[0], height / size[1]);
  const order = Uint32Array.from({ length: triangles.length / 3 }, (_, i) => i);
  const depth = (t: number): number =>
    [0, 1, 2].reduce((sum, k) => sum + seen[3 * triangles[3 * t + k] + 2], 0);
  order.sort((a, b) => depth(a) - depth(b));
  const canvas = h("canvas", { width: 2 * width, height: 2 * height });
  const context = canvas.getContext("2d")!;
  context.scale(2, 2);
  context.lineWidth = 0.6;
  for (const t of order) {
    const at = [0, 1, 2].map((k) => 3 * triangles[3 * t + k]);
    const side = (k: number, axis: number): number => seen[at[k] + axis] - seen[at[0] + axis];
    const normal = [
      side(1, 1) * side(2, 2) - side(1, 2) * side(2, 1),
      side(1, 2) * side(2, 0) - side(1, 0) * side(2, 2),
      side(1, 0) * side(2, 1) - side(1, 1) * side(2, 0),
    ];
    const length = Math.hypot(...normal) || 1;
    const lit = Math.abs(0.25 * normal[0] + 0.35 * normal[1] + 0.9 * normal[2]) / length;
    context.fillStyle = context.strokeStyle = `hsl(172 38% ${30 + 42 * Math.min(1, lit)}%)`;
    context.beginPath();
    for (const i of at) {
      const [x, y] = [(seen[i] - centre[0]) * scale, (centre[1] - seen[i + 1]) * scale];
      context.lineTo(width / 2 + x, height / 2 + y);
    }
    context.closePath();
    context.fill();
    context.stroke();
  }
  return canvas.toDataURL();
}
