// What is in the puppet page's tabs. Takes and saving have files of their own.
import { samples } from "../samples/index.js";
import type { Studio } from "../studio.js";
import { words } from "../words.js";
import { button, check, choice, fileButton, freshName, h, slider } from "./dom.js";
import { fieldsOf, section } from "./tabs.js";
import type { Tab as AnyTab } from "./tabs.js";
import { themeField } from "./theme.js";

export type Tab = AnyTab<keyof typeof words.tabs>;

export function puppetTab(studio: Studio): Tab {
  const picture = "image/png,image/webp,image/svg+xml,image/gif,image/avif";
  const open = fileButton(words.puppet.open, picture, (file) => void studio.openFile(file));
  const cards = samples.map((sample, i) =>
    h(
      "button",
      { type: "button", class: "card", onclick: () => void studio.openSample(i) },
      h("img", { src: sample.source, alt: "", draggable: "false" }),
      h("span", {}, sample.name, h("small", {}, sample.hint)),
    ),
  );
  const cut = () => studio.pendingCut ?? studio.puppet.cut;
  const set = (change: object, done: boolean): void => {
    if (done) void studio.cut({ ...cut(), ...change });
  };
  const disabled = (): boolean => studio.puppet.body === null;
  const fields = fieldsOf([
    slider({
      label: words.puppet.density,
      min: 2,
      max: 3.9,
      step: 0.05,
      get: () => Math.log10(cut().vertices),
      set: (value, done) => set({ vertices: Math.round(10 ** value) }, done),
      say: (value) => `${Math.round(10 ** value)}`,
      disabled,
    }),
    slider({
      label: words.puppet.expansion,
      min: 0,
      max: 40,
      get: () => cut().expansion,
      set: (expansion, done) => set({ expansion }, done),
      say: (value) => `${value} px`,
      disabled,
    }),
    slider({
      label: words.puppet.tolerance,
      min: 0.25,
      max: 8,
      step: 0.25,
      get: () => cut().tolerance,
      set: (tolerance, done) => set({ tolerance }, done),
      say: (value) => `${value} px`,
      disabled,
    }),
    slider({
      label: words.puppet.threshold,
      min: 1,
      max: 255,
      get: () => cut().threshold,
      set: (threshold, done) => set({ threshold }, done),
      say: (value) => `${Math.round(value / 2.55)} %`,
      disabled,
    }),
  ]);
  const facts = h("p", { class: "facts", "data-facts": "mesh" });
  const element = h(
    "div",
    { class: "tab" },
    section(
      words.puppet.choose,
      h("div", { class: "cards" }, ...cards),
      h("div", { class: "row" }, ...open),
      h("p", { class: "hint" }, words.puppet.openHint),
    ),
    section(words.puppet.mesh, ...fields.elements, facts),
  );
  return {
    name: "puppet",
    element,
    sync() {
      fields.sync();
      cards.forEach((card, i) =>
        card.setAttribute("aria-pressed", String(studio.figure?.name === samples[i].name)),
      );
      const { body } = studio.puppet;
      const known = studio.facts;
      const lines: string[] = [];
      if (studio.working) lines.push(words.puppet.working);
      else if (body && known) {
        const count = [body.rest.length / 2, body.triangles.length / 3] as const;
        lines.push(`${words.puppet.facts(...count, known.pieces, known.holes)}.`);
        lines.push(words.puppet.error(known.error));
        if (known.dropped > 0) lines.push(words.puppet.dropped(known.dropped));
      }
      facts.textContent = lines.join(" ");
    },
  };
}

