// Files in binary forms.

/** Triangles, x y z of each corner. */
export function stlBytes(corners: readonly number[], header = ""): Buffer {
  const count = corners.length / 9;
  const bytes = Buffer.alloc(84 + 50 * count);
  bytes.write(header);
  bytes.writeUInt32LE(count, 80);
  corners.forEach((x, i) => bytes.writeFloatLE(x, 84 + 50 * Math.floor(i / 9) + 12 + 4 * (i % 9)));
  return bytes;
}

/** A square of one face with four corners. */
export function plyBytes(little: boolean): Buffer {
  const head =
    `ply\nformat binary_${little ? "little" : "big"}_endian 1.0\nelement vertex 4\nproperty double x\n` +
    "property float y\nproperty short z\nelement face 1\nproperty list uchar uint vertex_indices\nend_header\n";
  const body = Buffer.alloc(4 * 14 + 1 + 16);
  const view = new DataView(body.buffer, body.byteOffset, body.length);
  [0, 0, 1, 0, 1, 1, 0, 1].forEach((x, i) => {
    const at = 14 * (i >> 1);
    if (i % 2 === 0) view.setFloat64(at, x, little);
    else view.setFloat32(at + 8, x, little);
  });
  view.setUint8(56, 4);
  [0, 1, 2, 3].forEach((corner, i) => view.setUint32(57 + 4 * i, corner, little));
  return Buffer.concat([Buffer.from(head), body]);
}

export interface Glb {
  positions: number[];
  indices?: number[];
  nodes?: object[];
  mode?: number;
  /** Put over the first accessor, and over the document. */
  accessor?: object;
  more?: object;
}

/** One mesh, shown by one node unless others are given. */
export function glb({
  positions,
  indices,
  nodes = [{ mesh: 0 }],
  mode,
  accessor,
  more,
}: Glb): Buffer {
  const points = Buffer.from(Float32Array.from(positions).buffer);
  const corners = Buffer.from(Uint32Array.from(indices ?? []).buffer);
  const json = {
    asset: { version: "2.0" },
    scene: 0,
    scenes: [{ nodes: [0] }],
    nodes,
    meshes: [
      {
        primitives: [
          {
            attributes: { POSITION: 0 },
            ...(indices && { indices: 1 }),
            ...(mode !== undefined && { mode }),
          },
        ],
      },
    ],
    accessors: [
      {
        bufferView: 0,
        componentType: 5126,
        count: positions.length / 3,
        type: "VEC3",
        ...accessor,
      },
      ...(indices
        ? [{ bufferView: 1, componentType: 5125, count: indices.length, type: "SCALAR" }]
        : []),
    ],
    bufferViews: [
      { buffer: 0, byteOffset: 0, byteLength: points.length },
      ...(indices ? [{ buffer: 0, byteOffset: points.length, byteLength: corners.length }] : []),
    ],
    buffers: [{ byteLength: points.length + corners.length }],
    ...more,
  };
  const padded = (bytes: Buffer, fill: number): Buffer =>
    Buffer.concat([bytes, Buffer.alloc((4 - (bytes.length % 4)) % 4, fill)]);
  const chunk = (kind: number, bytes: Buffer): Buffer => {
    const head = Buffer.alloc(8);
    head.writeUInt32LE(bytes.length, 0);
    head.writeUInt32LE(kind, 4);
    return Buffer.concat([head, bytes]);
  };
  const body = Buffer.concat([
    chunk(0x4e4f534a, padded(Buffer.from(JSON.stringify(json)), 0x20)),
    chunk(0x004e4942, padded(Buffer.concat([points, corners]), 0)),
  ]);
  const head = Buffer.alloc(12);
  head.write("glTF");
  head.writeUInt32LE(2, 4);
  head.writeUInt32LE(12 + body.length, 8);
  return Buffer.concat([head, body]);
}
