// Files that cannot be read: what is said of them, with the line, the element or the byte.
import assert from "node:assert/strict";
import { test } from "node:test";

import { readSurface } from "#gateway/files/format.js";
import { FileFault } from "#gateway/files/surface.js";

import { glb, plyBytes, stlBytes } from "./support/files.js";
import type { Glb } from "./support/files.js";

const limits = { vertices: 1000, triangles: 1000 };
const square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
const triangle: Glb = { positions: [0, 0, 0, 1, 0, 0, 0, 1, 0], indices: [0, 1, 2] };
const facet = (...corners: string[]): string =>
  `facet normal 0 0 1\n outer loop\n${corners.map((corner) => `  vertex ${corner}\n`).join("")} endloop\nendfacet\n`;
const ply = (head: string, body: string): string =>
  `ply\nformat ascii 1.0\n${head}end_header\n${body}`;
const plyHead =
  "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\n";

const many = Array.from({ length: 1001 }, (_, i) => `v ${i} 0 0\n`).join("");
/** What is wrong, the file, its name, and what has to be said. */
const bad: [string, string | Uint8Array, string, RegExp][] = [
  ["OBJ: a word", `${square}f 1 2 x\n`, "", /^line 5: 'x' is not a whole number/],
  [
    "OBJ: a decimal comma",
    "v 0,5 0 0\n",
    "",
    /^line 1: '0,5' is not a finite number \(decimal comma\?\)/,
  ],
  ["OBJ: infinity", "v 1e999 0 0\n", "", /^line 1: '1e999'/],
  ["OBJ: not a number", "v nan 0 0\n", "", /^line 1: 'nan'/],
  ["OBJ: hexadecimal", "v 0x10 0 0\n", "", /^line 1: '0x10'/],
  ["OBJ: no vertex 0", `${square}f 0 1 2\n`, "", /^line 5: there is no vertex 0/],
  [
    "OBJ: no such vertex",
    `${square}\n# c\nf 1 2 9\n`,
    "",
    /^line 7: the face names vertex 9, but there are 4/,
  ],
  ["OBJ: too far back", `${square}f 1 2 -5\n`, "", /^line 5: there is no vertex -5/],
  ["OBJ: two corners", `${square}f 1 2\n`, "", /^line 5: a face of 2 corners/],
  ["OBJ: one coordinate", "v 1\n", "", /^line 1: a vertex of 1 numbers/],
  ["OBJ: no faces", square, "a.obj", /no faces/],
  ["OBJ: too many vertices", `${many}f 1 2 3\n`, "", /more than 1000 vertices/],
  [
    "OBJ: too many corners",
    `${square}f ${"1 2 3 ".repeat(2000)}\n`,
    "",
    /more than 1000 triangles/,
  ],
  ["no text", new Uint8Array(100), "a.obj", /neither a text nor/],
  ["another ending", "v 0 0 0\n", "a.glb", /called \.glb but does not begin like one/],
  [
    "STL: a word out of place",
    `solid\n${facet("0 0 0", "1 0 0", "1 1 0")}dance\n`,
    "a.stl",
    /^line 9: 'dance': 'facet' or 'endsolid' is wanted/,
  ],
  [
    "STL: it ends early",
    "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0",
    "a.stl",
    /^line 4: the text ends within a solid: a number is wanted/,
  ],
  [
    "STL: no number",
    `solid\n${facet("0 0 x", "1 0 0", "1 1 0")}`,
    "a.stl",
    /^line 4: 'x' is not a finite number/,
  ],
  [
    "STL: a count that is not there",
    stlBytes([0, 0, 0, 1, 0, 0, 1, 1, 0]).subarray(0, 100),
    "a.stl",
    /^byte 80: the header claims 1 triangles, the file has room for 0/,
  ],
  ["STL: infinity", stlBytes([0, 0, 0, Infinity, 0, 0, 1, 1, 0]), "a.stl", /^byte 108: Infinity/],
  ["STL: nothing", "solid\nendsolid\n", "a.stl", /no faces/],
  ["PLY: no header", "ply\nformat ascii 1.0\n", "", /end_header/],
  [
    "PLY: no format",
    `ply\nelement vertex 1\nend_header\n`,
    "",
    /^line 3: the header says no format/,
  ],
  ["PLY: another format", `ply\nformat ascii 2.0\nend_header\n`, "", /^line 2: /],
  [
    "PLY: no x",
    ply(
      "element vertex 1\nproperty float y\nelement face 1\nproperty list uchar int vertex_indices\n",
      "",
    ),
    "",
    /^line 3: the vertices have no x/,
  ],
  [
    "PLY: no corners",
    ply(
      "element vertex 1\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty int a\n",
      "",
    ),
    "",
    /^line 7: the faces have no list/,
  ],
  [
    "PLY: an unknown type",
    ply("element vertex 1\nproperty quad x\n", ""),
    "",
    /^line 4: 'quad' is no type/,
  ],
  [
    "PLY: too few",
    ply(plyHead, "0 0 0\n1 0 0\n"),
    "",
    /the file ends before what the header claims/,
  ],
  [
    "PLY: too many",
    ply(plyHead, "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n9\n"),
    "",
    /^line 14: '9': the file goes on/,
  ],
  ["PLY: a word too many", ply(plyHead, "0 0 0 7\n"), "", /^line 10: '7' is one word too many/],
  [
    "PLY: no such vertex",
    ply(plyHead, "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"),
    "",
    /^line 13: there is no vertex 3, they go from 0 to 2/,
  ],
  [
    "PLY: half a vertex",
    ply(plyHead, "0 0 0\n1 0 0\n0 1 0\n3 0 1 1.5\n"),
    "",
    /^line 13: there is no vertex 1.5/,
  ],
  [
    "PLY: two corners",
    ply(plyHead, "0 0 0\n1 0 0\n0 1 0\n2 0 1\n"),
    "",
    /^line 13: a face of 2 corners/,
  ],
  [
    "PLY: a claim beyond the file",
    ply(plyHead.replace("vertex 3", "vertex 999999999"), "0 0 0\n"),
    "",
    /^line 3: the header claims 999999999 elements 'vertex'/,
  ],
  [
    "PLY: bytes that end early",
    plyBytes(true).subarray(0, -3),
    "",
    /^byte \d+: the file ends before/,
  ],
  [
    "PLY: bytes too many",
    Buffer.concat([plyBytes(true), Buffer.from([1])]),
    "",
    /^byte \d+: the file goes on/,
  ],
  [
    "PLY: strips",
    ply(`${plyHead}element tristrips 1\nproperty list int int vertex_indices\n`, ""),
    "",
    /triangle strips are not read/,
  ],
  ["GLB: cut off", glb(triangle).subarray(0, 40), "", /^byte 8: the header claims/],
  [
    "GLB: version 1",
    Buffer.concat([Buffer.from("glTF"), Buffer.from([1, 0, 0, 0]), Buffer.alloc(20)]),
    "",
    /only version 2/,
  ],
  [
    "GLB: no such vertex",
    glb({ ...triangle, indices: [0, 1, 7] }),
    "",
    /names vertex 7, but there are 3/,
  ],
  ["GLB: half a triangle", glb({ ...triangle, indices: [0, 1] }), "", /2 corners of triangles/],
  [
    "GLB: not finite",
    glb({ ...triangle, positions: [0, 0, 0, 1, 0, 0, 0, NaN, 0] }),
    "",
    /vertex 2 of the mesh .* is not finite/,
  ],
  ["GLB: strips", glb({ ...triangle, mode: 5 }), "", /meshes\[0\] has triangle strips/],
  [
    "GLB: a needed extension",
    glb({
      ...triangle,
      more: {
        extensionsRequired: ["KHR_draco_mesh_compression"],
        extensionsUsed: ["KHR_draco_mesh_compression"],
      },
    }),
    "",
    /'KHR_draco_mesh_compression', which is not read/,
  ],
  [
    "GLB: a buffer elsewhere",
    glb({ ...triangle, more: { buffers: [{ byteLength: 48, uri: "../../etc/passwd" }] } }),
    "",
    /buffers\[0\] is outside of the file/,
  ],
  [
    "GLB: a sparse accessor",
    glb({ ...triangle, accessor: { sparse: {} } }),
    "",
    /accessors\[0\] is sparse/,
  ],
  [
    "GLB: memory from nothing",
    glb({ ...triangle, accessor: { count: 4_000_000_000 } }),
    "",
    /accessors\[0\]: 4000000000 elements do not fit/,
  ],
  ["GLB: no meshes", glb({ ...triangle, nodes: [{ name: "empty" }] }), "", /no triangles/],
];

for (const [what, content, name, said] of bad) {
  test(`bad: ${what}`, async () => {
    await assert.rejects(readSurface(Buffer.from(content as string), name, limits), (error) => {
      assert.ok(error instanceof FileFault, String((error as Error).stack));
      assert.match(error.message, said);
      return true;
    });
  });
}
