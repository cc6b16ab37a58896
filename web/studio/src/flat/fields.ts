// What is in the tabs of the flatten page that change the document: model, seams, layout.
import { button, check, choice, fileButton, h, slider } from "../ui/dom.js";
import { fieldsOf, section } from "../ui/tabs.js";
import type { Tab as AnyTab } from "../ui/tabs.js";
import { themeField } from "../ui/theme.js";
import { words } from "../words.js";
import { methods, units } from "./pattern.js";
import type { Grain, Method } from "./pattern.js";
import { samples } from "./samples.js";
import { runsOf } from "./seams.js";
import { extentOf } from "./surface.js";
import { thumbnail } from "./thumbnail.js";
import type { Workshop } from "./workshop.js";

export type Tab = AnyTab<keyof typeof words.flat.tabs>;
const { flat } = words;

export const files = ".obj,.ply,.stl,.glb,model/obj,model/stl,model/gltf-binary";
const mostListed = 40;

export const unitName = (millimetres: number): string =>
  flat.unitNames[String(millimetres)] ?? flat.mm(millimetres);

/** Makes a list anew only when what it lists is another, so that the focus stays in it. */
function listed(list: HTMLElement, key: unknown, make: () => HTMLElement[]): void {
  const known = list as HTMLElement & { key?: unknown };
  if (known.key === key) return;
  known.key = key;
  list.replaceChildren(...make());
}

export function modelTab(shop: Workshop): Tab {
  const cards = samples.map((sample, i) =>
    h(
      "button",
      { type: "button", class: "card", "data-sample": i, onclick: () => shop.openSample(i) },
      h("img", { src: thumbnail(sample.make()), alt: "", draggable: "false" }),
      h("span", {}, sample.name, h("small", {}, sample.hint)),
    ),
  );
  const open = fileButton(flat.open, files, (file) => void shop.openFile(file));
  const themed = fieldsOf([themeField()]);
  const facts = h("p", { class: "facts", "data-facts": "model" });
  const warnings = h("ul", { class: "facts" });
  const fields = fieldsOf([
    choice({
      label: flat.unit,
      values: Object.fromEntries(units.map(([, mm]) => [String(mm), unitName(mm)])),
      get: () => String(shop.pattern.millimetresPerUnit),
      set: (mm) => shop.change({ millimetresPerUnit: Number(mm) }, flat.steps.unit),
      disabled: () => !shop.surface,
    }),
    check({
      label: flat.mend,
      get: () => shop.pattern.mend,
      // Edges are numbered anew.
      set: (mend) => shop.change({ mend, seams: [] }, flat.steps.mend),
      disabled: () => !shop.surface,
    }),
  ]);
  return {
    name: "model",
    element: h(
      "div",
      { class: "tab" },
      section(
        flat.models,
        h("div", { class: "cards" }, ...cards),
        h("div", { class: "row" }, ...open),
        h("p", { class: "hint" }, flat.openHint),
      ),
      h(
        "section",
        {},
        facts,
        warnings,
        ...fields.elements,
        h("p", { class: "hint" }, flat.mendHint),
      ),
      section(flat.show, ...themed.elements),
    ),
    sync() {
      const { surface, pattern } = shop;
      fields.sync();
      themed.sync();
      cards.forEach((card, i) => {
        const isShown = surface?.file === null && surface.name === samples[i].name;
        card.setAttribute("aria-pressed", String(isShown));
      });
      facts.hidden = !surface;
      if (!surface) return;
      const size = extentOf(surface.vertices).size.map((one) => one * pattern.millimetresPerUnit);
      const said = size.map((one) => flat.mm(one)).join(" × ");
      facts.textContent = `${surface.name}: ${flat.facts(surface.triangles.length / 3, said)}`;
      listed(warnings, surface, () => surface.warnings.map((one) => h("li", {}, one)));
    },
  };
}

