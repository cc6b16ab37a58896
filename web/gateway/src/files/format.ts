// Which format a file has, and its surface.
import { isGlb, readGlb } from "./glb.js";
import { readObj } from "./obj.js";
import { readPly } from "./ply.js";
import { isBinaryStl, readStl } from "./stl.js";
import { FileFault } from "./surface.js";
import type { FileFormat, FileLimits, Surface } from "./surface.js";

const endings = ["obj", "ply", "stl", "glb"] as const;

/** What the content shows, else what the name says. */
function formatOf(bytes: Buffer, name: string): FileFormat {
  if (isBinaryStl(bytes)) return "stl";
  if (isGlb(bytes)) return "glb";
  const head = bytes.toString("latin1", 0, 256).replace(/^\s*/, "");
  if (/^ply\s/.test(head)) return "ply";
  const ending = name.toLowerCase().split(".").at(-1);
  const named = endings.find((one) => one === ending);
  if (/^solid(\s|$)/i.test(head) && named !== "obj") return "stl";
  if (named === "obj" || named === "stl") return named;
  if (named) throw new FileFault(`The file is called .${named} but does not begin like one.`);
  return "obj";
}

/** FileFault with the place for what is wrong. */
export async function readSurface(
  bytes: Buffer,
  name: string,
  limits: FileLimits,
): Promise<Surface> {
  switch (formatOf(bytes, name)) {
    case "obj":
      return readObj(bytes, limits);
    case "ply":
      return readPly(bytes, limits);
    case "stl":
      return readStl(bytes, limits);
    case "glb":
      return readGlb(bytes, limits);
  }
}
