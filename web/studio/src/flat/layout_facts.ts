// What does not change while a layout is moved on the screen, and is wanted for every picture of it.
import { packed } from "../view/raster.js";
import { Bins } from "./bins.js";
import type { Layout } from "./layout.js";
import { colourOf, paleOf, shadeOf, shades } from "./strain.js";
import { isBorder } from "./surface.js";
import type { Edges } from "./surface.js";

/** Of the same triangle. */
export const nextCorner = (corner: number): number => (corner % 3 === 2 ? corner - 2 : corner + 1);

export interface LineKinds {
  /** From a flat place to another. */
  inner: Uint32Array;
  /** Corners, from which an edge goes to the next. */
  border: number[];
  seam: number[];
  cut: number[];
}

/** Computed once for a layout. */
export class LayoutFacts {
  /** How long edges are in the middle, in units. */
  readonly edge: number;
  #bins: Bins | undefined;
  #lines: { edges: Edges; seams: readonly number[]; kinds: LineKinds } | undefined;
  #corners: { edges: Edges; first: Uint32Array; corners: Uint32Array } | undefined;

  constructor(readonly layout: Layout) {
    const area = layout.pieces.reduce((sum, piece) => sum + piece.area, 0);
    this.edge = Math.sqrt((2.3 * area) / Math.max(1, layout.strain.length));
  }

  bins(): Bins {
    return (this.#bins ??= new Bins(this.layout.cornerUv, this.layout.uv));
  }

  lines(edges: Edges, seams: readonly number[]): LineKinds {
    const known = this.#lines;
    if (known?.edges === edges && known.seams === seams) return known.kinds;
    const { cornerUv, autoCuts } = this.layout;
    const kind = new Uint8Array(edges.count);
    for (const edge of autoCuts) kind[edge] = 2;
    for (const edge of seams) kind[edge] = 3;
    const inner: number[] = [];
    const kinds = { border: [] as number[], cut: [] as number[], seam: [] as number[] };
    for (let corner = 0; corner < cornerUv.length; ++corner) {
      const edge = edges.ofTriangle[corner];
      if (kind[edge] === 3) kinds.seam.push(corner);
      else if (kind[edge] === 2) kinds.cut.push(corner);
      else if (isBorder(edges, edge)) kinds.border.push(corner);
      // Of both sides one draws it.
      else if (cornerUv[corner] < cornerUv[nextCorner(corner)])
        inner.push(cornerUv[corner], cornerUv[nextCorner(corner)]);
    }
    const made = { ...kinds, inner: Uint32Array.from(inner) };
    this.#lines = { edges, seams, kinds: made };
    return made;
  }

  /** The corners from which these edges go: one for each side. */
  cornersOf(edges: Edges, some: readonly number[]): number[] {
    if (this.#corners?.edges !== edges) {
      const { ofTriangle } = edges;
      const first = new Uint32Array(edges.count + 1);
      for (const edge of ofTriangle) first[edge + 1]++;
      for (let i = 0; i < edges.count; ++i) first[i + 1] += first[i];
      const corners = new Uint32Array(ofTriangle.length);
      const filled = first.slice();
      ofTriangle.forEach((edge, corner) => (corners[filled[edge]++] = corner));
      this.#corners = { edges, first, corners };
    }
    const { first, corners } = this.#corners!;
    return some.flatMap((edge) => [...corners.subarray(first[edge], first[edge + 1])]);
  }
}

/** A colour for each triangle; paler where it is not of the chosen piece, if one is. */
export function coloursOf({ strain, pieceOf }: Layout, range: number, chosen: number): Uint32Array {
  const inks = Array.from({ length: 2 * shades + 1 }, (_, i) => colourOf(i - shades));
  const full = inks.map((colour) => packed(...colour));
  const pale = inks.map((colour) => packed(...paleOf(colour)));
  const colours = new Uint32Array(strain.length);
  for (let t = 0; t < strain.length; ++t) {
    const inked = chosen >= 0 && pieceOf[t] !== chosen ? pale : full;
    colours[t] = inked[shadeOf(strain[t], range) + shades];
  }
  return colours;
}
