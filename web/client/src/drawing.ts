// Drawings of a layout: files at true size, in millimetres, that the server makes.
import { index, toEnum } from "./checks.js";
import type { Names } from "./checks.js";
import { badAnswer } from "./errors.js";
import { AllowanceCorners } from "./gen/arap/v1/AllowanceCorners.js";
import type { AllowanceCornersAnswer } from "./gen/arap/v1/AllowanceCorners.js";
import type { DrawingAnswer } from "./gen/arap/v1/Drawing.js";
import { DrawingFormat } from "./gen/arap/v1/DrawingFormat.js";
import type { DrawingFormatAnswer } from "./gen/arap/v1/DrawingFormat.js";
import type { DrawingOptions as WireOptions } from "./gen/arap/v1/DrawingOptions.js";
import type { NamedPart as WirePart } from "./gen/arap/v1/NamedPart.js";
import { warningsOf } from "./mesh.js";
import type { Warning } from "./mesh.js";

/** What to draw. Lengths are in millimetres. */
export interface DrawingOptions {
  format: Names<DrawingFormatAnswer, "DRAWING_FORMAT_">;
  /** How many millimetres a unit of the mesh is: 10 for centimetres. Default 1. */
  millimetresPerUnit?: number;
  /** Seam allowance round the pieces. Default 0. */
  allowance?: number;
  /** How the allowance goes round corners. Default "mitre". */
  corners?: Names<AllowanceCornersAnswer, "ALLOWANCE_CORNERS_">;
  /** Pair the two sides of every seam by short lines with a number. */
  notches?: boolean;
  /** Pack the pieces into a roll of this width. Default: as they were laid. */
  sheetWidth?: number;
  /** Pages to print and join: "A0" to "A5", "letter", "legal", "tabloid" or "WIDTHxHEIGHT". */
  paper?: string;
  /** What pages share with their neighbours. Default 10. */
  overlap?: number;
  /** What the printer does not reach on each side of a page. Default 10. */
  margin?: number;
  /** Show the edges inside too. */
  interior?: boolean;
  /** Nothing besides the lines. */
  plain?: boolean;
}

/** A part of the surface that has a name: an object or group of the file that it is from. */
export interface NamedPart {
  /** Its triangles begin with this one and go on to where the next part begins. */
  firstTriangle: number;
  name?: string;
}

/** A file of a drawing. */
export interface DrawingFile {
  /** "cover" or the number of the page where there is a file for each; else empty. */
  page: string;
  data: Uint8Array;
}

/** A drawing that was asked for. */
export interface Drawing {
  /** One; of an SVG on paper the cover, then the pages by their numbers. */
  files: DrawingFile[];
  /** What is doubtful in it. Elements are pieces, by their place in the charts. */
  warnings: Warning[];
}

export const drawingsToWire = (drawings: readonly DrawingOptions[]): WireOptions[] =>
  drawings.map(({ format, corners, ...rest }, i) => ({
    ...rest,
    format: toEnum(DrawingFormat, "DRAWING_FORMAT_", format, `drawings[${i}].format`),
    ...(corners && {
      corners: toEnum(AllowanceCorners, "ALLOWANCE_CORNERS_", corners, `drawings[${i}].corners`),
    }),
  }));

export const partsToWire = (parts: readonly NamedPart[]): WirePart[] =>
  parts.map(({ firstTriangle, name }, i) => ({
    firstTriangle: index(firstTriangle, `parts[${i}].first_triangle`),
    name: name ?? "",
  }));

/** A drawing with its files for each of those that were asked for. */
export function drawingsOf(
  answers: readonly DrawingAnswer[],
  asked: readonly DrawingOptions[],
): Drawing[] {
  if (answers.length !== asked.length) {
    throw badAnswer(`The server answered ${answers.length} drawings, not ${asked.length}.`);
  }
  return answers.map(({ files, warnings }, i) => {
    const inPages = asked[i]!.format === "svg" && (asked[i]!.paper ?? "") !== "";
    const page = inPages ? /^(cover|[0-9]{1,9})$/ : /^$/;
    const named = files.every((file) => page.test(file.page) && file.data.length > 0);
    if (!named || files.length === 0 || (!inPages && files.length > 1)) {
      throw badAnswer(`The server answered drawing ${i} without its files.`);
    }
    return { files, warnings: warningsOf(warnings) };
  });
}
