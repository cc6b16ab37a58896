// Puts the puppet page together.
import "./style.css";

import { Studio } from "./studio.js";
import { Takes } from "./takes.js";
import { button, h, mark, write } from "./ui/dom.js";
import { Guide, keyHelp } from "./ui/guide.js";
import { motionTab, pinsTab, puppetTab } from "./ui/panel.js";
import { saveTab } from "./ui/save_tab.js";
import { head, onDrop, oncePerPicture, speaker, undoing } from "./ui/shell.js";
import { tabbed } from "./ui/tabs.js";
import { takeTab } from "./ui/take_tab.js";
import { Stage } from "./view/stage.js";
import { words } from "./words.js";

function start(): void {
  const root = document.getElementById("root")!;
  const studio = new Studio();
  const takes = new Takes(studio);
  const stage = new Stage(studio, takes);

  // ---- the head: history, help
  const history = undoing(studio);
  const guide = new Guide(words.guide.steps, "arapd-studio-guide");
  const keys = keyHelp(words.guide.pointerList, words.guide.keyList);
  const help = button(words.help, () => {
    guide.open();
    keys.showModal();
  });

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
  const panel = tabbed(tabs, words.tabs);
  // What can be said of a pin is beside it, unless somebody is busy with something else there.
  stage.onPick = () => {
    if (!tabs[0].element.hidden) panel.show("pins");
  };

  // ---- what is said, and the read-outs
  const voice = speaker();
  studio.onSay((text, urgent) => voice.say(text, urgent));
  const meters = readouts(studio);

  root.append(
    head("puppet", "stage", words.skip, ...history.buttons, help),
    h("main", {}, place, h("aside", { "aria-label": words.tabList }, panel.element)),
    meters.element,
    ...voice.elements,
    keys,
  );

  // ---- all of it follows the document, once per picture
  const sync = (): void => {
    history.sync();
    for (const tool of tools) {
      mark(tool, "aria-pressed", String(tool.dataset["tool"] === studio.looks.tool));
    }
    stage.element.dataset["tool"] = studio.looks.tool;
    for (const tab of tabs) if (!tab.element.hidden) tab.sync();
    meters.say();
  };
  const ask = oncePerPicture(sync);
  studio.listen(ask);
  let first: number | undefined;
  studio.listen(() => {
    const { body, figure, pins } = studio.puppet;
    if (!body) return;
    first ??= figure;
    if (pins.length >= 3) guide.done(2);
    else if (figure !== first || pins.length > 0) guide.done(1);
  });
  takes.listen(ask);
  // The read-outs are of the last seconds, and go down when nothing happens. Oftener nobody could read them.
  setInterval(() => meters.sync(), 250);

  onDrop((file) => void studio.openFile(file));
  window.addEventListener("pagehide", () => studio.session.leave());

  // What tests look at.
  Object.assign(window, { studio, takes, stage });
  sync();
  void studio.openSample(0);
}

/** `say` how the connection is, which is quick; `sync` also what is measured. */
function readouts(studio: Studio): { element: HTMLElement; say(): void; sync(): void } {
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
  const say = (): void => {
    const late = studio.connection === "live" && studio.waiting > 2000;
    const now = late ? "waiting" : studio.connection;
    write(state, words.state[now]);
    mark(state, "data-state", now);
  };
  const element = h(
    "footer",
    { "aria-label": words.meter.label },
    state,
    h("dl", {}, ...values.map(([, name], i) => h("div", {}, h("dt", {}, name), outputs[i]))),
  );
  return {
    element,
    say,
    sync() {
      say();
      values.forEach(([, , value], i) => write(outputs[i], value()));
    },
  };
}

start();
