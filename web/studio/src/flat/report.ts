// What is said about layouts: of one, or of two beside each other.
import { h } from "../ui/dom.js";
import { words } from "../words.js";
import type { Tab } from "./fields.js";
import type { Layout, Piece } from "./layout.js";
import type { Workshop } from "./workshop.js";

const { flat } = words;
const mostPieces = 30;

const round = (value: number, digits = 3): string => String(Number(value.toPrecision(digits)));
const pair = (mean: number, most: number, unit: string): string =>
  `${round(mean)} / ${round(most)}\u00a0${unit}`;

type Row = readonly [name: string, of: (layout: Layout) => string, key: string];

function rowsOf(shop: Workshop): Row[] {
  const mm = shop.pattern.millimetresPerUnit;
  const edges = shop.edges!;
  const report = flat.report;
  const area = (value: number): string => report.cm2((value * mm * mm) / 100);
  const sum = (layout: Layout, of: (piece: Piece) => number): number =>
    layout.pieces.reduce((total, piece) => total + of(piece), 0);
  const seams = (layout: Layout): number =>
    [...shop.pattern.seams, ...layout.autoCuts].reduce((all, edge) => all + edges.lengths[edge], 0);
  return [
    [report.pieces, ({ pieces }) => String(pieces.length), "pieces"],
    [report.triangles, ({ strain }) => String(strain.length), "triangles"],
    [
      report.stretch,
      ({ distortion: d }) => pair(d.meanStretchPercent, d.maxStretchPercent, "%"),
      "stretch",
    ],
    [
      report.compression,
      ({ distortion: d }) => pair(d.meanCompressionPercent, d.maxCompressionPercent, "%"),
      "compression",
    ],
    [
      report.angle,
      ({ distortion: d }) => pair(d.meanAngleDegrees, d.maxAngleDegrees, "°"),
      "angle",
    ],
    [report.flipped, ({ distortion }) => String(distortion.flipped), "flipped"],
    [report.energy, ({ distortion }) => round(distortion.arapEnergy), "energy"],
    [report.area, (layout) => area(sum(layout, (piece) => piece.area)), "area"],
    [report.onModel, (layout) => area(sum(layout, (piece) => piece.areaOnSurface)), "surface"],
    [report.seams, (layout) => flat.mm(seams(layout) * mm), "seams"],
    [report.overlaps, ({ overlaps }) => (overlaps ? report.yes : report.no), "overlaps"],
  ];
}

// Sizes of the pieces, each in a row: the same in both layouts, as both are cut alike.
function pieceRows(shop: Workshop): Row[] {
  const mm = shop.pattern.millimetresPerUnit;
  const { layout, looks } = shop;
  if (!layout) return [];
  const chosen = looks.chosenTriangle === null ? -1 : layout.pieceOf[looks.chosenTriangle];
  return layout.pieces.slice(0, mostPieces).map(
    ({ name }, i): Row => [
      i === chosen ? flat.report.chosen(flat.piece(i + 1, name)) : flat.piece(i + 1, name),
      ({ pieces }) => {
        const piece = pieces[i];
        return piece ? flat.report.size(flat.mm(piece.width * mm), flat.mm(piece.height * mm)) : "";
      },
      `piece-${i + 1}`,
    ],
  );
}

export function reportTab(shop: Workshop): Tab {
  const none = h("p", { class: "hint" }, flat.report.none);
  const table = h("table", {});
  const more = h("p", { class: "hint" });
  const warnings = h("ul", { class: "facts", "data-list": "warnings" });
  let shown: unknown[] = [];
  return {
    name: "report",
    element: h("div", { class: "tab" }, h("section", {}, none, table, more), warnings),
    sync() {
      const { layouts } = shop.flat;
      none.hidden = layouts.length > 0;
      table.hidden = warnings.hidden = layouts.length === 0;
      const now = [layouts, shop.pattern.millimetresPerUnit, shop.looks.chosenTriangle];
      if (now.every((value, i) => value === shown[i])) return;
      shown = now;
      if (layouts.length === 0) return table.replaceChildren();
      const body = [...rowsOf(shop), ...pieceRows(shop)].map(([name, of, key]) =>
        h(
          "tr",
          { "data-row": key },
          h("th", { scope: "row" }, name),
          ...layouts.map((layout) => h("td", {}, of(layout))),
        ),
      );
      table.replaceChildren(
        h("caption", {}, flat.report.caption),
        h(
          "thead",
          {},
          h(
            "tr",
            {},
            h("th", { scope: "col" }, flat.report.what),
            ...layouts.map(({ method }) => h("th", { scope: "col" }, flat.methods[method])),
          ),
        ),
        h("tbody", {}, ...body),
      );
      const left = layouts[0].pieces.length - mostPieces;
      more.textContent = left > 0 ? flat.report.morePieces(left) : "";
      const said = [...new Set(layouts.flatMap((layout) => layout.warnings))];
      warnings.replaceChildren(...said.map((one) => h("li", {}, one)));
    },
  };
}
