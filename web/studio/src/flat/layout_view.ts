// A layout in the plane: triangles coloured by strain on a canvas, what is pointed at on another, pins above.
import { boxOf } from "../model/geometry.js";
import { h } from "../ui/dom.js";
import { fit, toFigure, toView } from "../view/camera.js";
import type { Camera } from "../view/camera.js";
import { words } from "../words.js";
import { listenToKeys } from "./keys.js";
import { copiesOf, flatOf } from "./layout.js";
import type { Layout } from "./layout.js";
import { mark, paletteOf } from "./palette.js";
import { PinButtons } from "./pin_buttons.js";
import { colourOf, cssOf, shadeOf, shades } from "./strain.js";
import { hitBeside, isBorder } from "./surface.js";
import type { Hit } from "./surface.js";
import type { Workshop } from "./workshop.js";

type Point = readonly [number, number];
const clickReach = 5; // pixels that a click may slip
const mostInner = 60_000; // triangles whose edges are shown, and found beside them

export class LayoutView {
  readonly element: HTMLElement;
  readonly #shop: Workshop;
  readonly #index: number;
  readonly #base = h("canvas", { "aria-hidden": "true" });
  readonly #over = h("canvas", { "aria-hidden": "true" });
  readonly #empty = h("p", { class: "nothing" });
  readonly #pins: PinButtons | null;
  readonly #pointers = new Map<number, { x: number; y: number; slipped: boolean }>();
  #camera: Camera = { x: 0, y: 0, zoom: 1 };
  #fitted = true;
  #size = { width: 0, height: 0 };
  #drawn: unknown[] = [];

