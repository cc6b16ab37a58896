// Files: what the readers make of them, compared with arapctl where that is there.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";

import { readSurface } from "#gateway/files/format.js";
import type { Surface } from "#gateway/files/surface.js";

import { ask, form, json, onStage, problem } from "./support/gateway.js";
import { glb, plyBytes, stlBytes } from "./support/files.js";
import type { Glb } from "./support/files.js";

const limits = { vertices: 1000, triangles: 1000 };
const read = (content: string | Uint8Array, name = ""): Promise<Surface> =>
  readSurface(Buffer.from(content as string), name, limits);

const square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
const facet = (...corners: string[]): string =>
  `facet normal 0 0 1\n outer loop\n${corners.map((corner) => `  vertex ${corner}\n`).join("")} endloop\nendfacet\n`;
const ply = (head: string, body: string): string =>
  `ply\nformat ascii 1.0\n${head}end_header\n${body}`;
const triangle: Glb = { positions: [0, 0, 0, 1, 0, 0, 0, 1, 0], indices: [0, 1, 2] };

interface Good {
  content: string | Uint8Array;
  name?: string;
  vertices?: number[];
  triangles: number[];
  parts?: Surface["parts"];
  warnings?: string[];
}
const good: Record<string, Good> = {
  "OBJ: a quad becomes a fan": { content: `${square}f 1 2 3 4\n`, triangles: [0, 1, 2, 0, 2, 3] },
  "OBJ: a concave face becomes ears": {
    content: "v 0 0\nv 4 0\nv 4 4\nv 2 1\nv 0 4\nf 1 2 3 4 5\n",
    vertices: [0, 0, 0, 4, 0, 0, 4, 4, 0, 2, 1, 0, 0, 4, 0],
    triangles: [1, 2, 3, 3, 4, 0, 0, 1, 3],
  },
  "OBJ: a face that crosses itself is doubted": {
    content: "v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 1 0\nf 1 2 3 4\n",
    triangles: [0, 1, 2, 0, 2, 3],
    warnings: ["unclear_polygons"],
  },
  "OBJ: every form of a corner, any line end, joined lines, comments": {
    content: `\ufeff# a\r\n${square.replaceAll("\n", "\r")}vt 0 0\nvn 0 0 1\nf 1/1/1 2//1 \\\n3/1 # b\nf -4 -2 -1\n`,
    triangles: [0, 1, 2, 0, 2, 3],
  },
  "OBJ: faces before their vertices": { content: `f 1 2 3\n${square}`, triangles: [0, 1, 2] },
  "OBJ: objects name the parts where there are several": {
    content: `${square}o a\ng x\nf 1 2 3\no b\ng x\nf 1 3 4\n`,
    triangles: [0, 1, 2, 0, 2, 3],
    parts: [
      { firstTriangle: 0, name: "a" },
      { firstTriangle: 1, name: "b" },
    ],
  },
  "OBJ: else groups": {
    content: `${square}o a\ng front side\nf 1 2 3\ng back\nf 1 3 4\n`,
    triangles: [0, 1, 2, 0, 2, 3],
    parts: [
      { firstTriangle: 0, name: "front side" },
      { firstTriangle: 1, name: "back" },
    ],
  },
  "OBJ: what is not known is counted": {
    content: `${square}frob 1\nfrob 2\nv 0 0 0 2\nf 1 2 3\n`,
    triangles: [0, 1, 2],
    warnings: ["unknown_statements", "vertex_weights"],
  },
  "STL as text: corners are joined": {
    content: `solid sail\n${facet("0 0 0", "1 0 0", "1 1 0")}${facet("0 0 0", "1 1 0", "-0 1 0")}${facet("0 0 0", "0 0 0", "1 1 0")}endsolid sail\n`,
    vertices: [0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0],
    triangles: [0, 1, 2, 0, 2, 3],
    parts: [{ firstTriangle: 0, name: "sail" }],
    warnings: ["empty_triangles", "joined_corners"],
  },
  "STL in binary, though it begins with solid": {
    content: stlBytes([0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1, 1, 0, 0, 1, 0], "solid of all"),
    vertices: [0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0],
    triangles: [0, 1, 2, 0, 2, 3],
    warnings: ["joined_corners"],
  },
  "PLY as text": {
    content: ply(
      "comment c\nelement vertex 4\nproperty double x\nproperty uchar red\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar uint vertex_index\nelement edge 1\nproperty int a\n",
      "0 9 0 0\n1 9 0 0\n1 9 1 0\n\n0 9 1 0\n4 0 1 2 3\n7\n",
    ),
    triangles: [0, 1, 2, 0, 2, 3],
    warnings: ["unknown_properties"],
  },
  "PLY, little end first": {
    content: plyBytes(true),
    triangles: [0, 1, 2, 0, 2, 3],
    vertices: [0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0],
  },
  "PLY, big end first": {
    content: plyBytes(false),
    triangles: [0, 1, 2, 0, 2, 3],
    vertices: [0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0],
  },
  GLB: { content: glb(triangle), triangles: [0, 1, 2], vertices: triangle.positions },
  "GLB: nodes put meshes where they are": {
    content: glb({
      ...triangle,
      nodes: [
        { name: "root", children: [1, 2], translation: [10, 0, 0] },
        { name: "left", mesh: 0, scale: [2, 2, 2] },
        { name: "right", mesh: 0, translation: [0, 5, 0] },
      ],
    }),
    vertices: [10, 0, 0, 12, 0, 0, 10, 2, 0, 10, 5, 0, 11, 5, 0, 10, 6, 0],
    triangles: [0, 1, 2, 3, 4, 5],
    parts: [
      { firstTriangle: 0, name: "left" },
      { firstTriangle: 1, name: "right" },
    ],
  },
  "GLB without indices": { content: glb({ positions: triangle.positions }), triangles: [0, 1, 2] },
};

