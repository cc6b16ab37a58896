// Recording, and the timeline.
import type { Studio } from "../studio.js";
import { recordingRate } from "../takes.js";
import type { Takes } from "../takes.js";
import { words } from "../words.js";
import { button, h, slider } from "./dom.js";
import { fieldsOf } from "./tabs.js";
import type { Tab } from "./panel.js";

export function takeTab(studio: Studio, takes: Takes): Tab {
  const record = button("", () => (takes.recording ? takes.stop() : takes.record()), {
    class: "record",
    "data-take": "record",
  });
  const play = button("", () => (takes.playing ? takes.pause() : void takes.play()), {
    "data-take": "play",
  });
  const rate = () => takes.take?.rate ?? recordingRate;
  const frames = () => takes.take?.frames.length ?? 1;
  const seek = slider({
    label: words.take.frame,
    min: 0,
    max: 1,
    get: () => takes.frame ?? 0,
    set: (frame) => void takes.seek(frame),
    say: (frame) => words.take.frameValue(frame, takes.count, rate()),
  });
  const first = slider({
    label: words.take.first,
    min: 0,
    max: 1,
    get: () => takes.take?.first ?? 0,
    set: (value, done) => takes.edit({ first: Math.min(value, (takes.take?.end ?? 1) - 1) }, done),
    say: (value) => words.take.seconds(value / rate()),
  });
  const end = slider({
    label: words.take.end,
    min: 1,
    max: 2,
    get: () => takes.take?.end ?? 1,
    set: (value, done) => takes.edit({ end: Math.max(value, (takes.take?.first ?? 0) + 1) }, done),
    say: (value) => words.take.seconds(value / rate()),
  });
  const smooth = slider({
    label: words.take.smooth,
    min: 0,
    max: 20,
    get: () => takes.take?.smooth ?? 0,
    set: (value, done) => takes.edit({ smooth: value }, done),
    say: (value) => words.motion.rounds(value),
  });
  const loop = slider({
    label: words.take.loop,
    min: 0,
    max: 60,
    get: () => takes.take?.loop ?? 0,
    set: (value, done) => takes.edit({ loop: value }, done),
    say: (value) => words.take.loopValue(value / rate()),
  });
  const remove = button(words.take.remove, () => takes.remove());
  const facts = h("p", { class: "facts", role: "status", "data-facts": "take" });
  const fields = fieldsOf([seek, first, end, smooth, loop]);
  const strip = h("canvas", { class: "strip", width: 600, height: 64, "aria-hidden": "true" });
  const timeline = h(
    "section",
    {},
    h("h2", {}, words.take.timeline),
    strip,
    ...fields.elements,
    h("div", { class: "row" }, remove),
  );
  const max = (field: { element: HTMLElement }, value: number): void => {
    field.element.querySelector("input")!.max = String(value);
  };
  return {
    name: "take",
    element: h(
      "div",
      { class: "tab" },
      h(
        "section",
        {},
        h("h2", {}, words.tabs.take),
        h("p", { class: "hint" }, words.take.hint),
        h("div", { class: "row" }, record, play),
        facts,
      ),
      timeline,
    ),
    sync() {
      const { take } = takes;
      record.textContent = takes.recording ? words.take.stop : words.take.record;
      record.classList.toggle("on", takes.recording);
      record.classList.toggle("main", !take);
      play.classList.toggle("main", take !== null);
      const hasPins = studio.puppet.pins.length > 0;
      record.disabled = !studio.puppet.body || !hasPins;
      play.textContent = takes.playing ? words.take.pause : words.take.play;
      play.disabled = !take || takes.recording;
      timeline.hidden = !take;
      if (takes.recording) facts.textContent = words.take.recording(Math.floor(takes.recorded));
      else if (takes.baking !== undefined) facts.textContent = words.take.baking(takes.baking);
      else if (take) facts.textContent = words.take.facts(takes.count, take.rate);
      else facts.textContent = hasPins ? words.take.none : words.take.noPins;
      if (!take) return;
      max(seek, Math.max(0, takes.count - 1));
      max(first, frames() - 1);
      max(end, frames());
      max(loop, Math.floor((take.end - take.first) / 2));
      fields.sync();
      drawStrip(strip, take.frames, take.first, take.end);
    },
  };
}

/** How fast the pins move, frame by frame; what is trimmed away is paler. */
function drawStrip(
  canvas: HTMLCanvasElement,
  frames: readonly Float64Array[],
  first: number,
  end: number,
): void {
  const context = canvas.getContext("2d")!;
  const { width, height } = canvas;
  const speeds = frames.map((frame, i) => {
    const before = frames[Math.max(0, i - 1)];
    let most = 0;
    for (let k = 0; k < frame.length; k += 4) {
      most = Math.max(most, Math.hypot(frame[k] - before[k], frame[k + 1] - before[k + 1]));
    }
    return most;
  });
  const fastest = Math.max(1, ...speeds);
  context.clearRect(0, 0, width, height);
  context.fillStyle = getComputedStyle(canvas).color;
  speeds.forEach((speed, i) => {
    context.globalAlpha = i >= first && i < end ? 1 : 0.25;
    const tall = 3 + (height - 6) * Math.sqrt(speed / fastest);
    const wide = width / frames.length;
    context.fillRect(i * wide, (height - tall) / 2, Math.max(1, wide - 0.5), tall);
  });
}
