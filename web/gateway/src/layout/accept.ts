// Which kind of answer a request accepts.
import { Problem } from "../problems.js";

export type AnswerKind = "json" | "svg" | "dxf" | "pdf" | "obj";

const mediaTypes: readonly (readonly [string, AnswerKind])[] = [
  ["application/json", "json"],
  ["image/svg+xml", "svg"],
  ["image/vnd.dxf", "dxf"],
  ["application/dxf", "dxf"],
  ["application/pdf", "pdf"],
  ["model/obj", "obj"],
];

export const mediaTypeOf = (kind: AnswerKind): string =>
  mediaTypes.find(([, one]) => one === kind)![0];

export const kindOf = (accept: string | undefined): AnswerKind => acceptedOf(accept, mediaTypes);

/**
 * The best of what Accept lists, by its qualities and then by our order. NOT_ACCEPTABLE when there
 * is none.
 */
export function acceptedOf<Kind>(
  accept: string | undefined,
  mediaTypes: readonly (readonly [string, Kind])[],
): Kind {
  const ranges = (accept?.trim() || "*/*")
    .slice(0, 2000)
    .split(",")
    .map((range) => {
      const [type = "", ...parameters] = range.split(";").map((part) => part.trim().toLowerCase());
      const quality = parameters
        .find((parameter) => /^q\s*=/.test(parameter))
        ?.replace(/^q\s*=\s*/, "");
      return { type, quality: quality === undefined ? 1 : Number(quality) || 0 };
    });
  // The most specific range decides on the quality of a type.
  const qualityOf = (media: string): number => {
    const wanted = [media, `${media.split("/")[0]}/*`, "*/*"];
    for (const type of wanted) {
      const range = ranges.find((one) => one.type === type);
      if (range) return range.quality;
    }
    return 0;
  };
  let best: Kind | undefined;
  let most = 0;
  for (const [media, kind] of mediaTypes) {
    const quality = qualityOf(media);
    if (quality > most) [best, most] = [kind, quality];
  }
  if (best !== undefined) return best;
  throw new Problem(
    "NOT_ACCEPTABLE",
    `What can be answered is ${mediaTypes.map(([media]) => media).join(", ")}.`,
  );
}
