// A surface as it is seen from somewhere: what lies under a pointer.
import { Bins } from "./bins.js";
import { clickReach, hitBeside } from "./surface.js";
import type { Hit, Surface } from "./surface.js";

/** Everything is found out once, O(#V + #F), and then asked as often as the pointer moves. */
export class Sight {
  readonly #surface: Surface;
  /** x and y of every vertex in the view. */
  readonly places: Float64Array;
  /** One over its distance along the view; NaN behind the eye. */
  readonly nearness: Float64Array;
  // From -1 to 1.
  readonly #depths: Float64Array;
  #bins: Bins | undefined;

  /** `matrix` takes a vertex to the clip space of WebGL, column by column; the view has so many pixels. */
  constructor(surface: Surface, matrix: ArrayLike<number>, width: number, height: number) {
    this.#surface = surface;
    const { vertices } = surface;
    const count = vertices.length / 3;
    this.places = new Float64Array(2 * count);
    this.#depths = new Float64Array(count);
    this.nearness = new Float64Array(count);
    const m = matrix;
    for (let i = 0; i < count; ++i) {
      const x = vertices[3 * i];
      const y = vertices[3 * i + 1];
      const z = vertices[3 * i + 2];
      const w = m[3] * x + m[7] * y + m[11] * z + m[15];
      // What is behind the eye is nowhere.
      const nearness = w > 0 ? 1 / w : NaN;
      this.nearness[i] = nearness;
      this.#depths[i] = (m[2] * x + m[6] * y + m[10] * z + m[14]) * nearness;
      const right = (m[0] * x + m[4] * y + m[8] * z + m[12]) * nearness;
      const up = (m[1] * x + m[5] * y + m[9] * z + m[13]) * nearness;
      this.places[2 * i] = ((right + 1) / 2) * width;
      this.places[2 * i + 1] = ((1 - up) / 2) * height;
    }
  }

  // When somebody points at it.
  #binned(): Bins {
    return (this.#bins ??= new Bins(this.#surface.triangles, this.places));
  }

  /** The triangle in front at that place of the view. */
  at(x: number, y: number): Hit | null {
    const { triangles } = this.#surface;
    let best: Hit | null = null;
    let least = Infinity;
    for (const { triangle, weights } of this.#binned().at(x, y)) {
      const sum = (of: Float64Array): number =>
        weights.reduce((all, weight, k) => all + weight * of[triangles[3 * triangle + k]], 0);
      const depth = sum(this.#depths);
      if (depth < -1 || depth >= least) continue;
      least = depth;
      // As they are in space, not in the view.
      const all = sum(this.nearness);
      const [a, b, c] = weights.map(
        (weight, k) => (weight * this.nearness[triangles[3 * triangle + k]]) / all,
      );
      best = { triangle, weights: [a, b, c] };
    }
    return best;
  }

  /** The corner that a click beside the surface means. */
  beside(x: number, y: number): Hit | null {
    const { triangles } = this.#surface;
    const seen = (corner: number): [number, number, number] => {
      const vertex = triangles[corner];
      return [this.places[2 * vertex], this.places[2 * vertex + 1], this.#depths[vertex]];
    };
    return hitBeside(this.#binned().near(x, y, clickReach), seen, x, y);
  }
}
