// A layout as an OBJ file: the mesh, a vt for each flat position, and the named parts.
import type { FlatSurface, NamedPart, SurfaceMesh } from "@arapd/client";

import { plainName } from "../files/surface.js";

const pieceLines = 50_000;

/** Numbers are the shortest that read back exactly. */
export function objOf(mesh: SurfaceMesh, flat: FlatSurface, parts: readonly NamedPart[]): Buffer {
  const pieces: Buffer[] = [];
  let lines: string[] = [];
  const line = (text: string): void => {
    lines.push(text);
    if (lines.length >= pieceLines) flush();
  };
  const flush = (): void => {
    if (lines.length > 0) pieces.push(Buffer.from(`${lines.join("\n")}\n`));
    lines = [];
  };
  const { vertices, triangles } = mesh;
  for (let i = 0; i < vertices.length; i += 3)
    line(`v ${vertices[i]} ${vertices[i + 1]} ${vertices[i + 2]}`);
  const { uv, cornerUv } = flat;
  const text = (value: number): number =>
    uv instanceof Float32Array ? Number(value.toPrecision(9)) : value;
  for (let i = 0; i < uv.length; i += 2) line(`vt ${text(uv[i]!)} ${text(uv[i + 1]!)}`);
  let part = 0;
  for (let corner = 0; corner < triangles.length; corner += 3) {
    for (; part < parts.length && 3 * parts[part]!.firstTriangle <= corner; part++) {
      line(`o ${plainName(parts[part]!.name ?? "").replaceAll("\\", "_")}`);
    }
    const corners = [0, 1, 2].map(
      (k) => `${triangles[corner + k]! + 1}/${cornerUv[corner + k]! + 1}`,
    );
    line(`f ${corners.join(" ")}`);
  }
  flush();
  return Buffer.concat(pieces);
}
