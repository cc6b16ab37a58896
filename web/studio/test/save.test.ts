// The files that are taken home.
import assert from "node:assert/strict";
import { test } from "node:test";

import { validateBytes } from "gltf-validator";

import { emptyPuppet, newPin } from "../src/model/puppet.js";
import type { Body, Pin } from "../src/model/puppet.js";
import { frameOf } from "../src/model/take.js";
import type { Take } from "../src/model/take.js";
import { animatedSvg } from "../src/save/film.js";
import { glbOf } from "../src/save/gltf.js";
import { longestBorder, spineOf } from "../src/save/spine.js";
import { commandOf, objOf, trackOf } from "../src/save/track.js";
import { crc32, textBytes, zip } from "../src/save/zip.js";

// A fan around a vertex in the middle.
const body: Body = {
  picture: Float64Array.of(5, 5, 0, 0, 10, 0, 10, 10, 0, 10),
  rest: Float64Array.of(5, 5, 0, 0, 10, 0, 10, 10, 0, 10),
  triangles: Uint32Array.of(1, 2, 0, 2, 3, 0, 3, 4, 0, 4, 1, 0),
};
const shapes = [0, 1, 2].map((t) => body.rest.map((value, i) => value + (i % 2 === 0 ? t : 0)));
const png = Uint8Array.of(0x89, 0x50, 0x4e, 0x47, 1);

test("crc and zip are as everybody computes them", () => {
  assert.equal(crc32(textBytes("123456789")), 0xcbf43926);
  const entries = [
    { name: "a.txt", bytes: textBytes("alpha") },
    { name: "ü/b", bytes: textBytes("") },
  ];
  const bytes = zip(entries);
  assert.deepEqual(bytes, zip(entries));
  const view = new DataView(bytes.buffer);
  const end = bytes.length - 22;
  assert.equal(view.getUint32(end, true), 0x06054b50);
  assert.equal(view.getUint16(end + 10, true), 2);
  let at = view.getUint32(end + 16, true);
  for (const { name, bytes: content } of entries) {
    assert.equal(view.getUint32(at, true), 0x02014b50);
    assert.equal(view.getUint32(at + 16, true), crc32(content));
    assert.equal(view.getUint32(at + 24, true), content.length);
    const local = view.getUint32(at + 42, true);
    assert.equal(view.getUint32(local, true), 0x04034b50);
    const length = view.getUint16(at + 28, true);
    assert.equal(new TextDecoder().decode(bytes.subarray(at + 46, at + 46 + length)), name);
    const start = local + 30 + length;
    assert.deepEqual(bytes.slice(start, start + content.length), content);
    at += 46 + length;
  }
  assert.equal(at, end);
});

function take(change: Partial<Pin> = {}): Take {
  const pin = { ...newPin([], { triangle: 1, weights: [0.5, 0.25, 0.25] }, 1, 2), ...change };
  const pins = [pin];
  const frames = [0, 1].map((t) => frameOf([{ ...pin, x: t + 0.1, angle: t }]));
  const { motion } = emptyPuppet(0);
  return {
    rate: 30,
    body,
    starch: null,
    motion,
    pins,
    frames,
    first: 0,
    end: 2,
    smooth: 0,
    loop: 0,
  };
}

test("a track says what the pins are, and the numbers come back exactly", () => {
  const firm = JSON.parse(trackOf(take(), take().frames, "p.obj"));
  assert.deepEqual(firm.handles, [
    { name: "pin-1", rest: [8.75, 3.75], triangle: 1, bary: [0.5, 0.25, 0.25] },
  ]);
  assert.deepEqual(firm.frames[1], { kind: "take", targets: [[1.1, 2]] });
  const rich = take({ firmness: "soft", weight: 0.3, turns: true, area: 4, depth: -2 });
  const soft = JSON.parse(
    trackOf({ ...rich, starch: Float32Array.of(1, 2, 1, 1) }, rich.frames, "p.obj"),
  );
  const { weight, oriented, area_radius: radius, depth } = soft.handles[0];
  assert.deepEqual([weight, oriented, radius, depth], [0.3, true, 4, -2]);
  assert.deepEqual([soft.frames[1].angles, soft.frames[1].scales], [[1], [1]]);
  assert.deepEqual(soft.rigidity, [1, 2, 1, 1]);
  assert.equal(JSON.parse(trackOf(take({ firmness: "exact" }), [], "p.obj")).handles[0].hard, true);
});

