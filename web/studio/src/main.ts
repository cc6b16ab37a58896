// Puts the page together.
import "./style.css";

import { Studio } from "./studio.js";
import { Takes } from "./takes.js";
import { button, h } from "./ui/dom.js";
import { Guide, keyHelp } from "./ui/guide.js";
import { motionTab, pinsTab, puppetTab, tabbed } from "./ui/panel.js";
import { saveTab } from "./ui/save_tab.js";
import { takeTab } from "./ui/take_tab.js";
import { Stage } from "./view/stage.js";
import { words } from "./words.js";

function start(): void {
  const root = document.getElementById("root")!;
  document.title = words.title;
  const studio = new Studio();
  const takes = new Takes(studio);
  let stage: Stage;
  try {
    stage = new Stage(studio, takes);
  } catch {
    root.append(h("p", { role: "alert", class: "fatal" }, words.noWebGL));
    return;
  }

  // ---- the head: title, history, help, colours
  const undo = button(words.undo, () => studio.undo());
  const redo = button(words.redo, () => studio.redo());
  const guide = new Guide(studio);
  const keys = keyHelp();
  const help = button(words.help, () => {
    guide.open();
    keys.showModal();
  });
  const head = h(
    "header",
    {},
    h("a", { class: "skip", href: "#stage" }, words.skip),
    h("h1", {}, words.title),
    h("div", { class: "row tools" }, undo, redo, help),
  );

  // ---- the stage with its tools
  const tools = (["pins", "starch"] as const).map((tool) =>
    button(words.stage[tool], () => studio.look({ tool }), { "data-tool": tool }),
  );
  const toolbar = h(
    "div",
    { class: "toolbar", role: "group", "aria-label": words.stage.tools },
    ...tools,
    h("span", { class: "gap" }),
    button("−", () => stage.zoom(1 / 1.25), { "aria-label": words.stage.zoomOut }),
    button(words.stage.fit, () => stage.fit()),
    button("+", () => stage.zoom(1.25), { "aria-label": words.stage.zoomIn }),
  );
  const place = h("div", { class: "place" }, stage.element, toolbar, guide.element);

  // ---- the panel
  const tabs = [
    puppetTab(studio),
    pinsTab(studio),
    motionTab(studio),
    takeTab(studio, takes),
    saveTab(studio, takes),
  ];
  const panel = tabbed(tabs);
  // What can be said of a pin is beside it, unless somebody is busy with something else there.
  stage.onPick = () => {
    if (!tabs[0].element.hidden) panel.show("pins");
  };

  // ---- what is said, and the read-outs
  const polite = h("p", { class: "unseen", role: "status" });
  const toast = h("div", { class: "toast", role: "alert" });
  let hide: ReturnType<typeof setTimeout>;
  studio.onSay((text, urgent) => {
    if (!urgent) {
      polite.textContent = text;
      return;
    }
    clearTimeout(hide);
    toast.replaceChildren(
      h("p", {}, text),
      button("×", () => toast.replaceChildren(), { "aria-label": words.close }),
    );
    hide = setTimeout(() => toast.replaceChildren(), 12_000);
  });
  const meters = readouts(studio);

  root.append(
    head,
    h("main", {}, place, h("aside", { "aria-label": words.tabList }, panel.element)),
    meters.element,
    polite,
    toast,
    keys,
  );

  // ---- all of it follows the document, once per picture
  let asked = false;
  const sync = (): void => {
    asked = false;
    undo.disabled = studio.history.undoable === undefined;
    redo.disabled = studio.history.redoable === undefined;
    undo.title = studio.history.undoable ? words.undoWhat(studio.history.undoable) : "";
    redo.title = studio.history.redoable ? words.redoWhat(studio.history.redoable) : "";
    for (const tool of tools) {
      tool.setAttribute("aria-pressed", String(tool.dataset["tool"] === studio.looks.tool));
    }
    stage.element.dataset["tool"] = studio.looks.tool;
    for (const tab of tabs) if (!tab.element.hidden) tab.sync();
    meters.sync();
  };
  const ask = (): void => {
    if (asked) return;
    asked = true;
    requestAnimationFrame(sync);
  };
  studio.listen(ask);
  takes.listen(ask);
  // The read-outs are of the last seconds, and go down when nothing happens.
  setInterval(() => meters.sync(), 500);

  document.addEventListener("keydown", (event) => {
    if (!(event.ctrlKey || event.metaKey) || event.altKey) return;
    const key = event.key.toLowerCase();
    if (key === "z" && event.shiftKey) studio.redo();
    else if (key === "z") studio.undo();
    else if (key === "y") studio.redo();
    else return;
    event.preventDefault();
  });
  for (const kind of ["dragover", "drop"] as const) {
    document.addEventListener(kind, (event) => {
      event.preventDefault();
      const file = kind === "drop" ? event.dataTransfer?.files[0] : undefined;
      if (file) void studio.openFile(file);
    });
  }

  window.addEventListener("pagehide", () => studio.session.leave());

  // What tests look at.
  Object.assign(window, { studio, takes, stage });
  sync();
  void studio.openSample(0);
}

function readouts(studio: Studio): { element: HTMLElement; sync(): void } {
  const state = h("strong", { role: "status", "data-state": "" });
  const { meter } = studio;
  const ms = (value: number | undefined): string =>
    value === undefined ? words.meter.nothing : words.meter.ms(value);
  const values: [string, string, () => string][] = [
    ["server", words.meter.server, () => ms(meter.server.median())],
    ["network", words.meter.network, () => ms(meter.network.median())],
    ["frame", words.meter.frame, () => ms(meter.frame.median())],
    ["lag", words.meter.lag, () => ms(meter.lag.median())],
    ["rate", words.meter.rate, () => words.meter.rateValue(meter.shapes.rate())],
    ["flips", words.meter.flips, () => String(studio.flipped.length)],
  ];
  const outputs = values.map(([key]) => h("dd", { "data-meter": key }));
  const element = h(
    "footer",
    { "aria-label": words.meter.label },
    state,
    h("dl", {}, ...values.map(([, name], i) => h("div", {}, h("dt", {}, name), outputs[i]))),
  );
  return {
    element,
    sync() {
      const late = studio.connection === "live" && studio.waiting > 2000;
      const now = late ? "waiting" : studio.connection;
      const text = words.state[now];
      if (state.textContent !== text) state.textContent = text;
      state.dataset["state"] = now;
      values.forEach(([, , value], i) => (outputs[i].textContent = value()));
    },
  };
}

start();