  /** `index` 0: of the method, with pins; 1: of the one beside it. */
  constructor(shop: Workshop, index: number) {
    this.#shop = shop;
    this.#index = index;
    this.#pins = index === 0 ? new PinButtons(shop) : null;
    const id = `layout-${index}`;
    this.element = h(
      "div",
      {
        class: "view layout",
        id,
        tabindex: 0,
        role: "application",
        "aria-label": words.flat.layoutLabel,
        "aria-describedby": `${id}-keys`,
      },
      this.#base,
      this.#over,
      this.#pins?.element,
      this.#empty,
      h("p", { id: `${id}-keys`, class: "unseen" }, words.flat.layoutKeys),
    );
    this.#listen();
    new ResizeObserver(() => this.#resize()).observe(this.element);
  }

  get layout(): Layout | undefined {
    return this.#shop.flat.layouts[this.#index];
  }

  zoom(factor: number, dx = 0, dy = 0): void {
    this.#fitted = false;
    const { x, y, zoom: before } = this.#camera;
    const whole = fit(boxOf(this.layout?.uv ?? []), this.#size.width, this.#size.height).zoom;
    const zoom = Math.min(200 * whole, Math.max(whole / 20, before * factor));
    const shift = 1 / before - 1 / zoom;
    this.#camera = { x: x + dx * shift, y: y - dy * shift, zoom };
    this.sync();
  }
  fit(): void {
    this.#fitted = true;
    this.sync();
  }

  #toView = (u: number, v: number): [number, number] =>
    toView(this.#camera, this.#size.width, this.#size.height, u, v);
  #flat = (position: number): [number, number] => {
    const { uv } = this.layout!;
    return this.#toView(uv[2 * position], uv[2 * position + 1]);
  };
  /** Where a vertex is held, in pixels of the window: for tests and for walking. */
  inWindow(vertex: number): [number, number] {
    const { left, top } = this.element.getBoundingClientRect();
    const [x, y] = this.#toView(...flatOf(this.layout!, vertex));
    return [left + x, top + y];
  }

  #hitAt(x: number, y: number): Hit | null {
    const { layout } = this;
    if (!layout) return null;
    const { uv, cornerUv } = layout;
    const [px, py] = toFigure(this.#camera, this.#size.width, this.#size.height, x, y);
    for (let t = 0; 3 * t < cornerUv.length; ++t) {
      const [a, b, c] = [2 * cornerUv[3 * t], 2 * cornerUv[3 * t + 1], 2 * cornerUv[3 * t + 2]];
      const [ax, ay, bx, by, cx, cy] = [uv[a], uv[a + 1], uv[b], uv[b + 1], uv[c], uv[c + 1]];
      const area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay);
      if (area === 0) continue;
      const wb = ((px - ax) * (cy - ay) - (cx - ax) * (py - ay)) / area;
      const wc = ((bx - ax) * (py - ay) - (px - ax) * (by - ay)) / area;
      if (wb >= 0 && wc >= 0 && wb + wc <= 1)
        return { triangle: t, weights: [1 - wb - wc, wb, wc] };
    }
    if (this.#shop.looks.tool === "look" || cornerUv.length > 3 * mostInner) return null;
    const seen = (_: number, corner: number): [number, number, number] => [
      ...this.#flat(cornerUv[corner]),
      0,
    ];
    return hitBeside(this.#shop.surface!, seen, x, y);
  }

  // ---- pointers and keys

  #listen(): void {
    const { element } = this;
    const at = (event: MouseEvent): Point => {
      const { left, top } = element.getBoundingClientRect();
      return [event.clientX - left, event.clientY - top];
    };
    element.addEventListener("pointerdown", (event) => {
      if (event.button > 1) return;
      this.#pointers.set(event.pointerId, { x: event.clientX, y: event.clientY, slipped: false });
      element.setPointerCapture(event.pointerId);
    });
    element.addEventListener("pointermove", (event) => {
      const pointer = this.#pointers.get(event.pointerId);
      if (pointer) this.#drag(pointer, event);
      else if (event.pointerType !== "touch") this.#shop.point(this.#hitAt(...at(event)));
    });
    element.addEventListener("pointerleave", () => this.#shop.point(null));
    element.addEventListener("pointerup", (event) => {
      const pointer = this.#pointers.get(event.pointerId);
      this.#pointers.delete(event.pointerId);
      if (pointer && !pointer.slipped) this.#shop.press(this.#hitAt(...at(event)));
    });
    element.addEventListener("pointercancel", (event) => this.#pointers.delete(event.pointerId));
    element.addEventListener(
      "wheel",
      (event) => {
        event.preventDefault();
        const [x, y] = at(event);
        const { width, height } = this.#size;
        this.zoom(Math.exp(-event.deltaY * 0.0015), x - width / 2, y - height / 2);
      },
      { passive: false },
    );
    listenToKeys(this.#shop, this);
  }

  #drag(pointer: { x: number; y: number; slipped: boolean }, event: PointerEvent): void {
    const [dx, dy] = [event.clientX - pointer.x, event.clientY - pointer.y];
    if (!pointer.slipped && Math.hypot(dx, dy) < clickReach) return;
    pointer.slipped = true;
    if (this.#pointers.size === 2) {
      const other = [...this.#pointers.values()].find((one) => one !== pointer)!;
      other.slipped = true;
      const before = Math.hypot(pointer.x - other.x, pointer.y - other.y);
      const now = Math.hypot(event.clientX - other.x, event.clientY - other.y);
      this.zoom(now / Math.max(1, before));
    } else {
      this.#fitted = false;
      const { x, y, zoom } = this.#camera;
      this.#camera = { x: x - dx / zoom, y: y + dy / zoom, zoom };
      this.sync();
    }
    [pointer.x, pointer.y] = [event.clientX, event.clientY];
  }

  turn(dx: number, dy: number): void {
    this.#fitted = false;
    const { x, y, zoom } = this.#camera;
    this.#camera = { x: x + (30 * dx) / zoom, y: y - (30 * dy) / zoom, zoom };
    this.sync();
  }
  walk(dx: number, dy: number): void {
    const { layout } = this;
    if (!layout) return;
    const place = (point: number): Point => this.#toView(...flatOf(layout, point));
    this.#shop.walk(place, dx, dy, layout.uvVertex[layout.cornerUv[0]]);
  }

  // ---- drawing

  #resize(): void {
    const { clientWidth: width, clientHeight: height } = this.element;
    this.#size = { width, height };
    const ratio = Math.min(2, devicePixelRatio);
    for (const canvas of [this.#base, this.#over]) {
      canvas.width = Math.max(1, Math.round(width * ratio));
      canvas.height = Math.max(1, Math.round(height * ratio));
    }
    this.#drawn = [];
    this.sync();
  }

  sync(): void {
    const { layout } = this;
    const { width, height } = this.#size;
    const { state, problem } = this.#shop.flat;
    this.#empty.hidden = layout !== undefined;
    this.#empty.textContent = problem ? "" : words.flat.nothing[state];
    if (width === 0 || this.element.hidden) return;
    if (layout && this.#fitted) this.#camera = fit(boxOf(layout.uv), width, height, 0.2);
    const { pattern, looks, flat } = this.#shop;
    const palette = paletteOf(this.element);
    const { x, y, zoom } = this.#camera;
    const piece = looks.chosenTriangle === null ? -1 : layout?.pieceOf[looks.chosenTriangle];
    const now: unknown[] = [
      layout,
      x,
      y,
      zoom,
      flat.range,
      pattern.seams,
      pattern.grains,
      looks.tool,
      piece,
    ];
    now.push(palette.ink, pattern.millimetresPerUnit);
    if (now.some((value, i) => value !== this.#drawn[i])) {
      this.#drawn = now;
      const context = this.#begin(this.#base);
      if (layout) this.#drawBase(context, layout);
    }
    const context = this.#begin(this.#over);
    if (layout) this.#drawOver(context, layout);
    this.#pins?.sync(layout ? this.#toView : null, this.#camera.zoom);
  }

  #begin(canvas: HTMLCanvasElement): CanvasRenderingContext2D {
    const context = canvas.getContext("2d")!;
    const ratio = canvas.width / Math.max(1, this.#size.width);
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, this.#size.width, this.#size.height);
    context.lineJoin = "round";
    context.lineCap = "round";
    return context;
  }

  #trace(path: Path2D | CanvasRenderingContext2D, layout: Layout, triangle: number): void {
    for (let k = 0; k < 3; ++k) {
      const [x, y] = this.#flat(layout.cornerUv[3 * triangle + k]);
      if (k === 0) path.moveTo(x, y);
      else path.lineTo(x, y);
    }
    path.closePath();
  }

  #drawBase(context: CanvasRenderingContext2D, layout: Layout): void {
    const { pattern, edges, looks, flat } = this.#shop;
    const palette = paletteOf(this.element);
    const chosen = looks.chosenTriangle === null ? -1 : layout.pieceOf[looks.chosenTriangle];
    const count = layout.strain.length;
    const fills = new Map<number, Path2D>();
    const pale = new Path2D();
    for (let t = 0; t < count; ++t) {
      const shade = shadeOf(layout.strain[t], flat.range) + shades;
      let path = fills.get(shade);
      if (!path) fills.set(shade, (path = new Path2D()));
      this.#trace(path, layout, t);
      if (chosen >= 0 && layout.pieceOf[t] !== chosen) this.#trace(pale, layout, t);
    }
    context.lineWidth = 0.8; // Covers what would shine through between neighbours.
    for (const [shade, path] of fills) {
      context.fillStyle = context.strokeStyle = cssOf(colourOf(shade - shades));
      context.fill(path);
      context.stroke(path);
    }
    context.fillStyle = palette.veil;
    context.fill(pale);
    const picks = looks.tool !== "look" && count <= mostInner;
    const [inner, border, seam, cut, flips] = Array.from({ length: 5 }, () => new Path2D());
    const seams = new Set(pattern.seams);
    const cuts = new Set(layout.autoCuts);
    for (let corner = 0; edges && corner < 3 * count; ++corner) {
      const edge = edges.ofTriangle[corner];
      const kind = seams.has(edge)
        ? seam
        : cuts.has(edge)
          ? cut
          : isBorder(edges, edge)
            ? border
            : inner;
      if (kind === inner && !picks) continue;
      const next = corner % 3 === 2 ? corner - 2 : corner + 1;
      kind.moveTo(...this.#flat(layout.cornerUv[corner]));
      kind.lineTo(...this.#flat(layout.cornerUv[next]));
    }
    for (const triangle of layout.flipped) this.#trace(flips, layout, triangle);
    const stroke = (path: Path2D, colour: string, width: number): void => {
      context.strokeStyle = colour;
      context.lineWidth = width;
      context.stroke(path);
    };
    if (picks) stroke(inner, mark.inner, 0.7);
    stroke(border, palette.ink, 1.6);
    stroke(cut, mark.cut, 2.2);
    stroke(seam, mark.seam, 2.6);
    stroke(flips, mark.flip, 2);
    for (const { from, to } of pattern.grains) this.#drawGrain(context, layout, from, to);
    this.#drawScale(context, palette.ink);
  }

  #drawGrain(context: CanvasRenderingContext2D, layout: Layout, from: number, to: number): void {
    const a = this.#toView(...flatOf(layout, from));
    const b = this.#toView(...flatOf(layout, to));
    const angle = Math.atan2(b[1] - a[1], b[0] - a[0]);
    context.beginPath();
    context.moveTo(...a);
    context.lineTo(...b);
    for (const [end, turn] of [
      [b, 0],
      [a, Math.PI],
    ] as const) {
      for (const side of [-0.4, 0.4]) {
        context.moveTo(...end);
        const to = angle + turn + Math.PI + side;
        context.lineTo(end[0] + 12 * Math.cos(to), end[1] + 12 * Math.sin(to));
      }
    }
    for (const [colour, width] of [
      ["#ffffff", 5],
      [mark.grain, 2.2],
    ] as const) {
      context.strokeStyle = colour;
      context.lineWidth = width;
      context.stroke();
    }
  }

  // How long a round number of millimetres is here.
  #drawScale(context: CanvasRenderingContext2D, ink: string): void {
    const pixels = this.#camera.zoom / this.#shop.pattern.millimetresPerUnit;
    const wanted = 90 / pixels;
    const power = 10 ** Math.floor(Math.log10(wanted));
    const step = power * ([5, 2].find((one) => one * power <= wanted) ?? 1);
    const [x, y, length] = [14, this.#size.height - 14, step * pixels];
    context.font = `${getComputedStyle(this.element).fontSize} system-ui, sans-serif`;
    const text = words.flat.mm(step);
    context.fillStyle = paletteOf(this.element).veil;
    const wide = Math.max(length, context.measureText(text).width + 6) + 12;
    context.fillRect(x - 6, y - 26, wide, 32);
    context.strokeStyle = context.fillStyle = ink;
    context.lineWidth = 1.5;
    context.beginPath();
    context.moveTo(x, y - 5);
    context.lineTo(x, y);
    context.lineTo(x + length, y);
    context.lineTo(x + length, y - 5);
    context.stroke();
    context.fillText(text, x + 6, y - 6);
  }

  #drawOver(context: CanvasRenderingContext2D, layout: Layout): void {
    const { looks, edges } = this.#shop;
    const { hover, chosenTriangle, cursor, from, near, preview } = looks;
    const outline = (triangle: number, colour: string, width: number): void => {
      context.beginPath();
      this.#trace(context, layout, triangle);
      context.strokeStyle = colour;
      context.lineWidth = width;
      context.stroke();
    };
    if (chosenTriangle !== null) outline(chosenTriangle, mark.chosen, 3);
    if (hover) outline(hover.triangle, mark.hover, 2);
    if (edges && preview.length > 0) {
      const wanted = new Set(preview);
      context.beginPath();
      for (let corner = 0; corner < edges.ofTriangle.length; ++corner) {
        if (!wanted.has(edges.ofTriangle[corner])) continue;
        const next = corner % 3 === 2 ? corner - 2 : corner + 1;
        context.moveTo(...this.#flat(layout.cornerUv[corner]));
        context.lineTo(...this.#flat(layout.cornerUv[next]));
      }
      context.strokeStyle = mark.hover;
      context.lineWidth = 3.5;
      context.stroke();
    }
    for (const [vertex, colour] of [
      [from, mark.from],
      [cursor?.point, mark.hover],
      [near, mark.hover],
    ] as const) {
      if (vertex === null || vertex === undefined) continue;
      for (const copy of copiesOf(layout, vertex)) {
        context.beginPath();
        context.arc(...this.#flat(copy), 5.5, 0, 2 * Math.PI);
        context.fillStyle = colour;
        context.strokeStyle = "#ffffff";
        context.lineWidth = 2;
        context.fill();
        context.stroke();
      }
    }
  }
}
