// What a painter of the figure is given, and what painters share.
import type { Body } from "../model/puppet.js";
import type { Camera } from "./camera.js";

export type Colour = readonly [red: number, green: number, blue: number];

/** A layer of triangles over the figure: `part` of its colour is the tint. Above 1: nothing else. */
export interface Layer {
  triangles: ArrayLike<number>;
  tint: Colour;
  part: number;
  strength: number;
}

export interface Scene {
  camera: Camera;
  shape: ArrayLike<number>;
  /** Triangles back to front; empty: as they are numbered. */
  order: ArrayLike<number>;
  /** Paler poses behind it. */
  ghosts: { shape: ArrayLike<number>; strength: number }[];
  layers: Layer[];
  /** Edges of the mesh, or null. */
  wire: Colour | null;
}

export interface Painter {
  /** A graphics processor draws. */
  readonly isFast: boolean;
  /** The picture that the figure is cut from. */
  picture(image: HTMLCanvasElement): void;
  body(body: Body): void;
  /** Paints into the whole canvas, whose CSS pixels are `ratio` of its own. */
  paint(scene: Scene, ratio: number): void;
}

/** The corners of triangles in an order; kept, as it is the same for all pictures of a drag. */
export class Ordered {
  #last: { triangles: Uint32Array; order: ArrayLike<number>; corners: Uint32Array } | undefined;

  of(triangles: Uint32Array, order: ArrayLike<number>): Uint32Array {
    const last = this.#last;
    if (last?.triangles === triangles && last.order === order) return last.corners;
    const corners = cornersOf(triangles, order);
    this.#last = { triangles, order, corners };
    return corners;
  }
}

/** The corners of these triangles in this order; empty: of all, as they are numbered. */
export function cornersOf(triangles: Uint32Array, order: ArrayLike<number>): Uint32Array {
  if (order.length === 0) return triangles;
  const corners = new Uint32Array(3 * order.length);
  for (let i = 0; i < order.length; ++i) {
    for (let k = 0; k < 3; ++k) corners[3 * i + k] = triangles[3 * order[i] + k];
  }
  return corners;
}

/** Both ends of every edge, once. */
export function endsOf(triangles: Uint32Array): Uint32Array {
  const edges = new Map<string, [number, number]>();
  for (let i = 0; i < triangles.length; i += 3) {
    for (let k = 0; k < 3; ++k) {
      const [a, b] = [triangles[i + k], triangles[i + ((k + 1) % 3)]];
      edges.set(`${Math.min(a, b)},${Math.max(a, b)}`, [a, b]);
    }
  }
  return Uint32Array.from([...edges.values()].flat());
}
