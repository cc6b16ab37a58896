// The model of the flatten page: edges, seams, strain, layouts, samples.
import assert from "node:assert/strict";
import { test } from "node:test";

import { flatOf, layoutOf } from "../src/flat/layout.js";
import type { Answer } from "../src/flat/net.js";
import { emptyPattern, isUnlikely, requestOf, sameLayout, withPin } from "../src/flat/pattern.js";
import { samples } from "../src/flat/samples.js";
import { loopThrough, runsOf, shortestPath, toggled } from "../src/flat/seams.js";
import { colourOf, rangeOf, shadeOf, shades, strainOf } from "../src/flat/strain.js";
import {
  edgesOf,
  hitBeside,
  isBorder,
  isOnBorder,
  nearestEdge,
  nearestVertex,
} from "../src/flat/surface.js";
import type { Edges, Surface } from "../src/flat/surface.js";

/** A flat grid of n × n squares, each cut by the same diagonal. */
function sheet(n: number, more: Partial<Surface> = {}): Surface {
  const vertices: number[] = [];
  for (let y = 0; y <= n; ++y) for (let x = 0; x <= n; ++x) vertices.push(x, y, 0);
  const triangles: number[] = [];
  for (let y = 0; y < n; ++y) {
    for (let x = 0; x < n; ++x) {
      const a = y * (n + 1) + x;
      triangles.push(a, a + 1, a + n + 2, a, a + n + 2, a + n + 1);
    }
  }
  return {
    name: "sheet",
    vertices: Float64Array.from(vertices),
    triangles: Uint32Array.from(triangles),
    parts: [],
    file: null,
    format: null,
    warnings: [],
    ...more,
  };
}
const between = (edges: Edges, p: number, q: number): number => {
  for (let edge = 0; edge < edges.count; ++edge) {
    const [a, b] = [edges.ends[2 * edge], edges.ends[2 * edge + 1]];
    if ((a === p && b === q) || (a === q && b === p)) return edge;
  }
  return -1;
};

test("edges are counted once, know their sides and lengths, and join twins where asked", () => {
  const surface = sheet(4);
  const edges = edgesOf(surface, false);
  assert.equal(edges.count, 25 + 32 - 1); // Euler: V - E + F = 1
  assert.equal([...edges.sides].filter((sides) => sides === 1).length, 16);
  assert.equal(edges.lengths[between(edges, 0, 6)], Math.SQRT2);
  assert.ok(isOnBorder(edges, 3) && !isOnBorder(edges, 6));
  // Two triangles that meet in an edge whose ends are there twice.
  const twins = sheet(1, {
    vertices: Float64Array.of(0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1, 1, 0, 0, 1, 0),
    triangles: Uint32Array.of(0, 1, 2, 3, 4, 5),
  });
  assert.equal(edgesOf(twins, false).count, 6);
  const joined = edgesOf(twins, true);
  assert.equal(joined.count, 5);
  assert.deepEqual([...joined.pointOf], [0, 1, 2, 0, 2, 5]);
  assert.equal([...joined.sides].filter((sides) => sides === 2).length, 1);
});

test("a hit has a nearest corner and a nearest edge", () => {
  const surface = sheet(2);
  const edges = edgesOf(surface, false);
  assert.equal(nearestVertex(surface, { triangle: 0, weights: [0.2, 0.7, 0.1] }), 1);
  // Just above the lower edge of the first triangle.
  const low = nearestEdge(edges, { triangle: 0, weights: [0.5, 0.45, 0.05] });
  assert.equal(low, between(edges, 0, 1));
});

test("a click beside the surface means the corner that is near, and of two the one in front", () => {
  const surface = sheet(2);
  const seen = (vertex: number): [number, number, number] => [
    100 * surface.vertices[3 * vertex],
    100 * surface.vertices[3 * vertex + 1],
    vertex === 8 ? 0.5 : 0.9,
  ];
  const hit = hitBeside(surface, seen, -8, 3)!;
  assert.equal(nearestVertex(surface, hit), 0);
  assert.equal(hitBeside(surface, seen, -20, 0), null);
  const folded = (vertex: number): [number, number, number] =>
    vertex === 8 ? [2, 0, 0.5] : seen(vertex);
  assert.equal(nearestVertex(surface, hitBeside(surface, folded, -3, 0)!), 8);
});

test("paths are the shortest, lines go on straight to the border", () => {
  const surface = sheet(6);
  const edges = edgesOf(surface, false);
  const path = shortestPath(edges, 0, 48);
  assert.equal(path.length, 6); // along the diagonals
  const length = path.reduce((sum, edge) => sum + edges.lengths[edge], 0);
  assert.ok(Math.abs(length - 6 * Math.SQRT2) < 1e-12);
  assert.deepEqual(shortestPath(edges, 5, 5), []);
  const line = loopThrough(surface, edges, between(edges, 17, 24));
  assert.equal(line.length, 6);
  for (const edge of line) assert.equal(edges.ends[2 * edge] % 7, 3);
  assert.deepEqual(loopThrough(surface, edges, between(edges, 0, 1)), [], "of the border");
});

