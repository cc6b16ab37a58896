// What the page asks or has to say beside the views: about the unit, and why there is no layout.
import { button, h } from "../ui/dom.js";
import { words } from "../words.js";
import { unitName } from "./fields.js";
import { units } from "./pattern.js";
import type { Surface } from "./surface.js";
import type { Workshop } from "./workshop.js";

const { flat } = words;
const mended = /^(NON_MANIFOLD|DEGENERATE|DUPLICATE|REPEATED|NOT_ORIENTABLE)/;

interface Notice {
  element: HTMLElement;
  sync(): void;
}

/** Asks for the unit while the size looks wrong, until somebody has answered. */
export function unitNotice(shop: Workshop): Notice {
  const text = h("p", {});
  const answered = new WeakSet<Surface>();
  const choices = units.map(([name, mm]) => {
    const one = button("", () => {
      answered.add(shop.surface!);
      shop.change({ millimetresPerUnit: mm }, flat.steps.unit);
    });
    return { one, name, mm };
  });
  const element = h(
    "section",
    { class: "notice", "aria-label": flat.unit, "data-notice": "unit" },
    text,
    h("div", { class: "row" }, ...choices.map(({ one }) => one)),
  );
  let asked: Surface | null = null;
  return {
    element,
    sync() {
      const { surface, pattern } = shop;
      element.hidden = !surface || !shop.isSizeUnlikely || answered.has(surface);
      if (element.hidden || !surface) return;
      const { size } = shop;
      text.textContent = flat.askUnit(flat.mm(size));
      for (const { one, mm } of choices) {
        const long = flat.mm((size / pattern.millimetresPerUnit) * mm);
        one.textContent = flat.askUnitFor(unitName(mm), long);
      }
      if (asked !== surface) shop.say(text.textContent);
      asked = surface;
    },
  };
}

/** Says why there is no layout, and what may help. */
export function problemNotice(shop: Workshop): Notice {
  const text = h("p", {});
  const cut = button(flat.cutForMe, () => shop.change({ autoCut: true }, flat.steps.autoCut));
  const mend = button(flat.mendForMe, () =>
    shop.change({ mend: true, seams: [] }, flat.steps.mend),
  );
  const again = button(flat.again, () => shop.again());
  const element = h(
    "section",
    { class: "notice wrong", role: "alert", "data-notice": "problem" },
    text,
    h("div", { class: "row" }, cut, mend, again),
  );
  return {
    element,
    sync() {
      const { problem, state } = shop.flat;
      const { autoCut, mend: mends } = shop.pattern;
      element.hidden = !problem && state !== "cancelled";
      if (element.hidden) return;
      const said = problem?.status === 0 ? words.state.unreachable : problem?.message;
      const sentence = problem ? words.wentWrong(said ?? "") : flat.said.cancelled;
      if (text.textContent !== sentence) text.textContent = sentence;
      cut.hidden = autoCut || problem?.reason !== "NOT_A_DISK";
      mend.hidden = mends || !mended.test(problem?.reason ?? "");
    },
  };
}
