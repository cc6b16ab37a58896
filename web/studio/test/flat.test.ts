// The model of the flatten page: edges, seams, strain, layouts, samples.
import assert from "node:assert/strict";
import { test } from "node:test";

import { flatOf, layoutOf, namesOf } from "../src/flat/layout.js";
import type { Answer } from "../src/flat/net.js";
import { emptyPattern, isUnlikely, requestOf, sameLayout, withPin } from "../src/flat/pattern.js";
import { samples } from "../src/flat/samples.js";
import { Bins } from "../src/flat/bins.js";
import { Sight } from "../src/flat/sight.js";
import { loopThrough, runsOf, shortestPath, toggled } from "../src/flat/seams.js";
import { colourOf, rangeOf, shadeOf, shades, strainOf } from "../src/flat/strain.js";
import {
  edgesOf,
  hitBeside,
  isBorder,
  isOnBorder,
  nearestEdge,
  nearestVertex,
  normalsOf,
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
  const all = [...Array(surface.triangles.length / 3).keys()];
  const seen = (corner: number): [number, number, number] => {
    const vertex = surface.triangles[corner];
    const [x, y] = surface.vertices.subarray(3 * vertex);
    return [100 * x, 100 * y, vertex === 8 ? 0.5 : 0.9];
  };
  const hit = hitBeside(all, seen, -8, 3)!;
  assert.equal(nearestVertex(surface, hit), 0);
  assert.equal(hitBeside(all, seen, -20, 0), null);
  const folded = (corner: number): [number, number, number] =>
    surface.triangles[corner] === 8 ? [2, 0, 0.5] : seen(corner);
  assert.equal(nearestVertex(surface, hitBeside(all, folded, -3, 0)!), 8);
});

test("normals are of length 1, and large triangles count for more", () => {
  assert.deepEqual([...normalsOf(sheet(1))], [0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1]);
  // Two triangles at the first corner, one of them ten times as large, and a corner of none.
  const bent = sheet(1, {
    vertices: Float64Array.of(0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 10, 9, 9, 9),
    triangles: Uint32Array.of(0, 1, 2, 0, 2, 3),
  });
  const [x, y, z] = normalsOf(bent);
  assert.ok(Math.abs(x - 10 * z) < 1e-6 && y === 0 && Math.abs(Math.hypot(x, y, z) - 1) < 1e-6);
  assert.deepEqual([...normalsOf(bent).slice(12)], [0, 0, 0]);
});

test("a grid finds the triangles at a point, and those near it, as asking all of them does", () => {
  let seed = 7;
  const chance = (): number => (seed = (seed * 48271) % 2147483647) / 2147483647;
  const places = Float64Array.from({ length: 240 }, () => 100 * chance());
  places[5] = NaN;
  const corners = Uint32Array.from({ length: 600 }, () => Math.floor(120 * chance()));
  const bins = new Bins(corners, places);
  const alone = Array.from(
    { length: 200 },
    (_, t) => new Bins(corners.subarray(3 * t, 3 * t + 3), places),
  );
  let most = 0;
  for (let i = 0; i < 200; ++i) {
    const [x, y] = [110 * chance() - 5, 110 * chance() - 5];
    const hits = bins.at(x, y);
    most = Math.max(most, hits.length);
    assert.deepEqual(
      hits.map(({ triangle }) => triangle),
      [...Array(200).keys()].filter((t) => alone[t].at(x, y).length > 0),
    );
    for (const { triangle, weights } of hits) {
      const at = (axis: number): number =>
        weights.reduce(
          (sum, one, k) => sum + one * places[2 * corners[3 * triangle + k] + axis],
          0,
        );
      assert.ok(Math.abs(at(0) - x) < 1e-6 && Math.abs(at(1) - y) < 1e-6);
    }
    const near = new Set(bins.near(x, y, 9));
    corners.forEach((corner, k) => {
      const usable = [0, 1, 2].every((j) => corners[3 * Math.floor(k / 3) + j] !== 2);
      const far = Math.hypot(places[2 * corner] - x, places[2 * corner + 1] - y);
      assert.ok(!usable || far > 9 || near.has(Math.floor(k / 3)));
    });
  }
  assert.ok(most > 3);
  for (const nothing of [new Bins([], []), new Bins([0, 0, 0], [1, 1])])
    assert.deepEqual(nothing.at(1, 1), []);
  assert.deepEqual(new Bins([0, 0, 0], [1, 1]).near(1, 1, 1), [0]);
});

test("of two sheets the one in front is seen, with weights as they are in space", () => {
  // Looking down z from 10: x and y over 10 - z; the second sheet is nearer.
  const two = sheet(1, {
    vertices: Float64Array.of(-4, -4, 0, 4, -4, 0, 0, 8, 0, -4, -4, 2, 4, -4, 6, 0, 8, 2),
    triangles: Uint32Array.of(0, 1, 2, 3, 4, 5),
  });
  const away = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, -1, 0, 0, 9.9, 10];
  const sight = new Sight(two, away, 200, 200);
  const hit = sight.at(100, 100)!;
  assert.equal(hit.triangle, 1);
  const at = (axis: number): number =>
    hit.weights.reduce((sum, one, k) => sum + one * two.vertices[3 * (3 + k) + axis], 0);
  assert.ok(Math.abs(at(0)) < 1e-9 && Math.abs(at(1)) < 1e-9);
  assert.equal(sight.at(2, 2), null);
  assert.equal(sight.beside(2, 2), null);
  const corner = sight.beside(205, 205)!;
  assert.equal(nearestVertex(two, corner), 4);
  // From within, what is behind the eye is not seen.
  const inside = new Sight(two, [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, -1, 0, 0, 0.9, 1], 200, 200);
  assert.equal(inside.at(100, 100)?.triangle, 0);
});

test("paths are the shortest, lines go on straight to the border", () => {
  const surface = sheet(6);
  const edges = edgesOf(surface, false);
  const path = shortestPath(surface, edges, 0, 48);
  assert.equal(path.length, 6); // along the diagonals
  const length = path.reduce((sum, edge) => sum + edges.lengths[edge], 0);
  assert.ok(Math.abs(length - 6 * Math.SQRT2) < 1e-12);
  assert.deepEqual(shortestPath(surface, edges, 5, 5), []);
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
  assert.deepEqual(shortestPath(two, edgesOf(two, false), 0, 4), []);
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

test("pieces have the names of what most of them is from, and numbers where a name is not theirs alone", () => {
  const parts = [
    { firstTriangle: 1, name: "front" },
    { firstTriangle: 3, name: "back" },
    { firstTriangle: 6 },
    { firstTriangle: 7, name: "back 1" },
  ];
  const pieceOf = [0, 0, 0, 1, 1, 2, 3, 4];
  assert.deepEqual(namesOf(pieceOf, 5, parts), ["front", "back 2", "back 3", "", "back 1"]);
  assert.deepEqual(namesOf([0, 1], 2, []), ["", ""]);
  assert.deepEqual(namesOf([0, 1, 1], 2, [{ firstTriangle: 0, name: "a" }]), ["a 1", "a 2"]);
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