test("there is no path between pieces, and a line around a tube closes", () => {
  const two = sheet(1, {
    vertices: Float64Array.of(0, 0, 0, 1, 0, 0, 0, 1, 0, 5, 0, 0, 6, 0, 0, 5, 1, 0),
    triangles: Uint32Array.of(0, 1, 2, 3, 4, 5),
  });
  assert.deepEqual(shortestPath(edgesOf(two, false), 0, 4), []);
  const tube = samples[0].make();
  const edges = edgesOf(tube, false);
  const [a, b] = [17 * 40 + 3, 17 * 40 + 4];
  const ring = loopThrough(tube, edges, between(edges, a, b));
  assert.equal(ring.length, 40);
  assert.equal(new Set(ring).size, 40);
});

test("seams are put in and taken out, and listed as runs", () => {
  assert.deepEqual(toggled([3, 5], [4]), [3, 4, 5]);
  assert.deepEqual(toggled([3, 5], [5, 3]), []);
  assert.deepEqual(toggled([3], [3, 1]), [1, 3]);
  const surface = sheet(6);
  const edges = edgesOf(surface, false);
  const seams = [between(edges, 8, 9), between(edges, 9, 10), between(edges, 31, 32)];
  const runs = runsOf(edges, seams);
  assert.deepEqual(
    runs.map(({ edges: run, length }) => [run.length, length]),
    [
      [2, 2],
      [1, 1],
    ],
  );
});

test("strain is the larger principal one, its range a round number, its colours those of the drawings", () => {
  assert.ok(Math.abs(strainOf(1.1, 0.95) - 10) < 1e-9);
  assert.ok(Math.abs(strainOf(1.02, 0.9) + 10) < 1e-9);
  assert.equal(rangeOf([Float64Array.of(0, 0)]), 0.1);
  const many = Float64Array.from({ length: 1000 }, (_, i) => (i < 5 ? 300 : 1.3));
  assert.equal(rangeOf([many]), 2, "a few spikes leave the colours to the rest");
  assert.deepEqual(colourOf(0), [250, 250, 250]);
  assert.deepEqual(colourOf(shades), [178, 24, 43]);
  assert.deepEqual(colourOf(-shades), [33, 102, 172]);
  assert.equal(shadeOf(-99, 2), -shades);
  assert.equal(shadeOf(1, 2), shades / 2);
});

test("what is asked of the gateway, and when it is asked anew", () => {
  const surface = sheet(2);
  const edges = edgesOf(surface, false);
  const seam = between(edges, 1, 4);
  const pattern = { ...emptyPattern, surface, seams: [seam] };
  const request = requestOf(withPin(pattern, { vertex: 3, u: 1, v: 2 }), edges, "lscm", "key");
  assert.equal(request["method"], "lscm");
  assert.deepEqual((request["seamEdges"] as number[]).sort(), [1, 4]);
  assert.deepEqual(request["pins"], [{ vertex: 3, u: 1, v: 2 }]);
  assert.equal("repair" in request, false);
  assert.ok(sameLayout(pattern, { ...pattern, millimetresPerUnit: 10 }));
  assert.ok(!sameLayout(pattern, { ...pattern, seams: [] }));
  const moved = withPin(withPin(pattern, { vertex: 3, u: 1, v: 2 }), { vertex: 3, u: 0, v: 0 });
  assert.deepEqual(moved.pins, [{ vertex: 3, u: 0, v: 0 }]);
  assert.ok(isUnlikely(4.9) && isUnlikely(10_001) && !isUnlikely(5) && !isUnlikely(0));
});

test("a layout knows its pieces, what is folded over, and which cuts were not asked for", () => {
  const surface = sheet(1);
  const edges = edgesOf(surface, false);
  const distortion = {} as Answer["distortion"];
  const answer: Answer = {
    uv: [0, 0, 2, 0, 2, 1, 0, 1],
    uvVertex: [0, 1, 3, 2],
    cornerUv: [0, 1, 2, 0, 3, 2],
    singularValues: [2, 1, 1, 1],
    distortion,
    warnings: [],
    charts: [{ loops: [], triangleCount: 2, distortion }],
    triangleChart: [0, 0],
    cutEdges: [0, 1, 0, 3],
    autoCutCount: 1,
    boundaryOverlaps: false,
    drawings: [],
  };
  const layout = layoutOf(answer, "lscm", surface, edges);
  assert.deepEqual([layout.pieces[0].width, layout.pieces[0].height], [2, 1]);
  assert.deepEqual([layout.pieces[0].area, layout.pieces[0].areaOnSurface], [2, 1]);
  assert.deepEqual([...layout.strain], [100, 0]);
  assert.deepEqual([...layout.flipped], [1]);
  assert.deepEqual(layout.autoCuts, [between(edges, 0, 3)]);
  assert.deepEqual(flatOf(layout, 1), [2, 0]);
});

test("the samples are sound: no triangle without area, every edge with one or two sides", () => {
  const borders = [2, 1, 1];
  samples.forEach((sample, i) => {
    const surface = sample.make();
    const edges = edgesOf(surface, true);
    const points = surface.vertices.length / 3;
    assert.equal(new Set(edges.pointOf).size, points, `${sample.name} has twins`);
    assert.ok(edges.sides.every((sides) => sides === 1 || sides === 2));
    assert.ok(surface.vertices.every(Number.isFinite));
    assert.ok(edges.lengths.every((length) => length * sample.millimetresPerUnit > 1));
    const border = Array.from({ length: edges.count }, (_, edge) => edge).filter((edge) =>
      isBorder(edges, edge),
    );
    assert.equal(runsOf(edges, border).length, borders[i], `${sample.name}: borders`);
  });
});