for (const [what, { content, name, vertices, triangles, parts, warnings }] of Object.entries(
  good,
)) {
  test(what, async () => {
    const surface = await read(content, name);
    assert.equal(surface.format, what.slice(0, 3).toLowerCase());
    if (vertices)
      assert.deepEqual(
        Array.from(surface.vertices, (x) => x + 0),
        vertices,
      );
    assert.deepEqual(Array.from(surface.triangles), triangles);
    assert.deepEqual(surface.parts, parts ?? []);
    assert.deepEqual(surface.warnings.map(({ kind }) => kind).sort(), warnings ?? []);
  });
}

const bowl = (): string => {
  const lines = ["o bowl"];
  for (let y = 0; y < 5; y++)
    for (let x = 0; x < 5; x++) lines.push(`v ${x} ${y} ${(x * x + y * y) / 20}`);
  for (let y = 0; y < 4; y++) {
    for (let x = 0; x < 4; x++) {
      const v = 5 * y + x + 1;
      if (y === 1 && x === 1) continue;
      lines.push(`f ${v} ${v + 1} ${v + 6} ${v + 5}`);
    }
  }
  lines.push(
    "o lid",
    "v 9 0 0",
    "v 13 0 0",
    "v 13 4 0.5",
    "v 11 1 0.2",
    "v 9 4 0",
    "f 26 27 28 29 30",
  );
  return `${lines.join("\n")}\n`;
};

test(
  "drawings of a file are those of arapctl, byte for byte",
  { timeout: 120_000, skip: process.env["ARAPCTL"] ? false : "there is no arapctl" },
  () =>
    onStage(async ({ url, server }) => {
      const folder = mkdtempSync(join(tmpdir(), "arapd-gateway-"));
      try {
        const file = (name: string): string => join(folder, name);
        const stl = stlBytes([0, 0, 0, 2, 0, 0, 2, 1, 0.5, 0, 0, 0, 2, 1, 0.5, 0, 1, 0]);
        for (const [name, content] of [
          ["a.obj", bowl()],
          ["a.stl", stl],
          ["a.ply", plyBytes(false)],
          ["a.glb", glb(triangle)],
        ] as const) {
          writeFileSync(file(name), content);
          execFileSync(
            process.env["ARAPCTL"]!,
            [
              "flatten",
              file(name),
              "--out",
              file("uv.obj"),
              "--svg",
              file("a.svg"),
              "--dxf",
              file("a.dxf"),
              "--unit",
              "cm",
              "--server",
              server.address,
            ],
            { stdio: "pipe" },
          );
          for (const [ending, accept] of [
            ["svg", "image/svg+xml"],
            ["dxf", "image/vnd.dxf"],
          ] as const) {
            const drawings = [{ format: ending, millimetresPerUnit: 10 }];
            const answer = await ask(`${url}/v1/flatten`, {
              body: form(name, content, { drawings }),
              headers: { accept },
            });
            assert.equal(answer.status, 200);
            assert.equal(
              await answer.text(),
              readFileSync(file(`a.${ending}`), "utf8"),
              `${name} as ${ending}`,
            );
          }
        }
      } finally {
        rmSync(folder, { recursive: true, force: true });
      }
    }),
);

test("large files are read in a thread, whose end ends with who waits", { timeout: 120_000 }, () =>
  onStage(
    async ({ url }) => {
      const side = 150;
      const lines: string[] = [];
      for (let i = 0; i < side * side; i++)
        lines.push(`v ${i % side} ${Math.floor(i / side)} 0.25`);
      for (let i = 0; i + side < side * side; i++)
        if ((i + 1) % side) lines.push(`f ${i + 1} ${i + 2} ${i + side + 2} ${i + side + 1}`);
      const text = `${lines.join("\n")}\n`;
      assert.ok(text.length > 600_000);
      const surface = await json(`${url}/v1/surfaces`, { body: form("a.obj", text) });
      assert.equal(surface.mesh.vertices.length, 3 * side * side);
      assert.equal(surface.mesh.triangles.length, 6 * (side - 1) ** 2);
      const told = await problem(
        `${url}/v1/surfaces`,
        { body: form("a.obj", `${text}f 1 2 x\n`) },
        "FILE",
      );
      assert.match(told.detail, new RegExp(`^line ${lines.length + 1}: 'x'`));
      const stop = new AbortController();
      const left = ask(`${url}/v1/surfaces`, { body: form("a.obj", text), signal: stop.signal });
      stop.abort();
      await assert.rejects(left);
      // One at a time, and none is lost.
      const all = await Promise.all(
        Array.from({ length: 5 }, () => json(`${url}/v1/surfaces`, { body: form("a.obj", text) })),
      );
      assert.ok(all.every(({ mesh }) => mesh.vertices.length === 3 * side * side));
    },
    { maxConcurrentUploads: 1 },
  ),
);