export function pinsTab(studio: Studio): Tab {
  const pin = () => studio.chosen;
  const change = (what: object, done = true): void => {
    const chosen = pin();
    if (chosen) studio.changePin(chosen.id, what, done);
  };
  const degrees = 180 / Math.PI;
  const select = h("select", {
    id: freshName(),
    onchange: () => studio.look({ chosen: select.value || null }),
  });
  const turned = () => !(pin()?.turns || (pin()?.area ?? 0) > 0);
  const weight = slider({
    label: words.pin.weight,
    min: -3,
    max: 4,
    step: 0.25,
    get: () => Math.log10(pin()?.weight ?? 1),
    set: (value, done) => change({ weight: 10 ** value }, done),
    say: (value) => `${Number((10 ** value).toPrecision(2))}`,
  });
  const fields = fieldsOf([
    choice({
      label: words.pin.hold,
      values: { exact: words.pin.exact, firm: words.pin.firm, soft: words.pin.soft },
      get: () => pin()?.firmness ?? "firm",
      set: (firmness) => change({ firmness }),
    }),
    weight,
    check({
      label: words.pin.turns,
      get: () => pin()?.turns ?? false,
      set: (turns) => change({ turns }),
    }),
    slider({
      label: words.pin.angle,
      min: -180,
      max: 180,
      step: 1,
      get: () => Math.round((pin()?.angle ?? 0) * degrees),
      set: (value, done) => change({ angle: value / degrees }, done),
      say: (value) => `${Math.round(value)}°`,
      disabled: turned,
    }),
    slider({
      label: words.pin.scale,
      min: 0.4,
      max: 2.5,
      step: 0.05,
      get: () => pin()?.scale ?? 1,
      set: (scale, done) => change({ scale }, done),
      say: (value) => `${Math.round(100 * value)} %`,
      disabled: turned,
    }),
    slider({
      label: words.pin.area,
      min: 0,
      max: 200,
      step: 5,
      get: () => pin()?.area ?? 0,
      set: (area, done) => change({ area }, done),
      say: (value) => `${value} px`,
    }),
    slider({
      label: words.pin.depth,
      min: -5,
      max: 5,
      step: 1,
      get: () => pin()?.depth ?? 0,
      set: (depth, done) => change({ depth }, done),
      say: (value) => (value > 0 ? `+${value}` : String(value)),
    }),
  ]);
  const none = h("p", { class: "hint" }, words.pin.none);
  const details = h(
    "div",
    { class: "details" },
    ...fields.elements,
    h("p", { class: "hint" }, words.pin.depthHint),
    h(
      "div",
      { class: "row" },
      button(words.pin.remove, () => pin() && studio.removePin(pin()!.id)),
      button(words.pin.removeKeep, () => pin() && studio.removePin(pin()!.id, true)),
    ),
  );
  const all = [
    button(words.pin.suggest, () => studio.suggestPins(), { class: "main" }),
    button(words.pin.rest, () => studio.rest()),
    button(words.pin.keep, () => studio.keepPose()),
    button(words.pin.all, () => studio.removeAllPins()),
  ];
  const element = h(
    "div",
    { class: "tab" },
    h(
      "section",
      {},
      h("h2", {}, words.tabs.pins),
      h("div", { class: "row" }, ...all.slice(0, 2)),
      h("div", { class: "field choice" }, h("label", { for: select.id }, words.pin.choose), select),
      none,
      details,
    ),
    h("section", {}, h("div", { class: "row" }, ...all.slice(2))),
  );
  return {
    name: "pins",
    element,
    sync() {
      const { pins, body } = studio.puppet;
      const ids = pins.map((one) => one.id).join();
      if (select.dataset["ids"] !== ids) {
        select.dataset["ids"] = ids;
        select.replaceChildren(
          h("option", { value: "" }, words.pin.noneShort),
          ...pins.map((one) => h("option", { value: one.id }, words.pin.title(one.id))),
        );
      }
      select.value = pin()?.id ?? "";
      none.hidden = pin() !== undefined;
      details.hidden = pin() === undefined;
      weight.element.hidden = pin()?.firmness !== "soft";
      fields.sync();
      all.forEach((one, i) => (one.disabled = !body || (i > 0 && pins.length === 0)));
    },
  };
}

export function motionTab(studio: Studio): Tab {
  const motion = () => studio.puppet.motion;
  const fields = fieldsOf([
    choice({
      label: words.motion.mode,
      values: words.motion.modes,
      get: () => motion().mode,
      set: (mode) => studio.setMotion({ mode }),
    }),
    choice({
      label: words.motion.basis,
      values: words.motion.bases,
      get: () => motion().basis,
      set: (basis) => studio.setMotion({ basis }),
    }),
    choice({
      label: words.motion.weights,
      values: words.motion.weightKinds,
      get: () => motion().weights,
      set: (weights) => studio.setMotion({ weights }),
    }),
    slider({
      label: words.motion.refine,
      min: 0,
      max: 10,
      get: () => motion().refine,
      set: (refine, done) => studio.setMotion({ refine }, done),
      say: words.motion.rounds,
    }),
    choice({
      label: words.motion.when,
      values: words.motion.whens,
      get: () => studio.looks.follow,
      set: (follow) => studio.look({ follow }),
    }),
  ]);
  const brush = fieldsOf([
    slider({
      label: words.motion.radius,
      min: 5,
      max: 150,
      step: 5,
      get: () => studio.looks.brush.radius,
      set: (radius) => studio.look({ brush: { ...studio.looks.brush, radius } }),
      say: (value) => `${value} px`,
    }),
    slider({
      label: words.motion.amount,
      min: 0,
      max: 2,
      step: 0.25,
      get: () => Math.log10(studio.looks.brush.amount),
      set: (value) =>
        studio.look({ brush: { ...studio.looks.brush, amount: Math.round(10 ** value) } }),
      say: (value) => words.motion.amountValue(Math.round(10 ** value)),
    }),
  ]);
  const wash = button(words.motion.clear, () => studio.wash());
  const show = fieldsOf([
    check({
      label: words.motion.wire,
      get: () => studio.looks.wire,
      set: (wire) => studio.look({ wire }),
    }),
    check({
      label: words.motion.flips,
      get: () => studio.looks.flips,
      set: (flips) => studio.look({ flips }),
    }),
    check({
      label: words.motion.onion,
      get: () => studio.looks.onion,
      set: (onion) => studio.look({ onion }),
    }),
    themeField(),
  ]);
  const element = h(
    "div",
    { class: "tab" },
    section(words.motion.feel, ...fields.elements),
    section(words.motion.show, ...show.elements),
    section(
      words.motion.starch,
      h("p", { class: "hint" }, words.motion.starchHint),
      ...brush.elements,
      h("div", { class: "row" }, wash),
    ),
  );
  return {
    name: "motion",
    element,
    sync() {
      fields.sync();
      brush.sync();
      show.sync();
      wash.disabled = studio.puppet.starch === null;
    },
  };
}
