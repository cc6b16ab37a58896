// The pins of a layout: buttons, so that everything reaches them. They are dragged and moved by keys.
import { h } from "../ui/dom.js";
import { words } from "../words.js";
import type { Workshop } from "./workshop.js";

type ToView = (u: number, v: number) => [number, number];

export class PinButtons {
  readonly element = h("div", { class: "pins" });
  readonly #shop: Workshop;
  readonly #buttons = new Map<number, HTMLButtonElement>();
  #zoom = 1;
  #drag: { vertex: number; x: number; y: number; u: number; v: number } | null = null;

  constructor(shop: Workshop) {
    this.#shop = shop;
  }

  sync(toView: ToView | null, zoom: number): void {
    this.#zoom = zoom;
    const { pins, millimetresPerUnit: mm } = this.#shop.pattern;
    const known = new Set(toView ? pins.map((pin) => pin.vertex) : []);
    for (const [vertex, button] of this.#buttons) {
      if (known.has(vertex)) continue;
      const had = document.activeElement === button;
      button.remove();
      this.#buttons.delete(vertex);
      if (had) this.element.parentElement?.focus();
    }
    if (!toView) return;
    for (const { vertex, u, v } of pins) {
      const button = this.#buttons.get(vertex) ?? this.#make(vertex);
      const [x, y] = toView(u, v);
      button.style.transform = `translate(${x}px, ${y}px)`;
      button.setAttribute("aria-label", words.flat.pinLabel(vertex, u * mm, v * mm));
      button.setAttribute("aria-pressed", String(this.#shop.looks.pin === vertex));
    }
  }

  #make(vertex: number): HTMLButtonElement {
    const shop = this.#shop;
    const place = (): { u: number; v: number } =>
      shop.pattern.pins.find((pin) => pin.vertex === vertex) ?? { u: 0, v: 0 };
    const button = h("button", {
      type: "button",
      class: "pin",
      "data-pin": vertex,
      onfocus: () => shop.look({ pin: vertex }),
      onpointerdown: (event: PointerEvent) => {
        event.stopPropagation();
        button.setPointerCapture(event.pointerId);
        this.#drag = { vertex, x: event.clientX, y: event.clientY, ...place() };
        shop.history.seal();
      },
      onpointermove: (event: PointerEvent) => {
        event.stopPropagation();
        const drag = this.#drag;
        if (drag?.vertex !== vertex) return;
        const [dx, dy] = [event.clientX - drag.x, event.clientY - drag.y];
        if (dx === 0 && dy === 0) return;
        shop.movePin(vertex, drag.u + dx / this.#zoom, drag.v - dy / this.#zoom);
      },
      onpointerup: (event: PointerEvent) => {
        event.stopPropagation();
        this.#drag = null;
        shop.history.seal();
      },
      onpointercancel: () => (this.#drag = null),
      onkeydown: (event: KeyboardEvent) => {
        if (event.ctrlKey || event.metaKey || event.altKey) return;
        const step = (event.shiftKey ? 10 : 1) / shop.pattern.millimetresPerUnit;
        const { u, v } = place();
        if (event.key === "ArrowLeft") shop.movePin(vertex, u - step, v);
        else if (event.key === "ArrowRight") shop.movePin(vertex, u + step, v);
        else if (event.key === "ArrowUp") shop.movePin(vertex, u, v + step);
        else if (event.key === "ArrowDown") shop.movePin(vertex, u, v - step);
        else if (event.key === "Delete" || event.key === "Backspace") shop.removePin(vertex);
        else return;
        event.preventDefault();
        event.stopPropagation();
      },
    });
    this.#buttons.set(vertex, button);
    this.element.append(button);
    return button;
  }
}
