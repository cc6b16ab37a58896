// Keys that both views have.
import type { Workshop } from "./workshop.js";

export interface KeyedView {
  element: HTMLElement;
  /** An arrow key: to the right and down are 1. */
  turn(dx: number, dy: number): void;
  /** The same with Shift: along the edges. */
  walk(dx: number, dy: number): void;
  zoom(factor: number): void;
  fit(): void;
}

const arrows: Record<string, readonly [number, number]> = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowUp: [0, -1],
  ArrowDown: [0, 1],
};
const step = 1.25;

export function listenToKeys(shop: Workshop, view: KeyedView): void {
  view.element.addEventListener("keydown", (event) => {
    if (event.target !== view.element || event.ctrlKey || event.metaKey || event.altKey) return;
    const arrow = arrows[event.key];
    if (arrow) (event.shiftKey ? view.walk : view.turn).call(view, ...arrow);
    else if (event.key === "+" || event.key === "=") view.zoom(step);
    else if (event.key === "-") view.zoom(1 / step);
    else if (event.key === "0") view.fit();
    else if (event.key === "Enter" || event.key === " ") shop.act();
    else if (event.key === "Escape") shop.escape();
    else return;
    event.preventDefault();
  });
}
