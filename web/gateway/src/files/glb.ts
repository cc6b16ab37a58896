// GLB: the triangles of a glTF scene, each where its nodes put it. The container and its accessors
// are read by @gltf-transform/core, after what could make it take memory beyond the file has been
// refused.
import { Primitive, WebIO } from "@gltf-transform/core";
import type { GLTF, Node } from "@gltf-transform/core";

import { FileFault, SurfaceBuilder } from "./surface.js";
import type { FileLimits, Surface } from "./surface.js";
import { quoted } from "./text.js";

export const isGlb = (bytes: Buffer): boolean => bytes.toString("latin1", 0, 4) === "glTF";

// The container: chunks whose lengths add up.
function checkContainer(bytes: Buffer): void {
  if (bytes.length < 20) throw new FileFault("The file is too short to be GLB.");
  if (bytes.readUInt32LE(4) !== 2) throw new FileFault("byte 4: only version 2 of glTF is read.");
  if (bytes.readUInt32LE(8) !== bytes.length) {
    throw new FileFault(
      `byte 8: the header claims ${bytes.readUInt32LE(8)} bytes, the file has ${bytes.length}.`,
    );
  }
  for (let at = 12, chunk = 0; at < bytes.length; chunk++) {
    if (bytes.length - at < 8) throw new FileFault(`byte ${at}: the file ends within a chunk.`);
    const length = bytes.readUInt32LE(at);
    const isJson = bytes.readUInt32LE(at + 4) === 0x4e4f534a;
    if (isJson !== (chunk === 0))
      throw new FileFault(`byte ${at}: the first chunk, and no other, has to be JSON.`);
    if (length > bytes.length - at - 8)
      throw new FileFault(`byte ${at}: the chunk is longer than the file.`);
    at += 8 + length;
  }
}

const kinds = new Set(["KHR_mesh_quantization"]);
const most = 100_000; // of nodes, meshes and accessors each

function checkDocument(json: GLTF.IGLTF, bytes: number, limits: FileLimits): void {
  if (typeof json !== "object" || json === null)
    throw new FileFault("The first chunk is no object.");
  const list = (value: unknown, what: string): object[] => {
    if (value === undefined) return [];
    if (!Array.isArray(value) || value.some((one) => typeof one !== "object" || one === null)) {
      throw new FileFault(`${what} is no list of objects.`);
    }
    if (value.length > most)
      throw new FileFault(`${what} has ${value.length} entries; the gateway takes ${most}.`, true);
    return value as object[];
  };
  const required = json.extensionsRequired ?? [];
  if (!Array.isArray(required)) throw new FileFault("extensionsRequired is no list.");
  const unknown = required.find((name) => !kinds.has(name));
  if (unknown !== undefined)
    throw new FileFault(
      `The file needs the extension ${quoted(String(unknown))}, which is not read.`,
    );
  for (const [i, buffer] of list(json.buffers, "buffers").entries()) {
    if ((buffer as GLTF.IBuffer).uri !== undefined) {
      throw new FileFault(`buffers[${i}] is outside of the file; only GLB in one file is read.`);
    }
  }
  list(json.nodes, "nodes");
  list(json.scenes, "scenes");
  const views = list(json.bufferViews, "bufferViews") as GLTF.IBufferView[];
  for (const [i, accessor] of (list(json.accessors, "accessors") as GLTF.IAccessor[]).entries()) {
    const place = `accessors[${i}]`;
    if (accessor.sparse !== undefined)
      throw new FileFault(`${place} is sparse, which is not read.`);
    if (accessor.bufferView === undefined || !views[accessor.bufferView]) {
      throw new FileFault(`${place} has no buffer view.`);
    }
    if (!(Number.isInteger(accessor.count) && accessor.count >= 0 && accessor.count <= bytes)) {
      throw new FileFault(`${place}: ${accessor.count} elements do not fit into the file.`);
    }
  }
  let triangles = 0;
  for (const [i, mesh] of (list(json.meshes, "meshes") as GLTF.IMesh[]).entries()) {
    for (const primitive of list(
      mesh.primitives,
      `meshes[${i}].primitives`,
    ) as GLTF.IMeshPrimitive[]) {
      const mode = primitive.mode ?? 4;
      if (mode === 5 || mode === 6) {
        throw new FileFault(
          `meshes[${i}] has triangle ${mode === 5 ? "strips" : "fans"}, which are not read.`,
        );
      }
      const extension = Object.keys(primitive.extensions ?? {}).find((name) =>
        /compression/.test(name),
      );
      if (extension)
        throw new FileFault(
          `meshes[${i}] is compressed (${quoted(extension)}), which is not read.`,
        );
      const accessor =
        json.accessors?.[primitive.indices ?? primitive.attributes?.["POSITION"] ?? -1];
      triangles += (accessor?.count ?? 0) / 3;
    }
  }
  if (triangles > limits.triangles) {
    throw new FileFault(
      `The file has ${Math.floor(triangles)} triangles; the gateway takes ${limits.triangles}.`,
      true,
    );
  }
}

