// PLY, as text and in both binary forms: x, y and z of the vertices and the corners of the faces.
// All other properties and elements are passed over.
import { FileFault, SurfaceBuilder } from "./surface.js";
import type { FileLimits, Surface } from "./surface.js";
import { Lines, numberOf, quoted, wordsOf } from "./text.js";

const sizes = {
  int8: 1,
  uint8: 1,
  int16: 2,
  uint16: 2,
  int32: 4,
  uint32: 4,
  float32: 4,
  float64: 8,
};
type Type = keyof typeof sizes;
const oldNames: Readonly<Record<string, Type>> = {
  char: "int8",
  uchar: "uint8",
  short: "int16",
  ushort: "uint16",
  int: "int32",
  uint: "uint32",
  float: "float32",
  double: "float64",
};

interface Property {
  name: string;
  type: Type;
  /** A list begins with its length in this type. */
  count?: Type;
}
interface Element {
  name: string;
  count: number;
  line: number;
  properties: Property[];
}
interface Header {
  format: string;
  elements: Element[];
  lines: number;
  /** In bytes. */
  size: number;
}

const formats = ["ascii", "binary_little_endian", "binary_big_endian"];

function typeOf(word: string | undefined, line: number): Type {
  const type = oldNames[word ?? ""] ?? word;
  if (type !== undefined && Object.hasOwn(sizes, type)) return type as Type;
  throw new FileFault(`line ${line}: ${quoted(word ?? "")} is no type of PLY.`);
}

function propertyOf(words: string[], line: number): Property {
  const isList = words[1] === "list";
  const name = words[isList ? 4 : 2];
  if (name === undefined) throw new FileFault(`line ${line}: a property without a name.`);
  const type = typeOf(words[isList ? 3 : 1], line);
  if (!isList) return { name, type };
  const count = typeOf(words[2], line);
  if (count.startsWith("float")) {
    throw new FileFault(`line ${line}: the length of a list has to be a whole number.`);
  }
  return { name, type, count };
}

function headerOf(bytes: Buffer): Header {
  const head = bytes.toString("latin1", 0, 65_536);
  // Lines end as the first one does.
  const end = /^ply[ \t]*(\r\n|\r|\n)/.exec(head)?.[1];
  if (end === undefined) throw new FileFault("line 1: a PLY file begins with 'ply'.");
  const header: Header = { format: "", elements: [], lines: 0, size: 0 };
  let properties = 0;
  for (let at = 0; ; ) {
    const stop = head.indexOf(end, at);
    if (stop < 0)
      throw new FileFault("The header has no end within 64 KiB: 'end_header' is missing.");
    const words = wordsOf(head.slice(at, stop));
    at = stop + end.length;
    const line = ++header.lines;
    const last = header.elements.at(-1);
    switch (words[0]) {
      case "format":
        header.format = words[1] ?? "";
        if (!formats.includes(header.format) || words[2] !== "1.0") {
          throw new FileFault(
            `line ${line}: ${quoted(words.slice(1).join(" "))} is no format that is read.`,
          );
        }
        break;
      case "element": {
        const count = /^\d{1,15}$/.test(words[2] ?? "") ? Number(words[2]) : -1;
        if (words[1] === undefined || count < 0 || header.elements.length === 100) {
          throw new FileFault(
            `line ${line}: ${quoted(words.slice(1).join(" "))} is no count of elements.`,
          );
        }
        header.elements.push({ name: words[1], count, line, properties: [] });
        break;
      }
      case "property":
        if (!last || ++properties > 1000) throw new FileFault(`line ${line}: a property too many.`);
        last.properties.push(propertyOf(words, line));
        break;
      case "end_header":
        if (header.format === "") throw new FileFault(`line ${line}: the header says no format.`);
        header.size = at;
        return header;
    }
  }
}

/** Where the numbers come from, one by one. */
interface Source {
  begin(): void;
  take(type: Type): number;
  skip(type: Type, count: number): void;
  end(): void;
  /** Nothing may be left. */
  finish(): void;
  /** Of the number that was taken last. */
  place(): string;
  line(): number;
  /** Whether so many numbers of at least a byte can still be there. */
  hasRoom(count: number): boolean;
}

function textSource(bytes: Buffer, header: Header): Source {
  const body = bytes.subarray(header.size);
  const lines = new Lines(body);
  let words: string[] = [];
  let at = 0;
  const line = (): number => lines.number + header.lines;
  const fault = (what: string): FileFault => new FileFault(`line ${line()}: ${what}`);
  const next = (): string => {
    const word = words[at++];
    if (word === undefined) throw fault("the line ends before all its properties are there.");
    return word;
  };
  const begin = (): boolean => {
    at = 0;
    do {
      if (!lines.next()) return false;
      words = wordsOf(lines.line);
    } while (words.length === 0);
    return true;
  };
  return {
    begin: () => {
      if (!begin()) throw fault("the file ends before what the header claims.");
    },
    take: () => numberOf(next(), line()),
    skip: (_, count) => {
      for (let i = 0; i < count; i++) next();
    },
    end: () => {
      if (at < words.length) throw fault(`${quoted(words[at]!)} is one word too many.`);
    },
    finish: () => {
      if (begin())
        throw fault(`${quoted(words[0]!)}: the file goes on behind what the header claims.`);
    },
    place: () => `line ${line()}`,
    line,
    hasRoom: (count) => count <= body.length,
  };
}

