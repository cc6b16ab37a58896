// The layout as files, which the server draws.
import { textBytes, zip } from "../save/zip.js";
import { amount, button, check, choice, download, h } from "../ui/dom.js";
import { fieldsOf, section } from "../ui/tabs.js";
import { words } from "../words.js";
import { sentenceOf } from "./flattening.js";
import type { Tab } from "./fields.js";
import type { Answer } from "./net.js";
import type { Workshop } from "./workshop.js";

const { save } = words.flat;
type Kind = keyof typeof save.formats;
const kinds: readonly Kind[] = ["pdf", "svg", "dxf", "obj"];
const mediaTypes: Record<Kind, string> = {
  pdf: "application/pdf",
  svg: "image/svg+xml",
  dxf: "image/vnd.dxf",
  obj: "model/obj",
};

/** How it is drawn: what nobody takes back. */
interface Drawing {
  paper: string;
  roll: number;
  allowance: number;
  corners: keyof typeof save.cornerKinds;
  notches: boolean;
  plain: boolean;
}

function optionsOf(kind: Kind, drawing: Drawing, millimetresPerUnit: number): object {
  const { paper, roll, allowance, corners, notches, plain } = drawing;
  const isPaged = paper !== "" && paper !== "roll" && kind !== "dxf";
  return {
    format: kind,
    millimetresPerUnit,
    allowance,
    corners,
    notches,
    ...(paper === "roll" && { sheetWidth: roll }),
    ...(isPaged ? { paper } : kind !== "dxf" && { plain }),
  };
}

const bytesOf = (base64: string): Uint8Array =>
  Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));

export function saveTab(shop: Workshop): Tab {
  const drawing: Drawing = {
    paper: "",
    roll: 1400,
    allowance: 10,
    corners: "mitre",
    notches: true,
    plain: false,
  };
  const working = h("p", { role: "status", class: "facts" });
  let stop: AbortController | null = null;
  const cancel = button(words.flat.cancel, () => stop?.abort(), { "data-save": "cancel" });
  const warnings = h("ul", { class: "facts", "data-list": "drawing" });
  const redraw = (): void => shop.look({});
  const set = <K extends keyof Drawing>(key: K, value: Drawing[K]): void => {
    drawing[key] = value;
    redraw();
  };
  const roll = amount({
    label: save.roll,
    unit: "mm",
    min: 10,
    max: 1e6,
    get: () => drawing.roll,
    set: (value) => set("roll", value),
  });
  const hint = h("p", { class: "hint" }, save.hint);
  const plain = check({
    label: save.plain,
    get: () => drawing.plain,
    set: (value) => set("plain", value),
  });
  const fields = fieldsOf([
    choice({
      label: save.paper,
      values: save.papers,
      get: () => drawing.paper,
      set: (value) => set("paper", value),
    }),
    roll,
    amount({
      label: save.allowance,
      unit: "mm",
      min: 0,
      max: 10_000,
      get: () => drawing.allowance,
      set: (value) => set("allowance", value),
    }),
    choice({
      label: save.corners,
      values: save.cornerKinds,
      get: () => drawing.corners,
      set: (value) => set("corners", value),
      disabled: () => drawing.allowance === 0,
    }),
    check({
      label: save.notches,
      get: () => drawing.notches,
      set: (value) => set("notches", value),
    }),
    plain,
  ]);

  const name = (): string =>
    (shop.surface?.name ?? "pattern")
      .toLowerCase()
      .replace(/[^a-z0-9]+/g, "-")
      .replace(/^-|-$/g, "") || "pattern";

  // Which files are made of the answer of the server.
  async function filed(
    kind: Kind,
    response: Response,
  ): Promise<[string, Blob | Uint8Array, string]> {
    if (kind === "obj") return [`${name()}.obj`, await response.blob(), mediaTypes.obj];
    const [made] = ((await response.json()) as Answer).drawings;
    warnings.replaceChildren(...made.warnings.map(({ message }) => h("li", {}, message)));
    const { files } = made;
    if (files.length === 1) return [`${name()}.${kind}`, bytesOf(files[0].data), mediaTypes[kind]];
    const entries = files.map(({ page, data }) => ({
      name: `${name()}-${page}.${kind}`,
      bytes: bytesOf(data),
    }));
    const archive = zip([...entries, { name: "README.txt", bytes: textBytes(`${save.hint}\n`) }]);
    return [`${name()}-${kind}.zip`, archive, "application/zip"];
  }

  async function go(kind: Kind): Promise<void> {
    const { pattern } = shop;
    if (!pattern.surface) return;
    stop = new AbortController();
    const { signal } = stop;
    warnings.replaceChildren();
    const what = kind.toUpperCase();
    working.textContent = save.working(what, 0);
    redraw();
    const options = kind === "obj" ? [] : [optionsOf(kind, drawing, pattern.millimetresPerUnit)];
    const tell = ({ fraction }: { fraction: number }): void => {
      working.textContent = save.working(what, fraction);
    };
    try {
      const accept = kind === "obj" ? mediaTypes.obj : "application/json";
      const more = { drawings: options, singularValues: false };
      const response = await shop.flat.ask(pattern, pattern.method, more, accept, tell, signal);
      const [file, part, type] = await filed(kind, response);
      download(file, [part as BlobPart], type);
      working.textContent = save.done(file);
      shop.onSaved();
    } catch (error) {
      const isOver = signal.aborted;
      working.textContent = isOver ? words.flat.said.cancelled : "";
      if (!isOver) shop.say(sentenceOf(error), true);
    } finally {
      stop = null;
      redraw();
    }
  }

  const buttons = kinds.map((kind) =>
    button(save.formats[kind], () => void go(kind), {
      "data-save": kind,
      ...(kind === "pdf" && { class: "main" }),
    }),
  );
  return {
    name: "save",
    element: h(
      "div",
      { class: "tab" },
      section(save.print, ...fields.elements, hint),
      h(
        "section",
        { class: "saves" },
        h("div", { class: "row" }, working, cancel),
        ...kinds.flatMap((kind, i) => [buttons[i], h("p", { class: "hint" }, save.hints[kind])]),
      ),
      warnings,
    ),
    sync() {
      fields.sync();
      roll.element.hidden = drawing.paper !== "roll";
      plain.element.hidden = drawing.paper !== "" && drawing.paper !== "roll";
      for (const one of buttons) one.disabled = !shop.surface || stop !== null;
      cancel.hidden = stop === null;
    },
  };
}
