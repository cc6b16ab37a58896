// A layout in the plane: triangles coloured by strain on a canvas, what is pointed at on another, pins above.
import { boxOf } from "../model/geometry.js";
import { h } from "../ui/dom.js";
import { fit, toFigure, toView } from "../view/camera.js";
import type { Camera } from "../view/camera.js";
import { Raster, packed } from "../view/raster.js";
import { words } from "../words.js";
import { listenToKeys } from "./keys.js";
import { copiesOf, flatOf } from "./layout.js";
import type { Layout } from "./layout.js";
import { LayoutFacts, coloursOf, nextCorner } from "./layout_facts.js";
import { drawGrain, drawName, drawScale } from "./layout_ink.js";
import { mark, paletteOf } from "./palette.js";
import { PinButtons } from "./pin_buttons.js";
import { clickReach, hitBeside } from "./surface.js";
import type { Hit } from "./surface.js";
import type { Workshop } from "./workshop.js";

type Point = readonly [number, number];
const slip = 5; // pixels that a click may slip
const leastEdge = 3; // pixels that edges inside are long at least where they are shown
const innerInk = packed(8, 10, 13, 71); // as dark as 28 % of ink

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
  #raster = new Raster(1, 1);
  #facts: LayoutFacts | undefined;

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
    const { cornerUv } = layout;
    const at = toFigure(this.#camera, this.#size.width, this.#size.height, x, y);
    const bins = this.#known(layout).bins();
    const [hit] = bins.at(...at);
    if (hit || this.#shop.looks.tool === "look") return hit ?? null;
    const seen = (corner: number): [number, number, number] => [...this.#flat(cornerUv[corner]), 0];
    return hitBeside(bins.near(...at, clickReach / this.#camera.zoom), seen, x, y);
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
    if (!pointer.slipped && Math.hypot(dx, dy) < slip) return;
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

  /** What is known of a layout, computed once. */
  #known(layout: Layout): LayoutFacts {
    if (this.#facts?.layout !== layout) this.#facts = new LayoutFacts(layout);
    return this.#facts;
  }

  #drawBase(context: CanvasRenderingContext2D, layout: Layout): void {
    const { pattern, edges } = this.#shop;
    const palette = paletteOf(this.element);
    this.#fill(layout);
    const { width, height } = this.#base;
    context.putImageData(new ImageData(this.#raster.bytes, width, height), 0, 0);
    const [border, seam, cut, flips] = Array.from({ length: 4 }, () => new Path2D());
    const lines = edges && this.#known(layout).lines(edges, pattern.seams);
    for (const [path, corners] of [
      [border, lines?.border],
      [seam, lines?.seam],
      [cut, lines?.cut],
    ] as const) {
      for (const corner of corners ?? []) {
        path.moveTo(...this.#flat(layout.cornerUv[corner]));
        path.lineTo(...this.#flat(layout.cornerUv[nextCorner(corner)]));
      }
    }
    for (const triangle of layout.flipped) this.#trace(flips, layout, triangle);
    const stroke = (path: Path2D, colour: string, width: number): void => {
      context.strokeStyle = colour;
      context.lineWidth = width;
      context.stroke(path);
    };
    stroke(border, palette.ink, 1.6);
    stroke(cut, mark.cut, 2.2);
    stroke(seam, mark.seam, 2.6);
    stroke(flips, mark.flip, 2);
    for (const { from, to } of pattern.grains) {
      const [a, b] = [from, to].map((vertex) => this.#toView(...flatOf(layout, vertex)));
      drawGrain(context, a, b);
    }
    context.font = `${getComputedStyle(this.element).fontSize} system-ui, sans-serif`;
    for (const { name, middle, width: room } of layout.pieces)
      drawName(context, name, this.#toView(...middle), room * this.#camera.zoom);
    const pixels = this.#camera.zoom / pattern.millimetresPerUnit;
    drawScale(context, palette, pixels, this.#size.height);
  }

  // The triangles, and the edges inside where a tool picks them and they are long enough to be seen.
  #fill(layout: Layout): void {
    const { looks, flat, edges } = this.#shop;
    const { uv, cornerUv, pieceOf } = layout;
    const { width, height } = this.#base;
    if (this.#raster.width !== width || this.#raster.height !== height)
      this.#raster = new Raster(width, height);
    else this.#raster.clear();
    const chosen = looks.chosenTriangle === null ? -1 : pieceOf[looks.chosenTriangle];
    const { x, y, zoom } = this.#camera;
    const ratio = width / Math.max(1, this.#size.width);
    const places = new Float64Array(uv.length);
    for (let i = 0; i < uv.length; i += 2) {
      places[i] = width / 2 + (uv[i] - x) * zoom * ratio;
      places[i + 1] = height / 2 - (uv[i + 1] - y) * zoom * ratio;
    }
    this.#raster.flat(cornerUv, places, coloursOf(layout, flat.range, chosen));
    if (edges && looks.tool !== "look" && this.#known(layout).edge * zoom >= leastEdge)
      this.#raster.lines(
        this.#known(layout).lines(edges, this.#shop.pattern.seams).inner,
        places,
        innerInk,
      );
    this.#raster.finish();
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
      context.beginPath();
      for (const corner of this.#known(layout).cornersOf(edges, preview)) {
        context.moveTo(...this.#flat(layout.cornerUv[corner]));
        context.lineTo(...this.#flat(layout.cornerUv[nextCorner(corner)]));
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
