// A film as a skeleton for Spine 4.1 and its runtimes: one bone, one mesh, deform keys.
import type { Body } from "../model/puppet.js";

export interface SpineInput {
  name: string;
  body: Body;
  /** x y x y… per key. */
  shapes: readonly ArrayLike<number>[];
  rate: number;
  order: ArrayLike<number>;
  width: number;
  height: number;
}

const short = (value: number): number => Math.round(value * 100) / 100;

/** The longest border of the mesh, vertex by vertex. */
export function longestBorder(triangles: ArrayLike<number>): number[] {
  const next = new Map<number, number>();
  const sides = new Set<string>();
  for (let i = 0; i < triangles.length; i += 3) {
    for (let k = 0; k < 3; ++k) sides.add(`${triangles[i + k]},${triangles[i + ((k + 1) % 3)]}`);
  }
  for (const side of sides) {
    const [a, b] = side.split(",").map(Number);
    if (!sides.has(`${b},${a}`)) next.set(a, b);
  }
  let longest: number[] = [];
  while (next.size > 0) {
    const loop: number[] = [];
    let at: number | undefined = next.keys().next().value;
    while (at !== undefined && next.has(at)) {
      loop.push(at);
      const after: number = next.get(at)!;
      next.delete(at);
      at = after;
    }
    if (loop.length > longest.length) longest = loop;
  }
  return longest;
}

/** Vertices of the hull come first, as the format asks for. The picture is `${name}.png`. */
export function spineOf(input: SpineInput): string {
  const { body, name, width, height } = input;
  const hull = longestBorder(body.triangles);
  const onHull = new Set(hull);
  const count = body.rest.length / 2;
  const order = [...hull];
  for (let i = 0; i < count; ++i) if (!onHull.has(i)) order.push(i);
  const place = new Map(order.map((vertex, i) => [vertex, i]));
  const faces =
    input.order.length > 0
      ? Array.from(input.order)
      : Array.from({ length: body.triangles.length / 3 }, (_, i) => i);
  const triangles = faces.flatMap((face) =>
    [0, 1, 2].map((k) => place.get(body.triangles[3 * face + k])!),
  );
  const uvs = order.flatMap((vertex) => [
    Number((body.picture[2 * vertex] / width).toFixed(5)),
    Number((1 - body.picture[2 * vertex + 1] / height).toFixed(5)),
  ]);
  const setup = (vertex: number, axis: 0 | 1): number =>
    short(body.rest[2 * vertex + axis] - (axis === 0 ? width / 2 : 0));
  const vertices = order.flatMap((vertex) => [setup(vertex, 0), setup(vertex, 1)]);
  const deform = input.shapes.map((shape, k) => ({
    time: Number((k / input.rate).toFixed(4)),
    vertices: order.flatMap((vertex) =>
      ([0, 1] as const).map((axis) =>
        short(shape[2 * vertex + axis] - (axis === 0 ? width / 2 : 0) - setup(vertex, axis)),
      ),
    ),
  }));
  const attachment = { type: "mesh", uvs, triangles, vertices, hull: hull.length, width, height };
  return JSON.stringify({
    skeleton: { spine: "4.1.00", x: -width / 2, y: 0, width, height, images: "./" },
    bones: [{ name: "root" }],
    slots: [{ name, bone: "root", attachment: name }],
    skins: [{ name: "default", attachments: { [name]: { [name]: attachment } } }],
    animations: { take: { attachments: { default: { [name]: { [name]: { deform } } } } } },
  });
}
