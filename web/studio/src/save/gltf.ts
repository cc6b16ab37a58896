// A film as one GLB file: the mesh with a morph target per key, and weights that go through them.
import type { Body } from "../model/puppet.js";
import { joined, textBytes } from "./zip.js";

export interface GltfInput {
  name: string;
  body: Body;
  /** x y x y… per key. */
  shapes: readonly ArrayLike<number>[];
  /** Keys in a second. */
  rate: number;
  /** Triangles back to front; empty: as they are numbered. */
  order: ArrayLike<number>;
  png: Uint8Array;
  width: number;
  height: number;
}

const align = (bytes: Uint8Array, fill: number): Uint8Array => {
  const padded = new Uint8Array(Math.ceil(bytes.length / 4) * 4).fill(fill);
  padded.set(bytes);
  return padded;
};

/** A unit is the height of the picture; y is up, z 0. */
export function glbOf(input: GltfInput): Uint8Array {
  const { body, shapes, width, height } = input;
  const count = body.rest.length / 2;
  const chunks: Uint8Array[] = [];
  const views: object[] = [];
  const accessors: object[] = [];
  let offset = 0;
  const view = (bytes: Uint8Array, target?: number): number => {
    views.push({
      buffer: 0,
      byteOffset: offset,
      byteLength: bytes.length,
      ...(target && { target }),
    });
    const padded = align(bytes, 0);
    chunks.push(padded);
    offset += padded.length;
    return views.length - 1;
  };
  const accessor = (
    data: Float32Array | Uint32Array,
    type: "SCALAR" | "VEC2" | "VEC3",
    target?: number,
  ): number => {
    const size = { SCALAR: 1, VEC2: 2, VEC3: 3 }[type];
    const bounds = type === "SCALAR" && target !== undefined ? {} : boundsOf(data, size);
    accessors.push({
      bufferView: view(new Uint8Array(data.buffer, data.byteOffset, data.byteLength), target),
      componentType: data instanceof Uint32Array ? 5125 : 5126,
      count: data.length / size,
      type,
      ...bounds,
    });
    return accessors.length - 1;
  };
  const [arrayBuffer, elementBuffer] = [34962, 34963];
  const unit = 1 / height;
  const places = new Float32Array(3 * count);
  const texels = new Float32Array(2 * count);
  for (let i = 0; i < count; ++i) {
    places[3 * i] = (body.rest[2 * i] - width / 2) * unit;
    places[3 * i + 1] = body.rest[2 * i + 1] * unit;
    texels[2 * i] = body.picture[2 * i] / width;
    texels[2 * i + 1] = 1 - body.picture[2 * i + 1] / height;
  }
  const corners =
    input.order.length > 0
      ? Uint32Array.from(
          Array.from(input.order).flatMap((t) => [...body.triangles.subarray(3 * t, 3 * t + 3)]),
        )
      : body.triangles;
  const primitive = {
    attributes: {
      POSITION: accessor(places, "VEC3", arrayBuffer),
      TEXCOORD_0: accessor(texels, "VEC2", arrayBuffer),
    },
    indices: accessor(corners, "SCALAR", elementBuffer),
    material: 0,
    targets: shapes.map((shape) => {
      const moved = new Float32Array(3 * count);
      for (let i = 0; i < count; ++i) {
        moved[3 * i] = (shape[2 * i] - body.rest[2 * i]) * unit;
        moved[3 * i + 1] = (shape[2 * i + 1] - body.rest[2 * i + 1]) * unit;
      }
      return { POSITION: accessor(moved, "VEC3", arrayBuffer) };
    }),
  };
  const keys = shapes.length;
  const times = Float32Array.from({ length: keys }, (_, k) => k / input.rate);
  const weights = new Float32Array(keys * keys);
  for (let k = 0; k < keys; ++k) weights[k * keys + k] = 1;
  const document = {
    asset: { version: "2.0", generator: "arapd studio" },
    extensionsUsed: ["KHR_materials_unlit"],
    scene: 0,
    scenes: [{ nodes: [0] }],
    nodes: [{ name: input.name, mesh: 0 }],
    meshes: [
      { name: input.name, primitives: [primitive], weights: Array.from({ length: keys }, () => 0) },
    ],
    materials: [
      {
        name: input.name,
        pbrMetallicRoughness: {
          baseColorTexture: { index: 0 },
          metallicFactor: 0,
          roughnessFactor: 1,
        },
        alphaMode: "BLEND",
        doubleSided: true,
        extensions: { KHR_materials_unlit: {} },
      },
    ],
    textures: [{ source: 0, sampler: 0 }],
    samplers: [{ magFilter: 9729, minFilter: 9987, wrapS: 33071, wrapT: 33071 }],
    images: [{ mimeType: "image/png", bufferView: view(input.png) }],
    animations: [
      {
        name: "take",
        samplers: [
          {
            input: accessor(times, "SCALAR"),
            interpolation: "LINEAR",
            output: accessorPlain(weights),
          },
        ],
        channels: [{ sampler: 0, target: { node: 0, path: "weights" } }],
      },
    ],
    accessors,
    bufferViews: views,
    buffers: [{ byteLength: 0 }],
  };
  function accessorPlain(data: Float32Array): number {
    accessors.push({
      bufferView: view(new Uint8Array(data.buffer)),
      componentType: 5126,
      count: data.length,
      type: "SCALAR",
    });
    return accessors.length - 1;
  }
  document.buffers[0].byteLength = offset;
  const json = align(textBytes(JSON.stringify(document)), 0x20);
  const binary = joined(chunks);
  const header = new Uint32Array([0x46546c67, 2, 12 + 8 + json.length + 8 + binary.length]);
  const jsonHead = new Uint32Array([json.length, 0x4e4f534a]);
  const binaryHead = new Uint32Array([binary.length, 0x004e4942]);
  const words = (numbers: Uint32Array): Uint8Array => new Uint8Array(numbers.buffer);
  return joined([words(header), words(jsonHead), json, words(binaryHead), binary]);
}

function boundsOf(data: ArrayLike<number>, size: number): { min: number[]; max: number[] } {
  const min: number[] = Array.from({ length: size }, () => Infinity);
  const max: number[] = Array.from({ length: size }, () => -Infinity);
  for (let i = 0; i < data.length; ++i) {
    min[i % size] = Math.min(min[i % size], data[i]);
    max[i % size] = Math.max(max[i % size], data[i]);
  }
  return { min, max };
}
