// A face of several corners cut into triangles, as arapctl cuts it (core/files/polygon.h): what
// arapctl and the gateway make of a file is the same mesh.

/** A concave face of more corners is not cut. */
export const maxConcaveCorners = 4096;

export type PolygonCut = "fan" | "ears" | "unclear" | "too_long";

// What counts as no height, as a part of the size of the polygon; and as no sine of an angle.
const flat = 1e-9;
const mostSearches = 8;

type Point3 = [number, number, number];
type Point2 = [number, number];

const minus = (a: Point3, b: Point3): Point3 => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const cross3 = (a: Point3, b: Point3): Point3 => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];
const dot3 = (a: Point3, b: Point3): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const scaled = (a: Point3, by: number): Point3 => [a[0] * by, a[1] * by, a[2] * by];
const largest = (a: Point3): number => Math.max(Math.abs(a[0]), Math.abs(a[1]), Math.abs(a[2]));
const twiceArea = (a: Point2, b: Point2, c: Point2): number =>
  (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
const distance = (a: Point2, b: Point2): number => Math.hypot(b[0] - a[0], b[1] - a[1]);

/**
 * The corners in the plane that the polygon's area vector is normal to, moved to the first one and
 * scaled to a size of about 1; undefined without area.
 */
function flattened(vertices: Float64Array, corners: ArrayLike<number>): Point2[] | undefined {
  const at = (i: number): Point3 => {
    const start = 3 * corners[i]!;
    return [vertices[start]!, vertices[start + 1]!, vertices[start + 2]!];
  };
  let most = 0;
  for (let i = 0; i < corners.length; i++) most = Math.max(most, largest(at(i)));
  const shrink = most > 1e150 ? 1 / most : 1;
  const origin = scaled(at(0), shrink);
  const moved = Array.from({ length: corners.length }, (_, i) =>
    minus(scaled(at(i), shrink), origin),
  );
  const size = moved.reduce((so, point) => Math.max(so, largest(point)), 0) || 1;
  const points = moved.map((point): Point3 => [point[0] / size, point[1] / size, point[2] / size]);
  const normal: Point3 = [0, 0, 0];
  for (let i = 1; i < points.length; i++) {
    const part = cross3(i === 1 ? [0, 0, 0] : points[i - 1]!, points[i]!);
    for (const k of [0, 1, 2] as const) normal[k] += part[k];
  }
  const area = Math.sqrt(dot3(normal, normal));
  if (!(area > flat * flat)) return undefined;
  for (const k of [0, 1, 2] as const) normal[k] /= area;
  const aside: Point3 = Math.abs(normal[0]) > 0.6 ? [0, 1, 0] : [1, 0, 0];
  const across = cross3(aside, normal);
  const length = Math.sqrt(dot3(across, across));
  const u: Point3 = [across[0] / length, across[1] / length, across[2] / length];
  const v = cross3(normal, u);
  return points.map((point) => [dot3(point, u), dot3(point, v)]);
}

// Whether all triangles from the first corner turn left, and less than once around it.
function isFan(points: readonly Point2[]): boolean {
  let turned = 0;
  for (let i = 2; i < points.length; i++) {
    const [last, next] = [points[i - 1]!, points[i]!];
    const cross = last[0] * next[1] - last[1] * next[0];
    if (!(cross > flat * Math.hypot(...last) * Math.hypot(...next))) return false;
    turned += Math.atan2(cross, last[0] * next[0] + last[1] * next[1]);
  }
  return turned < 2 * Math.PI;
}

// Ears are cut off one after the other, the best-shaped first; undefined when none is left.
function ears(points: readonly Point2[]): [number, number, number][] | undefined {
  const corners = points.map((_, i) => i);
  const before = (i: number): number => (i === 0 ? corners.length - 1 : i - 1);
  const after = (i: number): number => (i + 1 === corners.length ? 0 : i + 1);
  const same = (a: Point2, b: Point2): boolean => a[0] === b[0] && a[1] === b[1];
  // How good a triangle the ear at this corner would be; 0 when there is no ear.
  const shapeOf = (i: number): number => {
    const a = points[corners[before(i)]!]!;
    const b = points[corners[i]!]!;
    const c = points[corners[after(i)]!]!;
    const cross = twiceArea(a, b, c);
    const [ab, bc, ca] = [distance(a, b), distance(b, c), distance(c, a)];
    if (!(cross > flat * ab * bc)) return 0;
    for (const corner of corners) {
      const p = points[corner]!;
      // Polygons reach a hole by an edge that they follow twice: its ends are no obstacle.
      if (same(p, a) || same(p, b) || same(p, c)) continue;
      const inside =
        twiceArea(a, b, p) > -flat * ab &&
        twiceArea(b, c, p) > -flat * bc &&
        twiceArea(c, a, p) > -flat * ca;
      if (inside) return 0;
    }
    return cross / (ab * ab + bc * bc + ca * ca);
  };
  let shapes = corners.map((_, i) => shapeOf(i));
  const triangles: [number, number, number][] = [];
  for (let searches = 1; corners.length > 3; ) {
    let best = 0;
    for (let i = 1; i < shapes.length; i++) if (shapes[i]! > shapes[best]!) best = i;
    if (shapes[best]! <= 0) {
      if (++searches > mostSearches) return undefined;
      shapes = corners.map((_, i) => shapeOf(i));
      if (!shapes.some((shape) => shape > 0)) return undefined;
      continue;
    }
    triangles.push([corners[before(best)]!, corners[best]!, corners[after(best)]!]);
    corners.splice(best, 1);
    shapes.splice(best, 1);
    const next = best === corners.length ? 0 : best;
    shapes[before(next)] = shapeOf(before(next));
    shapes[next] = shapeOf(next);
  }
  triangles.push([corners[0]!, corners[1]!, corners[2]!]);
  return triangles;
}

/** Says the #corners − 2 triangles of a face, in its direction. */
export function cutPolygon(
  vertices: Float64Array,
  corners: ArrayLike<number>,
  triangle: (a: number, b: number, c: number) => void,
): PolygonCut {
  const fan = (): void => {
    for (let i = 2; i < corners.length; i++) triangle(corners[0]!, corners[i - 1]!, corners[i]!);
  };
  if (corners.length === 3) {
    fan();
    return "fan";
  }
  const points = flattened(vertices, corners);
  if (points && isFan(points)) {
    fan();
    return "fan";
  }
  if (points && corners.length > maxConcaveCorners) return "too_long";
  const cut = points && ears(points);
  if (!cut) {
    fan();
    return "unclear";
  }
  for (const [a, b, c] of cut) triangle(corners[a]!, corners[b]!, corners[c]!);
  return "ears";
}
