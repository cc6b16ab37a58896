// What is asked of arapd for an answer of some kind, and the tag that the answer will have.
import { createHash } from "node:crypto";

import type { DrawingOptions, FlattenOptions as ClientOptions, SurfaceMesh } from "@arapd/client";

import { Problem } from "../problems.js";
import type { FlattenInput } from "../upload.js";
import type { AnswerKind } from "./accept.js";

export interface Question {
  kind: AnswerKind;
  mesh: SurfaceMesh;
  options: ClientOptions;
  /** Which of the drawings is the answer. */
  drawing: number;
  includeMesh: boolean;
}

// A drawing that is an answer has one file.
function checkDrawing({ format, paper = "" }: DrawingOptions): void {
  if (format === "svg" && paper !== "") {
    throw new Problem(
      "NOT_ACCEPTABLE",
      "An SVG on paper is several files: ask for application/json or application/pdf.",
    );
  }
}

/** Which of these drawings is the answer of this kind; -1: none, or the answer is none. */
export function drawingFor(kind: AnswerKind, drawings: readonly DrawingOptions[]): number {
  const found = drawings.findIndex(({ format }) => format === kind);
  if (found >= 0) checkDrawing(drawings[found]!);
  return found;
}

/** The question of a request for an answer at once: what the answer does not show is not asked. */
export function questionOf(kind: AnswerKind, { mesh, options }: FlattenInput): Question {
  const { drawings = [], includeMesh = false, ...rest } = options;
  if (kind === "json")
    return { kind, mesh, options: { ...rest, drawings }, drawing: -1, includeMesh };
  const found = drawingFor(kind, drawings);
  const wanted: DrawingOptions[] = kind === "obj" ? [] : [drawings[found] ?? { format: kind }];
  return {
    kind,
    mesh,
    options: { ...rest, drawings: wanted },
    drawing: kind === "obj" ? -1 : 0,
    includeMesh,
  };
}

const bytesOf = (numbers: Float64Array | Uint32Array): Uint8Array =>
  new Uint8Array(numbers.buffer, numbers.byteOffset, numbers.byteLength);

/** The same question to the same version has the same answer, byte for byte. */
export function tagOf(question: Question, version: string): string {
  const { kind, mesh, options, drawing, includeMesh } = question;
  const { surfaceKey: _, ...shown } = options;
  const hash = createHash("sha256");
  hash.update(
    JSON.stringify([1, version, kind, drawing, includeMesh, shown, mesh.vertices.length]),
  );
  hash.update(bytesOf(Float64Array.from(mesh.vertices)));
  hash.update(bytesOf(Uint32Array.from(mesh.triangles)));
  return `"${hash.digest("base64url").slice(0, 32)}"`;
}

/** Whether If-None-Match names this tag. */
export function names(header: string | undefined, tag: string): boolean {
  if (header === undefined) return false;
  return header.split(",").some((one) => {
    const given = one.trim().replace(/^W\//, "");
    return given === tag || given === "*";
  });
}
