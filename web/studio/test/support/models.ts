// Models whose lengths are known, in every format that the page takes.
import { Buffer } from "node:buffer";

export interface Model {
  vertices: number[][];
  triangles: number[][];
}

export const around = 24;
export const along = 8;
export const radius = 50;
export const height = 200;
/** Of the flat tube: its sides are chords. */
export const girth = 2 * around * radius * Math.sin(Math.PI / around);
/** The vertex of row `j`, `i` steps around from the front, which is towards z. */
export const tubeVertex = (i: number, j: number): number => j * around + ((i + around) % around);

/** A tube with open ends, standing on y. */
export function tube(): Model {
  const vertices: number[][] = [];
  for (let j = 0; j <= along; ++j) {
    for (let i = 0; i < around; ++i) {
      const angle = (2 * Math.PI * i) / around;
      vertices.push([radius * Math.sin(angle), (height * j) / along, radius * Math.cos(angle)]);
    }
  }
  const triangles: number[][] = [];
  for (let j = 0; j < along; ++j) {
    for (let i = 0; i < around; ++i) {
      const [a, b] = [tubeVertex(i, j), tubeVertex(i + 1, j)];
      triangles.push([a, b, b + around], [a, b + around, a + around]);
    }
  }
  return { vertices, triangles };
}

/** Half a tube: it lies flat without a cut. */
export function shell(): Model {
  const { vertices, triangles } = tube();
  return { vertices, triangles: triangles.filter((_, t) => (t >> 1) % around < around / 2) };
}

export const obj = ({ vertices, triangles }: Model): string =>
  `${vertices.map((v) => `v ${v.join(" ")}`).join("\n")}\n${triangles
    .map((t) => `f ${t.map((i) => i + 1).join(" ")}`)
    .join("\n")}\n`;

export const ply = ({ vertices, triangles }: Model): string =>
  `ply\nformat ascii 1.0\nelement vertex ${vertices.length}\nproperty double x\nproperty double y\n` +
  `property double z\nelement face ${triangles.length}\nproperty list uchar int vertex_indices\nend_header\n` +
  `${vertices.map((v) => v.join(" ")).join("\n")}\n${triangles.map((t) => `3 ${t.join(" ")}`).join("\n")}\n`;

export const stl = ({ vertices, triangles }: Model): string =>
  `solid tube\n${triangles
    .map(
      (t) =>
        `facet normal 0 0 0\nouter loop\n${t.map((i) => `vertex ${vertices[i].join(" ")}`).join("\n")}\nendloop\nendfacet`,
    )
    .join("\n")}\nendsolid tube\n`;

/** In metres, as glTF has it. */
export function glb({ vertices, triangles }: Model): Buffer {
  const points = Buffer.from(Float32Array.from(vertices.flat(), (value) => value / 1000).buffer);
  const corners = Buffer.from(Uint32Array.from(triangles.flat()).buffer);
  const json = {
    asset: { version: "2.0" },
    scene: 0,
    scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0, name: "tube" }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 }, indices: 1 }] }],
    accessors: [
      { bufferView: 0, componentType: 5126, count: vertices.length, type: "VEC3" },
      { bufferView: 1, componentType: 5125, count: 3 * triangles.length, type: "SCALAR" },
    ],
    bufferViews: [
      { buffer: 0, byteOffset: 0, byteLength: points.length },
      { buffer: 0, byteOffset: points.length, byteLength: corners.length },
    ],
    buffers: [{ byteLength: points.length + corners.length }],
  };
  const text = Buffer.from(JSON.stringify(json));
  const padded = Buffer.concat([text, Buffer.alloc((4 - (text.length % 4)) % 4, 0x20)]);
  const head = (kind: number, length: number): Buffer => {
    const bytes = Buffer.alloc(8);
    bytes.writeUInt32LE(length, 0);
    bytes.writeUInt32LE(kind, 4);
    return bytes;
  };
  const binary = Buffer.concat([points, corners]);
  const total = 12 + 8 + padded.length + 8 + binary.length;
  const start = Buffer.alloc(12);
  start.write("glTF");
  start.writeUInt32LE(2, 4);
  start.writeUInt32LE(total, 8);
  return Buffer.concat([
    start,
    head(0x4e4f534a, padded.length),
    padded,
    head(0x004e4942, binary.length),
    binary,
  ]);
}