export function seamsTab(shop: Workshop): Tab {
  const auto = check({
    label: flat.autoCut,
    get: () => shop.pattern.autoCut,
    set: (autoCut) => shop.change({ autoCut }, flat.steps.autoCut),
  });
  const list = h("ul", { class: "list", "data-list": "seams" });
  const none = h("p", { class: "hint" }, flat.noSeams);
  const cuts = h("p", { class: "facts", "data-facts": "cuts" });
  const clear = button(flat.clearSeams, () => shop.change({ seams: [] }, flat.steps.clearSeams));
  return {
    name: "seams",
    element: h(
      "div",
      { class: "tab" },
      section(flat.seamList, none, list, h("div", { class: "row" }, clear)),
      h("section", {}, auto.element, h("p", { class: "hint" }, flat.autoCutHint), cuts),
    ),
    sync() {
      const { pattern, edges, layout } = shop;
      auto.sync();
      none.hidden = pattern.seams.length > 0;
      clear.disabled = pattern.seams.length === 0;
      const mm = pattern.millimetresPerUnit;
      listed(list, pattern, () =>
        edges
          ? runsOf(edges, pattern.seams)
              .slice(0, mostListed)
              .map((run) => {
                const length = flat.mm(run.length * mm);
                return h(
                  "li",
                  {
                    onpointerenter: () => shop.look({ preview: run.edges }),
                    onpointerleave: () => shop.look({ preview: [] }),
                  },
                  h("span", {}, flat.seam(run.edges.length, length)),
                  button(flat.remove, () => shop.seam(run.edges), {
                    "aria-label": flat.removeSeam(length),
                  }),
                );
              })
          : [],
      );
      const cut = (layout?.autoCuts ?? []).reduce((sum, edge) => sum + edges!.lengths[edge], 0);
      cuts.textContent = cut > 0 ? flat.autoCuts(flat.mm(cut * mm)) : "";
    },
  };
}

export function layoutTab(shop: Workshop): Tab {
  const other: Record<string, string> = { "": flat.none, ...flat.methods };
  const fields = fieldsOf([
    choice<Method>({
      label: flat.method,
      values: flat.methods,
      get: () => shop.pattern.method,
      set: (method) => shop.change({ method }, flat.steps.method),
    }),
    choice({
      label: flat.other,
      values: other,
      get: () => shop.pattern.other ?? "",
      set: (one) =>
        shop.change({ other: methods.find((known) => known === one) ?? null }, flat.steps.method),
    }),
    check({
      label: flat.injective,
      get: () => shop.pattern.injective,
      set: (injective) => shop.change({ injective }, flat.steps.method),
    }),
  ]);
  const pins = h("ul", { class: "list", "data-list": "pins" });
  const noPins = h("p", { class: "hint" }, flat.noPins);
  const clear = button(flat.clearPins, () => shop.change({ pins: [] }, flat.steps.clearPins));
  const grains = h("div", { class: "details", "data-list": "grains" });
  const noGrains = h("p", { class: "hint" }, flat.noGrains);
  let angles: { sync(): void } = { sync() {} };
  const pieceOf = (grain: Grain): string => {
    const corner = shop.surface!.triangles.indexOf(grain.from);
    const piece = shop.layout?.pieceOf[Math.floor(corner / 3)] ?? 0;
    return flat.piece(piece + 1, shop.layout?.pieces[piece]?.name ?? "");
  };
  function grainFields(): HTMLElement[] {
    const made = shop.pattern.grains.map((grain, i) => {
      const at = (): Grain => shop.pattern.grains[i] ?? grain;
      const piece = pieceOf(grain);
      const field = slider({
        label: flat.grainAngle(piece),
        min: -180,
        max: 180,
        step: 5,
        get: () => at().angle,
        set: (angle, done) => {
          if (done) {
            const changed = shop.pattern.grains.map((one, k) =>
              k === i ? { ...one, angle } : one,
            );
            shop.change({ grains: changed }, flat.steps.grain, `grain-${i}`);
          }
        },
        say: (value) => `${value}°`,
      });
      const remove = button(
        flat.remove,
        () => {
          const left = shop.pattern.grains.filter((_, k) => k !== i);
          shop.change({ grains: left }, flat.steps.removeGrain);
        },
        { "aria-label": flat.removeGrain(piece) },
      );
      return { field, element: h("div", {}, field.element, remove) };
    });
    angles = { sync: () => made.forEach(({ field }) => field.sync()) };
    return made.map(({ element }) => element);
  }
  return {
    name: "layout",
    element: h(
      "div",
      { class: "tab" },
      h("section", {}, ...fields.elements),
      section(flat.grains, noGrains, grains),
      section(flat.pins, noPins, pins, h("div", { class: "row" }, clear)),
    ),
    sync() {
      const { pattern } = shop;
      fields.sync();
      noPins.hidden = pattern.pins.length > 0;
      noGrains.hidden = pattern.grains.length > 0;
      clear.disabled = pattern.pins.length === 0;
      const mm = pattern.millimetresPerUnit;
      listed(pins, pattern.pins, () =>
        pattern.pins.map(({ vertex, u, v }) =>
          h(
            "li",
            {},
            h("span", {}, flat.pin(flat.mm(u * mm), flat.mm(v * mm))),
            button(flat.remove, () => shop.removePin(vertex), {
              "aria-label": flat.removePin(vertex),
            }),
          ),
        ),
      );
      listed(grains, pattern.grains.map(({ from, to }) => `${from}-${to}`).join(), grainFields);
      angles.sync();
    },
  };
}
