// From a figure to its mesh: outlines are made here, triangles on the server.
import { pictureOf } from "./model/figure.js";
import type { Figure } from "./model/figure.js";
import type { Body, Cut } from "./model/puppet.js";
import { meshOutlines } from "./net/api.js";
import { outlinesOf } from "./outline/outlines.js";

export interface MeshFacts {
  pieces: number;
  holes: number;
  /** How far the outline is from the picture's at most, in its pixels. */
  error: number;
  /** Specks that were left out. */
  dropped: number;
  /** No pixel of the border is transparent: the puppet is a rectangle. */
  opaque: boolean;
}

/** Undefined where nothing is opaque enough. Rejects with a Problem of the server's. */
export async function bodyOf(
  figure: Figure,
  cut: Cut,
): Promise<{ body: Body; facts: MeshFacts } | undefined> {
  const picture = pictureOf(figure);
  const { loops, error, dropped } = outlinesOf(picture, cut);
  if (loops.length === 0) return undefined;
  const answer = await meshOutlines(loops, cut.vertices);
  const vertices = Float64Array.from(answer.mesh.vertices);
  const triangles = Uint32Array.from(answer.mesh.triangles);
  const opaque = rim(picture).every((alpha) => alpha >= cut.threshold);
  const { pieceCount: pieces, holeCount: holes } = answer;
  return {
    body: { picture: vertices, rest: vertices, triangles },
    facts: { pieces, holes, error, dropped, opaque },
  };
}

/** The alpha along the picture's border. */
function rim(picture: { width: number; height: number; alpha: ArrayLike<number> }): number[] {
  const { width, height, alpha } = picture;
  const values: number[] = [];
  for (let x = 0; x < width; ++x) values.push(alpha[x], alpha[(height - 1) * width + x]);
  for (let y = 0; y < height; ++y) values.push(alpha[y * width], alpha[y * width + width - 1]);
  return values;
}

/** Vertices far from one another. */
export function spread(body: Body, count: number): [number, number][] {
  const { picture } = body;
  const chosen: number[] = [0];
  const distance = new Float64Array(picture.length / 2).fill(Infinity);
  while (chosen.length < Math.min(count + 1, distance.length)) {
    const last = chosen[chosen.length - 1];
    let far = 0;
    for (let i = 0; i < distance.length; ++i) {
      const dx = picture[2 * i] - picture[2 * last];
      const dy = picture[2 * i + 1] - picture[2 * last + 1];
      distance[i] = Math.min(distance[i], Math.hypot(dx, dy));
      if (distance[i] > distance[far]) far = i;
    }
    chosen.push(far);
  }
  // The first one was only to begin with.
  return chosen.slice(1).map((i) => [picture[2 * i], picture[2 * i + 1]]);
}