test("the OBJ has the rest, the places on the picture and the triangles", () => {
  const lines = objOf(body, 20, 10).split("\n");
  assert.equal(lines[0], "v 5 5 0");
  assert.equal(lines[5], "vt 0.25 0.5");
  assert.equal(lines[10], "f 2/2 3/3 1/1");
  assert.equal(lines.length, 5 + 5 + 4 + 1);
});

test("the command names what is not the default", () => {
  assert.equal(commandOf(take(), "p"), "arapctl bake p.obj p.track.json --out p.csv --spawn");
  const motion = {
    basis: "edge_as_published",
    weights: "cotangent",
    mode: "similarity",
    refine: 3,
  } as const;
  assert.match(
    commandOf({ ...take(), motion }, "p"),
    /--basis edge-as-published --weights cotangent --mode similarity --refine 3$/,
  );
});

test("the GLB has a target and a weight per key, and accessors that fit their bytes", async () => {
  const bytes = glbOf({ name: "p", body, shapes, rate: 15, order: [], png, width: 10, height: 10 });
  const view = new DataView(bytes.buffer);
  const report = await validateBytes(bytes);
  assert.deepEqual(
    [report.issues.numErrors, report.issues.numWarnings],
    [0, 1],
    JSON.stringify(report.issues),
  );
  assert.equal(view.getUint32(0, true), 0x46546c67);
  assert.equal(view.getUint32(8, true), bytes.length);
  const jsonLength = view.getUint32(12, true);
  const document = JSON.parse(new TextDecoder().decode(bytes.subarray(20, 20 + jsonLength)));
  const binary = bytes.subarray(20 + jsonLength + 8);
  assert.equal(document.buffers[0].byteLength, binary.length);
  const size = { SCALAR: 1, VEC2: 2, VEC3: 3 } as Record<string, number>;
  const read = (index: number): Float32Array => {
    const { bufferView, count, type } = document.accessors[index];
    const { byteOffset, byteLength } = document.bufferViews[bufferView];
    assert.equal(byteOffset % 4, 0);
    assert.equal(byteLength, 4 * count * size[type]);
    return new Float32Array(binary.slice(byteOffset, byteOffset + byteLength).buffer);
  };
  document.accessors.forEach((_: unknown, i: number) => read(i));
  const [primitive] = document.meshes[0].primitives;
  assert.equal(primitive.targets.length, 3);
  const target = read(primitive.targets[2].POSITION);
  assert.ok(Math.abs(target[0] - 0.2) < 1e-7 && target[1] === 0);
  const [sampler] = document.animations[0].samplers;
  assert.deepEqual([...read(sampler.output)], [1, 0, 0, 0, 1, 0, 0, 0, 1]);
  assert.ok(document.accessors[sampler.input].max[0] > 0.13);
  const texels = read(primitive.attributes.TEXCOORD_0);
  assert.deepEqual([texels[2], texels[3]], [0, 1]);
});

test("Spine has its hull first, and keys that lead to the shapes", () => {
  assert.deepEqual([...longestBorder(body.triangles)].sort(), [1, 2, 3, 4]);
  const input = { name: "p", body, shapes, rate: 15, order: [], width: 10, height: 10 };
  const document = JSON.parse(spineOf(input));
  const mesh = document.skins[0].attachments.p.p;
  assert.equal(mesh.hull, 4);
  assert.equal(mesh.uvs.length, 10);
  assert.deepEqual(mesh.vertices.slice(8), [0, 5]); // the middle comes last
  assert.ok(mesh.triangles.every((vertex: number) => vertex < 5));
  const { deform } = document.animations.take.attachments.default.p.p;
  assert.deepEqual(deform[2].vertices, [2, 0, 2, 0, 2, 0, 2, 0, 2, 0]);
  assert.equal(deform[1].time, 0.0667);
});

test("an animated SVG shows every picture for its time", () => {
  const svg = animatedSvg(["data:a", "data:b"], 20, 10, 15, "A <b> & c");
  assert.match(svg, /viewBox="0 0 20 10"/);
  assert.equal(svg.match(/<image /g)?.length, 2);
  assert.match(svg, /animation:show 0\.1333s/);
  assert.match(svg, /50\.0000%\{visibility:hidden\}/);
  assert.match(svg, /<title>A b> {2}c<\/title>/);
  assert.ok(!animatedSvg(["data:a"], 2, 1, 15, "").includes("hidden"));
});