function byteSource(bytes: Buffer, header: Header): Source {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.length);
  const little = header.format === "binary_little_endian";
  let at = header.size;
  let taken = at;
  const advance = (length: number): number => {
    taken = at;
    if (length > bytes.length - at) {
      throw new FileFault(`byte ${at}: the file ends before what the header claims.`);
    }
    at += length;
    return taken;
  };
  const read = (type: Type, from: number): number => {
    switch (type) {
      case "int8":
        return view.getInt8(from);
      case "uint8":
        return view.getUint8(from);
      case "int16":
        return view.getInt16(from, little);
      case "uint16":
        return view.getUint16(from, little);
      case "int32":
        return view.getInt32(from, little);
      case "uint32":
        return view.getUint32(from, little);
      case "float32":
        return view.getFloat32(from, little);
      case "float64":
        return view.getFloat64(from, little);
    }
  };
  return {
    begin: () => {},
    take: (type) => {
      const value = read(type, advance(sizes[type]));
      if (Number.isFinite(value)) return value;
      throw new FileFault(`byte ${taken}: ${value} is not a finite number.`);
    },
    skip: (type, count) => void advance(sizes[type] * count),
    end: () => {},
    finish: () => {
      if (at < bytes.length) {
        throw new FileFault(`byte ${at}: the file goes on behind what the header claims.`);
      }
    },
    place: () => `byte ${taken}`,
    line: () => 0,
    hasRoom: (count) => count <= bytes.length - at,
  };
}

function lengthOf(source: Source, type: Type): number {
  const length = source.take(type);
  if (Number.isInteger(length) && length >= 0 && source.hasRoom(length)) return length;
  throw new FileFault(`${source.place()}: ${length} is not the length of a list in this file.`);
}

function cornersOf(source: Source, { count, type }: Property, vertices: number): number[] {
  const length = lengthOf(source, count!);
  if (length < 3)
    throw new FileFault(`${source.place()}: a face of ${length} corners; it has three or more.`);
  return Array.from({ length }, () => {
    const vertex = source.take(type);
    if (Number.isInteger(vertex) && vertex >= 0 && vertex < vertices) return vertex;
    throw new FileFault(
      `${source.place()}: there is no vertex ${vertex}, they go from 0 to ${vertices - 1}.`,
    );
  });
}

function check(header: Header): { vertices: Element; faces: Element; corners: Property } {
  const vertices = header.elements.find(({ name }) => name === "vertex");
  const faces = header.elements.find(({ name }) => name === "face");
  const strips = header.elements.find(({ name, count }) => name === "tristrips" && count > 0);
  if (strips) throw new FileFault(`line ${strips.line}: triangle strips are not read.`);
  if (!vertices || !faces) throw new FileFault("The file has no faces, or no vertices.");
  for (const axis of ["x", "y", "z"]) {
    if (vertices.properties.some(({ name, count }) => name === axis && !count)) continue;
    throw new FileFault(`line ${vertices.line}: the vertices have no ${axis}.`);
  }
  const corners = faces.properties.find(
    ({ name, count, type }) =>
      /^vertex_(indices|index)$/.test(name) && count && !type.startsWith("float"),
  );
  if (!corners) {
    throw new FileFault(
      `line ${faces.line}: the faces have no list of whole numbers 'vertex_indices'.`,
    );
  }
  for (const { name, count, line, properties } of header.elements) {
    if (count > 0 && properties.length === 0)
      throw new FileFault(`line ${line}: ${quoted(name)} has no properties.`);
  }
  return { vertices, faces, corners };
}

export function readPly(bytes: Buffer, limits: FileLimits): Surface {
  const header = headerOf(bytes);
  const { vertices, faces, corners } = check(header);
  const source = header.format === "ascii" ? textSource(bytes, header) : byteSource(bytes, header);
  const builder = new SurfaceBuilder(limits);
  const others = new Set<string>();
  for (const element of header.elements) {
    if (!source.hasRoom(element.count)) {
      throw new FileFault(
        `line ${element.line}: the header claims ${element.count} elements ${quoted(element.name)}, the file has no room for them.`,
      );
    }
    if (element !== vertices && element !== faces && element.count > 0) others.add(element.name);
    for (let i = 0; i < element.count; i++) {
      const point = [0, 0, 0];
      source.begin();
      for (const property of element.properties) {
        const axis =
          element === vertices && !property.count ? ["x", "y", "z"].indexOf(property.name) : -1;
        if (axis >= 0) point[axis] = source.take(property.type);
        else if (property === corners)
          builder.face(cornersOf(source, property, vertices.count), source.line());
        else {
          if (element === vertices || element === faces) others.add(property.name);
          source.skip(property.type, property.count ? lengthOf(source, property.count) : 1);
        }
      }
      source.end();
      if (element === vertices) builder.vertex(point[0]!, point[1]!, point[2]!);
    }
  }
  source.finish();
  if (others.size > 0) {
    const names = [...others].slice(0, 8).map(quoted).join(", ");
    builder.warn("unknown_properties", `Properties and elements are passed over: ${names}.`);
  }
  return builder.finish("ply");
}
