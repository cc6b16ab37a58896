// The pins above the canvas: buttons, so that everything reaches them, and the grip of the chosen one.
import type { Pin } from "../model/puppet.js";
import { h, mark } from "../ui/dom.js";
import { words } from "../words.js";

/** How far the grip that turns a pin is from it, in CSS pixels. */
export const gripReach = 52;

export class PinLayer {
  readonly element: HTMLElement;
  readonly #grip = h("div", { class: "grip", "aria-hidden": "true", hidden: true });
  readonly #pins = new Map<string, HTMLButtonElement>();
  readonly #choose: (id: string) => void;
  readonly #lostFocus: () => void;

  /** `lostFocus` when the pin that had it is gone. */
  constructor(others: readonly HTMLElement[], choose: (id: string) => void, lostFocus: () => void) {
    this.element = h("div", { class: "pins" }, ...others, this.#grip);
    this.#choose = choose;
    this.#lostFocus = lostFocus;
  }

  focus(id: string): void {
    this.#pins.get(id)?.focus();
  }

  place(
    pins: readonly Pin[],
    chosen: string | null,
    toView: (x: number, y: number) => [number, number],
  ): void {
    const known = new Set(pins.map((pin) => pin.id));
    for (const [id, element] of this.#pins) {
      if (known.has(id)) continue;
      const had = document.activeElement === element;
      element.remove();
      this.#pins.delete(id);
      if (had) this.#lostFocus();
    }
    for (const pin of pins) {
      const element = this.#pins.get(pin.id) ?? this.#make(pin.id);
      const [x, y] = toView(pin.x, pin.y);
      element.style.transform = `translate(${x}px, ${y}px)`;
      mark(element, "aria-label", words.pin.label(pin.id, pin.x, pin.y));
      mark(element, "aria-pressed", String(pin.id === chosen));
      mark(element, "data-kind", pin.firmness);
      if (pin.id === chosen) this.#placeGrip(pin, x, y);
    }
    if (!pins.some((pin) => pin.id === chosen)) this.#grip.hidden = true;
  }

  #make(id: string): HTMLButtonElement {
    const element = h("button", {
      type: "button",
      class: "pin",
      "data-pin": id,
      "aria-describedby": "pin-keys",
      onfocus: () => this.#choose(id),
    });
    this.#pins.set(id, element);
    this.element.append(element);
    return element;
  }

  #placeGrip(pin: Pin, x: number, y: number): void {
    this.#grip.hidden = !(pin.turns || pin.area > 0);
    const reach = gripReach * Math.min(2.5, Math.max(0.6, pin.scale));
    this.#grip.style.transform = `translate(${x}px, ${y}px) rotate(${-pin.angle}rad)`;
    this.#grip.style.setProperty("--reach", `${reach}px`);
  }
}
