// Wavefront OBJ: vertices, faces, objects and groups. Texture coordinates, normals, colours, lines
// and materials are passed over.
import { FileFault } from "./surface.js";
import type { FileLimits, Surface } from "./surface.js";
import { SurfaceBuilder } from "./surface.js";
import { Lines, numberOf, quoted, wholeOf, wordsOf } from "./text.js";

const passedOver = new Set(
  (
    "vt vn vp l p s mg g o mtllib usemtl maplib usemap bevel c_interp d_interp lod shadow_obj " +
    "trace_obj"
  ).split(" "),
);

class ObjReader {
  readonly #lines: Lines;
  readonly #builder: SurfaceBuilder;
  #object = "";
  #group = "";
  #named = false; // since the last face
  readonly #parts: { face: number; object: string; group: string }[] = [];

  constructor(bytes: Buffer, limits: FileLimits) {
    this.#lines = new Lines(bytes);
    this.#builder = new SurfaceBuilder(limits);
  }

  read(): Surface {
    while (this.#lines.next()) this.#statement(this.#joined());
    // Objects name the parts where there are several, or no groups.
    const several = new Set(this.#parts.map(({ object }) => object)).size > 1;
    const byObject = several || this.#parts.every(({ group }) => group === "");
    for (const { face, object, group } of this.#parts) {
      this.#builder.part(byObject ? object : group, face);
    }
    return this.#builder.finish("obj");
  }

  // A line that ends with a backslash goes on with the next one.
  #joined(): string {
    let line = this.#lines.line;
    while (line.endsWith("\\")) {
      const more = this.#lines.next();
      line = `${line.slice(0, -1)} ${more ? this.#lines.line : ""}`;
    }
    const comment = line.indexOf("#");
    return comment < 0 ? line : line.slice(0, comment);
  }

  #statement(line: string): void {
    const [keyword, ...words] = wordsOf(line);
    const { number } = this.#lines;
    switch (keyword) {
      case undefined:
        return;
      case "v":
        return this.#vertex(words, number);
      case "f":
      case "fo":
        return this.#face(words, number);
      case "o":
        this.#object = words.join(" ");
        this.#named = true;
        return;
      case "g":
        this.#group = words.join(" ");
        this.#named = true;
        return;
    }
    if (passedOver.has(keyword)) return;
    this.#builder.warn(
      "unknown_statements",
      `line ${number}: unknown statements are passed over, the first is ${quoted(keyword)}.`,
    );
  }

  #vertex(words: string[], line: number): void {
    if (words.length < 2 || words.length === 5 || words.length > 7) {
      throw new FileFault(
        `line ${line}: a vertex of ${words.length} numbers; it has two to four, and three or four more of a colour.`,
      );
    }
    const numbers = words.map((word) => numberOf(word, line));
    if (numbers.length === 4 && numbers[3] !== 1) {
      this.#builder.warn(
        "vertex_weights",
        `line ${line}: weights of vertices other than 1 do not count.`,
      );
    }
    this.#builder.vertex(numbers[0]!, numbers[1]!, numbers[2] ?? 0);
  }

  #face(words: string[], line: number): void {
    if (words.length < 3) {
      throw new FileFault(`line ${line}: a face of ${words.length} corners; it has three or more.`);
    }
    if (this.#named) {
      this.#named = false;
      this.#parts.push({ face: this.#builder.faceCount, object: this.#object, group: this.#group });
    }
    this.#builder.face(
      words.map((word) => this.#corner(word, line)),
      line,
    );
  }

  // A corner is a, a/b, a//c or a/b/c; the vertex is what counts, from 1, or back from here.
  #corner(word: string, line: number): number {
    const parts = word.split("/");
    if (parts.length > 3) throw new FileFault(`line ${line}: ${quoted(word)} is no corner.`);
    for (const part of parts.slice(1)) if (part !== "") wholeOf(part, line);
    const index = wholeOf(parts[0]!, line);
    if (index === 0) throw new FileFault(`line ${line}: there is no vertex 0, they count from 1.`);
    const vertex = index < 0 ? this.#builder.vertexCount + index : index - 1;
    if (vertex >= 0 && vertex < 2 ** 32 - 1) return vertex;
    throw new FileFault(
      `line ${line}: there is no vertex ${index}, the file has ${this.#builder.vertexCount} up to here.`,
    );
  }
}

export const readObj = (bytes: Buffer, limits: FileLimits): Surface =>
  new ObjReader(bytes, limits).read();
