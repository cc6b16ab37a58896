// What can be taken home.
import type { Film } from "../net/bake.js";
import { Projector, animatedSvg, blobOf, bytesOf, filmType, webm } from "../save/film.js";
import { glbOf } from "../save/gltf.js";
import { spineOf } from "../save/spine.js";
import { commandOf, objOf, trackOf } from "../save/track.js";
import { textBytes, zip } from "../save/zip.js";
import type { Studio } from "../studio.js";
import type { Takes } from "../takes.js";
import { words } from "../words.js";
import { download, h } from "./dom.js";
import type { Tab } from "./panel.js";

type Progress = (part: number) => void;
const nextTurn = (): Promise<void> => new Promise((resolve) => setTimeout(resolve));

/** Every second frame, for files that have a picture or a target for each. */
const thinned = (film: Film): Float32Array[] => film.shapes.filter((_, i) => i % 2 === 0);

export function saveTab(studio: Studio, takes: Takes): Tab {
  const name = (): string =>
    (studio.figure?.name ?? "puppet")
      .toLowerCase()
      .replace(/[^a-z0-9]+/g, "-")
      .replace(/^-|-$/g, "") || "puppet";
  const png = async (): Promise<Uint8Array> =>
    bytesOf(await blobOf(studio.figure!.canvas, "image/png"));
  const projector = (film: Film, shapes: readonly Float32Array[], size: number): Projector =>
    new Projector(
      { body: film.take.body, image: studio.figure!.canvas, shapes, order: film.order },
      size,
    );
  const size = (): { width: number; height: number } => studio.figure!.canvas;

  async function still(): Promise<void> {
    const { body } = studio.puppet;
    if (!body) return;
    const { shape, drawOrder: order } = studio;
    const image = studio.figure!.canvas;
    const picture = new Projector({ body, image, shapes: [shape], order }, 1600);
    save(`${name()}.png`, [await picture.png(0)], "image/png");
  }
  async function track(film: Film): Promise<void> {
    const { width, height } = size();
    const file = name();
    const entries = [
      { name: `${file}.obj`, bytes: textBytes(objOf(film.take.body, width, height)) },
      {
        name: `${file}.track.json`,
        bytes: textBytes(trackOf(film.take, film.frames, `${file}.obj`)),
      },
      { name: `${file}.png`, bytes: await png() },
      { name: "README.txt", bytes: textBytes(`${commandOf(film.take, file)}\n`) },
    ];
    save(`${file}-track.zip`, [zip(entries)], "application/zip");
  }
  async function svg(film: Film, progress: Progress): Promise<void> {
    const shapes = thinned(film);
    const painter = projector(film, shapes, 480);
    const pictures: string[] = [];
    for (let i = 0; i < shapes.length; ++i) {
      pictures.push(painter.small(i));
      progress(i / shapes.length);
      await nextTurn();
    }
    const { width, height } = painter.canvas;
    const text = animatedSvg(pictures, width, height, film.take.rate / 2, studio.figure!.name);
    save(`${name()}.svg`, [text], "image/svg+xml");
  }
  async function gltf(film: Film): Promise<void> {
    const { take, order } = film;
    const shapes = thinned(film);
    const { width, height } = size();
    const rate = take.rate / 2;
    const input = {
      name: name(),
      body: take.body,
      shapes,
      rate,
      order,
      png: await png(),
      width,
      height,
    };
    save(`${name()}.glb`, [glbOf(input)], "model/gltf-binary");
  }
  async function spine(film: Film): Promise<void> {
    const { take, order } = film;
    const { width, height } = size();
    const shapes = thinned(film);
    const input = {
      name: name(),
      body: take.body,
      shapes,
      rate: take.rate / 2,
      order,
      width,
      height,
    };
    const entries = [
      { name: `${name()}.json`, bytes: textBytes(spineOf(input)) },
      { name: `${name()}.png`, bytes: await png() },
    ];
    save(`${name()}-spine.zip`, [zip(entries)], "application/zip");
  }
  async function sequence(film: Film, progress: Progress): Promise<void> {
    const painter = projector(film, film.shapes, 960);
    const entries = [];
    for (let i = 0; i < film.shapes.length; ++i) {
      entries.push({
        name: `${name()}-${String(i + 1).padStart(4, "0")}.png`,
        bytes: await painter.png(i),
      });
      progress(i / film.shapes.length);
    }
    save(`${name()}-frames.zip`, [zip(entries)], "application/zip");
  }
  async function film(film: Film, progress: Progress): Promise<void> {
    const painter = projector(film, film.shapes, 960);
    const blob = await webm(painter, film.shapes.length, film.take.rate, filmType()!, progress);
    save(`${name()}.webm`, [blob], "video/webm");
  }
  function save(file: string, parts: (Uint8Array | string | Blob)[], type: string): void {
    download(file, parts as BlobPart[], type);
    said = words.save.done(file);
  }

  const canFilm = filmType() !== undefined;
  const rows: {
    name: string;
    key: string;
    hint: () => string;
    act: (film: Film, progress: Progress) => Promise<void>;
    able?: boolean;
  }[] = [
    { name: words.save.svg, key: "svg", hint: () => words.save.svgHint, act: svg },
    { name: words.save.png, key: "png", hint: () => words.save.pngHint, act: sequence },
    {
      name: words.save.webm,
      key: "webm",
      hint: () => (canFilm ? words.save.webmHint : words.save.webmNone),
      act: film,
      able: canFilm,
    },
    { name: words.save.gltf, key: "gltf", hint: () => words.save.gltfHint, act: gltf },
    { name: words.save.spine, key: "spine", hint: () => words.save.spineHint, act: spine },
    {
      name: words.save.track,
      key: "track",
      hint: () =>
        words.save.trackHint(
          takes.take ? commandOf(takes.take, name()).split(" --out")[0] : "arapctl bake",
        ),
      act: track,
    },
  ];
  const state = h("p", { class: "facts", role: "status" });
  let busy = false;
  let said = ""; // what is saved
  const stillButton = h(
    "button",
    { type: "button", "data-save": "still", onclick: () => void guarded(words.save.still, still) },
    words.save.still,
  );
  const buttons = rows.map((row) =>
    h(
      "button",
      {
        type: "button",
        "data-save": row.key,
        onclick: () =>
          void guarded(row.name, async (progress) => {
            const made = await takes.bakeIt();
            if (made) await row.act(made, progress);
          }),
      },
      row.name,
    ),
  );
  const hints = rows.map(() => h("p", { class: "hint" }));

  async function guarded(what: string, act: (progress: Progress) => Promise<void>): Promise<void> {
    if (busy) return;
    busy = true;
    said = "";
    tab.sync();
    try {
      await act((part) => (state.textContent = words.save.working(what, part)));
    } catch (error) {
      studio.say(words.wentWrong((error as Error).message), true);
    } finally {
      busy = false;
      state.textContent = said;
      tab.sync();
    }
  }
  const none = h("p", { class: "hint" }, words.save.none);
  const tab: Tab = {
    name: "save",
    element: h(
      "div",
      { class: "tab" },
      h(
        "section",
        {},
        h("h2", {}, words.tabs.save),
        state,
        h("div", { class: "saves" }, stillButton, h("p", { class: "hint" }, words.save.stillHint)),
        none,
        h("div", { class: "saves" }, ...buttons.flatMap((one, i) => [one, hints[i]])),
      ),
    ),
    sync() {
      none.hidden = takes.take !== null;
      stillButton.disabled = busy || !studio.puppet.body;
      rows.forEach((row, i) => {
        hints[i].textContent = row.hint();
        buttons[i].disabled = busy || takes.take === null || row.able === false;
      });
    },
  };
  return tab;
}
