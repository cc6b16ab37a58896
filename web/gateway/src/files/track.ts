// A TRACK.json of arapctl as the track route takes it. What belongs to the mesh and to the handles, which are
// registered already, is passed over.
import type { Static } from "@sinclair/typebox";

import { Problem } from "../problems.js";
import type { TrackBody, TrackFile } from "../schemas/handles.js";

type Body = Static<typeof TrackBody>;
type File = Static<typeof TrackFile>;

/** Whether a body that nobody has checked yet is one. */
export function isTrackFile(body: unknown): body is File {
  const { frames } = (body ?? {}) as { frames?: unknown };
  const [first] = Array.isArray(frames) ? (frames as unknown[]) : [];
  return typeof first === "object" && first !== null && "targets" in first;
}

const wrong = (field: string, sentence: string): Problem =>
  new Problem("MALFORMED", `${field} ${sentence}`, { field });

/** Of a checked one. A target that is null is one of a lost marker: the handle keeps its last. */
export function bodyOfTrack(file: File): Body {
  if ((file.edits ?? []).length > 0)
    throw wrong(
      "edits",
      "cannot be made here: a track of this route has one handle set throughout.",
    );
  const handles = file.handles.map(({ name }, k) => name ?? `h${k}`);
  const count = handles.length;
  const x = file.handles.map(({ rest }) => rest[0]);
  const y = file.handles.map(({ rest }) => rest[1]);
  const angles = new Array<number>(count).fill(0);
  const scales = new Array<number>(count).fill(1);
  const turns = file.frames.some((frame) => frame.angles);
  const grows = file.frames.some((frame) => frame.scales);
  const frames = file.frames.map((frame, f) => {
    for (const list of ["targets", "angles", "scales"] as const) {
      const length = frame[list]?.length ?? count;
      if (length !== count)
        throw wrong(
          `frames[${f}].${list}`,
          `has ${length} entries, and there are ${count} handles.`,
        );
    }
    frame.targets.forEach((target, k) => {
      if (target) {
        [x[k], y[k]] = target;
        if (!frame.angles) angles[k] = 0;
        if (!frame.scales) scales[k] = 1;
      }
      angles[k] = frame.angles?.[k] ?? angles[k]!;
      scales[k] = frame.scales?.[k] ?? scales[k]!;
    });
    return {
      positions: x.flatMap((value, k) => [value, y[k]!]),
      ...(turns && { angles: angles.slice() }),
      ...(grows && { scales: scales.slice() }),
    };
  });
  return { handles, frames, ...optionsOf(file) };
}

// What an application may add to the file.
function optionsOf({
  mode,
  refine,
  flippedIds,
  measureEvery,
  boundaryOnly,
  vertexSubset,
  encoding,
  float64,
}: File) {
  const shape = { mode, refine, flippedIds, measureEvery, boundaryOnly, vertexSubset };
  const all = { ...shape, encoding, float64 };
  return Object.fromEntries(Object.entries(all).filter(([, value]) => value !== undefined));
}
