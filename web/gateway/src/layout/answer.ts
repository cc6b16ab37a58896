// Answers made of layouts.
import type { FlatSurface } from "@arapd/client";

import type { FileWarning } from "../files/surface.js";
import { Problem } from "../problems.js";
import { mediaTypeOf } from "./accept.js";
import type { AnswerKind } from "./accept.js";
import { objOf } from "./obj.js";
import type { Question } from "./question.js";

export interface Answer {
  mediaType: string;
  /** What toJson takes, or the bytes of a file. */
  body: object | Buffer;
  /** Of the file, where it is one. */
  fileName?: string;
  /** For Server-Timing. */
  timing: string;
}

const milliseconds = (micros: number): string => (micros / 1000).toFixed(3);
const timingOf = (flat: FlatSurface): string =>
  [
    `queue;dur=${milliseconds(flat.queueMicros)}`,
    `solve;dur=${milliseconds(flat.solveMicros)}`,
    ...(flat.surfaceCached ? ["surface-cached"] : []),
  ].join(", ");

function jsonOf(flat: FlatSurface, question: Question, warnings: readonly FileWarning[]): object {
  // What differs from one time to the next is no part of the layout.
  const { drawings, surfaceCached: _, queueMicros: _queue, solveMicros: _solve, ...layout } = flat;
  const { options, mesh, includeMesh } = question;
  return {
    ...layout,
    drawings: drawings.map((drawing, i) => {
      const { format } = options.drawings![i]!;
      return {
        format,
        mediaType: mediaTypeOf(format as AnswerKind),
        files: drawing.files.map(({ page, data }) => ({
          page,
          data: Buffer.from(data).toString("base64"),
        })),
        warnings: drawing.warnings,
      };
    }),
    ...(includeMesh && { mesh, parts: options.parts ?? [] }),
    ...(warnings.length > 0 && { fileWarnings: warnings }),
  };
}

/** The answer to a question. Warnings are those of the reader of a file. */
export function answerOf(
  flat: FlatSurface,
  question: Question,
  warnings: readonly FileWarning[],
): Answer {
  const { kind, drawing, mesh, options } = question;
  const mediaType = mediaTypeOf(kind);
  const timing = timingOf(flat);
  if (kind === "json") return { mediaType, timing, body: jsonOf(flat, question, warnings) };
  const fileName = `layout.${kind}`;
  if (kind === "obj")
    return { mediaType, timing, fileName, body: objOf(mesh, flat, options.parts ?? []) };
  const [file] = flat.drawings[drawing]?.files ?? [];
  if (!file)
    throw new Problem(
      "NOT_ACCEPTABLE",
      `The request named no drawing that is ${kind.toUpperCase()}.`,
    );
  return { mediaType, timing, fileName, body: Buffer.from(file.data) };
}
