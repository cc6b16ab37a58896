// A small chart of the last minutes: lines over time, from 0 up.
import { h } from "../ui/dom.js";
import { words } from "../words.js";
import type { Chart } from "./measures.js";
import type { Moment } from "./watch.js";

// In units of the text's size: all of it, and what numbers and names take at its sides.
const tall = 8;
const sides = { left: 5, below: 1.3, above: 0.5, right: 0.4 };
// A pause in which nobody asked is a gap.
const gapMs = 4000;

const svgName = "http://www.w3.org/2000/svg";
function s(tag: string, attributes: Record<string, string | number>): SVGElement {
  const element = document.createElementNS(svgName, tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, String(value));
  return element;
}

/** The smallest of 1, 2, 4 · 10ⁿ that is not below; of bytes of 2ⁿ. */
export function ceiling(value: number, bytes = false): number {
  if (!(value > 0)) return bytes ? 2 ** 20 : 1;
  if (bytes) return 2 ** Math.ceil(Math.log2(value));
  const ten = 10 ** Math.floor(Math.log10(value));
  return [1, 2, 4, 10].map((digit) => digit * ten).find((one) => one >= value * 0.999_999)!;
}

export class ChartView {
  readonly element: HTMLElement;
  /** A pointer is at this moment, or has gone. */
  onPoint: (at: number | undefined) => void = () => {};
  readonly #chart: Chart;
  readonly #svg: SVGElement;
  readonly #paths: SVGElement[];
  readonly #grid: { line: SVGElement; text: SVGElement }[];
  readonly #cursor: SVGElement;
  readonly #start: SVGElement;
  readonly #end: SVGElement;
  readonly #values: HTMLElement[];
  #em = 11;
  #size = { width: 300, height: 88 };
  #shown = { from: 0, to: 1 };

  constructor(chart: Chart) {
    this.#chart = chart;
    this.#svg = s("svg", {
      role: "img",
      "aria-label": words.load.charts[chart.key],
    });
    this.#grid = [0, 1, 2].map(() => ({
      line: s("line", { class: "grid" }),
      text: s("text", { "text-anchor": "end", "aria-hidden": "true" }),
    }));
    this.#start = s("text", { "aria-hidden": "true" });
    this.#end = s("text", { "text-anchor": "end", "aria-hidden": "true" });
    this.#end.textContent = words.load.now;
    this.#cursor = s("line", { class: "cursor", visibility: "hidden" });
    this.#paths = chart.lines.map((_, i) => s("path", { class: `line line-${i}` }));
    for (const { line, text } of this.#grid) this.#svg.append(line, text);
    this.#svg.append(this.#start, this.#end, this.#cursor, ...this.#paths);
    this.#values = chart.lines.map(({ key }) => h("dd", { "data-load": `${chart.key}.${key}` }));
    const legend = h(
      "dl",
      {},
      ...chart.lines.map(({ key }, i) =>
        h("div", { class: `key key-${i}` }, h("dt", {}, words.load.lines[key]), this.#values[i]),
      ),
    );
    const title = h("h2", {}, words.load.charts[chart.key]);
    this.element = h("section", { class: "chart", "data-chart": chart.key }, title, legend);
    const plot = h("div", { class: "plot" });
    plot.append(this.#svg);
    this.element.append(plot);
    this.#svg.addEventListener("pointermove", (event) => this.#point(event));
    this.#svg.addEventListener("pointerdown", (event) => this.#point(event));
    this.#svg.addEventListener("pointerleave", () => this.onPoint(undefined));
    new ResizeObserver(() => {
      const em = parseFloat(getComputedStyle(plot).fontSize) || 11;
      this.#em = em;
      this.#size = { width: Math.max(10 * em, plot.clientWidth), height: tall * em };
      set(this.#svg, this.#size);
    }).observe(plot);
  }

  #point(event: PointerEvent): void {
    const { left: edge } = this.#svg.getBoundingClientRect();
    const { left, wide } = this.#room();
    const part = (event.clientX - edge - left) / wide;
    const { from, to } = this.#shown;
    this.onPoint(from + Math.min(1, Math.max(0, part)) * (to - from));
  }

  // What is left for the lines, in pixels.
  #room(): { left: number; above: number; wide: number; high: number } {
    const { width, height } = this.#size;
    const [left, above] = [sides.left * this.#em, sides.above * this.#em];
    const wide = width - left - sides.right * this.#em;
    return { left, above, wide, high: height - above - sides.below * this.#em };
  }

  /** `index` of the chart in the values of moments; `moment` is the one whose values are told. */
  sync(
    index: number,
    moments: readonly Moment[],
    moment: Moment | undefined,
    span: { from: number; to: number; minutes: number; cursor: boolean },
  ): void {
    this.#shown = span;
    const { unit, lines, key } = this.#chart;
    const say = (value: number | undefined): string =>
      value === undefined || Number.isNaN(value)
        ? words.load.nothing
        : words.load.units[unit](value);
    let most = 0;
    for (const { values } of moments) {
      for (const value of values[index]) if (value > most) most = value;
    }
    // Nothing is counted by halves.
    const least = unit === "count" ? 2 : 0;
    const top = unit === "part" ? 1 : ceiling(Math.max(most, least), unit === "bytes");
    const { left, above, wide, high } = this.#room();
    const x = (at: number): number => left + (wide * (at - span.from)) / (span.to - span.from);
    const y = (value: number): number => above + high * (1 - value / top);
    this.#grid.forEach(({ line, text }, i) => {
      const value = (top * i) / 2;
      set(line, { x1: left, x2: left + wide, y1: y(value), y2: y(value) });
      set(text, { x: left - this.#em / 2, y: y(value) + this.#em / 3 });
      text.textContent = words.load.units[unit](value);
    });
    const foot = this.#size.height - this.#em / 4;
    set(this.#start, { x: left, y: foot });
    this.#start.textContent = words.load.axis(span.minutes);
    set(this.#end, { x: left + wide, y: foot });
    lines.forEach((_, i) => {
      const value = moment?.values[index][i];
      this.#values[i].textContent = say(value);
      this.#paths[i].setAttribute("d", pathOf(moments, index, i, x, y));
    });
    set(this.#cursor, {
      x1: moment ? x(moment.at) : 0,
      x2: moment ? x(moment.at) : 0,
      y1: above,
      y2: above + high,
      visibility: span.cursor && moment ? "visible" : "hidden",
    });
    const told = lines.map(({ key: line }, i) =>
      words.load.line(words.load.lines[line], this.#values[i].textContent!),
    );
    this.#svg.setAttribute("aria-label", words.load.chart(words.load.charts[key], told.join(", ")));
  }
}

function set(element: SVGElement, attributes: Record<string, string | number>): void {
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, String(value));
}

function pathOf(
  moments: readonly Moment[],
  index: number,
  line: number,
  x: (at: number) => number,
  y: (value: number) => number,
): string {
  let path = "";
  let last = -Infinity;
  for (const { at, values } of moments) {
    const value = values[index][line];
    if (Number.isNaN(value)) {
      last = -Infinity;
      continue;
    }
    // A moment alone is a dot.
    const goesOn = at - last <= gapMs;
    path += goesOn ? "L" : "M";
    path += `${x(at).toFixed(1)} ${y(value).toFixed(1)}`;
    if (!goesOn) path += "h0.1";
    last = at;
  }
  return path;
}