class SceneReader {
  readonly #builder: SurfaceBuilder;
  constructor(limits: FileLimits) {
    this.#builder = new SurfaceBuilder(limits);
  }

  // Depth first, without recursion: files may be deep.
  read(roots: readonly Node[]): Surface {
    const waiting = [...roots].reverse();
    let visited = 0;
    for (let node = waiting.pop(); node; node = waiting.pop()) {
      if (++visited > most)
        throw new FileFault(
          `The scene has more than ${most} nodes, as many as the gateway takes.`,
          true,
        );
      this.#node(node);
      waiting.push(...[...node.listChildren()].reverse());
    }
    if (this.#builder.faceCount === 0) throw new FileFault("The scene has no triangles.");
    return this.#builder.finish("glb");
  }

  #node(node: Node): void {
    const mesh = node.getMesh();
    if (!mesh) return;
    if (node.getSkin()) this.#builder.warn("skins", "Skinned meshes stay as they were modelled.");
    this.#builder.part(node.getName() || mesh.getName());
    const matrix = node.getWorldMatrix();
    // Parts of a mesh that share their vertices go on sharing them.
    const bases = new Map<unknown, number>();
    for (const primitive of mesh.listPrimitives()) {
      if (primitive.getMode() !== Primitive.Mode.TRIANGLES) {
        this.#builder.warn("points_and_lines", "Points and lines are passed over.");
        continue;
      }
      if (primitive.listTargets().length > 0)
        this.#builder.warn("morph_targets", "Morph targets are passed over.");
      this.#primitive(primitive, matrix, bases, mesh.getName());
    }
  }

  #primitive(
    primitive: Primitive,
    matrix: readonly number[],
    bases: Map<unknown, number>,
    name: string,
  ): void {
    const positions = primitive.getAttribute("POSITION");
    if (!positions || positions.getElementSize() !== 3) {
      throw new FileFault(`The mesh ${quoted(name)} has a part without positions.`);
    }
    const count = positions.getCount();
    let base = bases.get(positions);
    if (base === undefined) {
      base = this.#builder.vertexCount;
      bases.set(positions, base);
      const point: number[] = [0, 0, 0];
      for (let i = 0; i < count; i++) {
        positions.getElement(i, point);
        const [x, y, z] = [0, 1, 2].map(
          (k) =>
            matrix[k]! * point[0]! +
            matrix[4 + k]! * point[1]! +
            matrix[8 + k]! * point[2]! +
            matrix[12 + k]!,
        ) as [number, number, number];
        if (!Number.isFinite(x + y + z))
          throw new FileFault(`vertex ${i} of the mesh ${quoted(name)} is not finite.`);
        this.#builder.vertex(x, y, z);
      }
    }
    const indices = primitive.getIndices();
    const corners = indices ? indices.getCount() : count;
    if (corners % 3 !== 0) {
      throw new FileFault(
        `The mesh ${quoted(name)} has ${corners} corners of triangles, no multiple of three.`,
      );
    }
    const corner = (i: number): number => {
      const vertex = indices ? indices.getScalar(i) : i;
      if (vertex < count) return base + vertex;
      throw new FileFault(
        `The mesh ${quoted(name)} names vertex ${vertex}, but there are ${count}.`,
      );
    };
    for (let i = 0; i < corners; i += 3)
      this.#builder.face([corner(i), corner(i + 1), corner(i + 2)]);
  }
}

export async function readGlb(bytes: Buffer, limits: FileLimits): Promise<Surface> {
  checkContainer(bytes);
  const io = new WebIO();
  try {
    const json = JSON.parse(bytes.toString("utf8", 20, 20 + bytes.readUInt32LE(12))) as GLTF.IGLTF;
    checkDocument(json, bytes.length, limits);
    const root = (await io.readBinary(bytes)).getRoot();
    const scene = root.getDefaultScene() ?? root.listScenes()[0];
    const roots = scene
      ? scene.listChildren()
      : root.listNodes().filter((node) => !node.getParentNode());
    return new SceneReader(limits).read(roots);
  } catch (error) {
    if (error instanceof FileFault) throw error;
    // The library's own sentences name the place as far as it knows it.
    const said = (error as Error).message.replace(/\.+$/, "");
    throw new FileFault(`The file is no glTF that can be read: ${said}.`);
  }
}
