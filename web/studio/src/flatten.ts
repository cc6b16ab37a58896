// Puts the flatten page together.
import "./style.css";
import "./flat/style.css";

import { layoutTab, modelTab, seamsTab } from "./flat/fields.js";
import { LayoutView } from "./flat/layout_view.js";
import type { ModelView } from "./flat/model_view.js";
import { problemNotice, unitNotice } from "./flat/notices.js";
import { reportTab } from "./flat/report.js";
import { saveTab } from "./flat/saving.js";
import { gradient } from "./flat/strain.js";
import { Workshop } from "./flat/workshop.js";
import type { Tool } from "./flat/workshop.js";
import { button, h } from "./ui/dom.js";
import { Guide, keyHelp } from "./ui/guide.js";
import { head, onDrop, oncePerPicture, speaker, undoing } from "./ui/shell.js";
import { tabbed } from "./ui/tabs.js";
import { words } from "./words.js";

const { flat } = words;
const tools = Object.keys(flat.tool) as Tool[];

function start(): void {
  const root = document.getElementById("root")!;
  const shop = new Workshop();
  const views = [new LayoutView(shop, 0), new LayoutView(shop, 1)];
  let model: ModelView | null = null;

  // ---- the head
  const history = undoing(shop);
  const guide = new Guide(flat.guide, "arapd-studio-flatten-guide");
  const keys = keyHelp(flat.pointerList, flat.keyList);
  const help = button(words.help, () => {
    guide.open();
    keys.showModal();
  });

  // ---- the views with their tools
  const toolButtons = tools.map((tool) =>
    button(flat.tool[tool], () => shop.choose(tool), { "data-tool": tool }),
  );
  const hint = h("p", { class: "hint" });
  const all = (act: (view: { zoom(factor: number): void; fit(): void }) => void): void =>
    [model, ...views].forEach((view) => view && act(view));
  const toolbar = h(
    "div",
    { class: "tools-row" },
    h("div", { class: "toolset", role: "group", "aria-label": flat.tools }, ...toolButtons),
    h(
      "div",
      { class: "toolset" },
      button("−", () => all((view) => view.zoom(1 / 1.25)), { "aria-label": words.stage.zoomOut }),
      button(words.stage.fit, () => all((view) => view.fit())),
      button("+", () => all((view) => view.zoom(1.25)), { "aria-label": words.stage.zoomIn }),
    ),
    hint,
  );
  const captions = views.map(() => h("figcaption", {}));
  const modelFigure = h("figure", {}, h("figcaption", {}, flat.tabs.model));
  const figures = views.map((view, i) => h("figure", {}, captions[i], view.element));
  const legend = legendOf(shop);
  const notices = [unitNotice(shop), problemNotice(shop)];
  const place = h(
    "div",
    { class: "place flat" },
    toolbar,
    ...notices.map(({ element }) => element),
    h("div", { class: "views" }, modelFigure, ...figures),
    legend.element,
    guide.element,
  );

  // ---- the panel, what is said, and how it stands
  const tabs = [modelTab(shop), seamsTab(shop), layoutTab(shop), reportTab(shop), saveTab(shop)];
  const panel = tabbed(tabs, flat.tabs);
  const voice = speaker();
  shop.onSay((text, urgent) => voice.say(text, urgent));
  const foot = footer(shop);
  root.append(
    head("flatten", "model", flat.skip, ...history.buttons, help),
    h("main", {}, place, h("aside", { "aria-label": words.tabList }, panel.element)),
    foot.element,
    ...voice.elements,
    keys,
  );

  const sync = (): void => {
    const { tool } = shop.looks;
    history.sync();
    for (const one of toolButtons)
      one.setAttribute("aria-pressed", String(one.dataset["tool"] === tool));
    hint.textContent = flat.toolHints[tool];
    root.dataset["tool"] = tool;
    figures[1].hidden = shop.pattern.other === null;
    views.forEach((view, i) => {
      const { layouts } = shop.flat;
      const method = layouts[i]?.method ?? (i === 0 ? shop.pattern.method : shop.pattern.other);
      captions[i].textContent = method ? `${flat.tabs.layout}: ${flat.methods[method]}` : "";
      view.sync();
    });
    model?.sync();
    for (const notice of notices) notice.sync();
    for (const tab of tabs) if (!tab.element.hidden) tab.sync();
    legend.sync();
    foot.sync();
    if (shop.pattern.seams.length > 0) guide.done(2);
    else if (shop.history.undoable !== undefined || shop.surface?.file) guide.done(1);
  };
  shop.listen(oncePerPicture(sync));
  shop.onSaved = () => guide.close();
  onDrop((file) => void shop.openFile(file));
  window.addEventListener("pagehide", () => shop.flat.halt("cancelled"));
  window.addEventListener("pageshow", (event) => {
    if (event.persisted) shop.again();
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", sync);
  new MutationObserver(sync).observe(document.documentElement, { attributeFilter: ["data-theme"] });

  // What tests look at.
  Object.assign(window, { shop, views });
  void modelView(shop, modelFigure).then((view) => {
    model = view;
    Object.assign(window, { model: view });
    sync();
  });
  sync();
  shop.openSample(0);
}

// three.js comes when the rest of the page is there. Without it the page goes on.
async function modelView(shop: Workshop, figure: HTMLElement): Promise<ModelView | null> {
  try {
    const { ModelView } = await import("./flat/model_view.js");
    const view = new ModelView(shop);
    figure.append(view.element);
    return view;
  } catch {
    figure.append(
      h(
        "div",
        { class: "view model", id: "model", tabindex: -1 },
        h("p", { class: "nothing" }, flat.noModel),
      ),
    );
    return null;
  }
}

function legendOf(shop: Workshop): { element: HTMLElement; sync(): void } {
  const bar = h("span", { class: "bar", "aria-hidden": "true" });
  bar.style.background = gradient();
  const [low, high] = [h("span", {}), h("span", {})];
  const side = (value: HTMLElement, [short, more]: readonly [string, string]): HTMLElement =>
    h("span", { class: "side" }, value, ` ${short}`, h("span", { class: "more" }, `: ${more}`));
  const element = h(
    "div",
    { class: "legend" },
    h("strong", {}, flat.legend),
    side(low, flat.legendSmall),
    bar,
    side(high, flat.legendLarge),
  );
  return {
    element,
    sync() {
      low.textContent = flat.percent(-shop.flat.range);
      high.textContent = flat.percent(shop.flat.range);
      element.classList.toggle("pale", shop.flat.layouts.length === 0);
    },
  };
}

function footer(shop: Workshop): { element: HTMLElement; sync(): void } {
  const state = h("strong", { role: "status", "data-state": "" });
  const progress = h("progress", { max: 1, "aria-label": flat.state.working });
  const phase = h("span", { class: "phase" });
  const cancel = button(flat.cancel, () => shop.cancel(), { "data-job": "cancel" });
  const under = h("p", { class: "under", "data-under": "" });
  const job = h("div", { class: "job", hidden: true }, progress, phase, cancel);
  return {
    element: h("footer", { "aria-label": words.meter.label }, state, job, under),
    sync() {
      const { flat: now, looks } = shop;
      const layout = now.layouts[0];
      const text =
        now.state === "done" ? flat.state.done(layout?.pieces.length ?? 0) : flat.state[now.state];
      if (state.textContent !== text) state.textContent = text;
      state.dataset["state"] = { done: "live", failed: "lost" }[now.state as string] ?? now.state;
      job.hidden = !["reading", "waiting", "working"].includes(now.state);
      const { progress: how } = now;
      if (how && how.place === 0) progress.value = how.fraction;
      else progress.removeAttribute("value");
      phase.textContent = !how
        ? ""
        : how.place > 0
          ? flat.queue(how.place)
          : flat.phase(flat.phases[how.phase] ?? "", how.fraction);
      const triangle = looks.hover?.triangle ?? looks.chosenTriangle;
      under.textContent =
        triangle === null
          ? flat.under.none
          : layout
            ? flat.under.triangle(
                triangle,
                flat.piece(
                  layout.pieceOf[triangle] + 1,
                  layout.pieces[layout.pieceOf[triangle]].name,
                ),
                flat.percent(layout.principal[2 * triangle]),
                flat.percent(layout.principal[2 * triangle + 1]),
              )
            : flat.under.noLayout(triangle);
    },
  };
}

start();
