// The stage: the puppet on its canvas, its pins above, pointers and keys.
import { boxOf } from "../model/geometry.js";
import type { Pin } from "../model/puppet.js";
import { perPin } from "../model/take.js";
import type { Film } from "../net/bake.js";
import type { Studio } from "../studio.js";
import type { Takes } from "../takes.js";
import { h } from "../ui/dom.js";
import { words } from "../words.js";
import { fit, moved, toFigure, toView, zoomed } from "./camera.js";
import type { Camera } from "./camera.js";
import { painterOf } from "./painter.js";
import { Detail } from "./detail.js";
import { layersOf } from "./layers.js";
import { PinLayer, gripReach } from "./pin_layer.js";
import type { Painter } from "./scene.js";

const toolsHeight = 48; // of the stage, from above

type Drag =
  | { kind: "pin"; id: string; dx: number; dy: number }
  | { kind: "turn"; id: string }
  | { kind: "paint" }
  | { kind: "pan"; x: number; y: number };

export class Stage {
  readonly element: HTMLElement;
  readonly #studio: Studio;
  readonly #takes: Takes;
  readonly #painter: Painter;
  readonly #canvas: HTMLCanvasElement;
  readonly #layer: PinLayer;
  readonly #cross: HTMLElement;
  readonly #brush: HTMLElement;
  readonly #drags = new Map<number, Drag>();
  #camera: Camera = { x: 0, y: 0, zoom: 1 };
  #fitted = true;
  #size = { width: 0, height: 0 };
  #figure: HTMLCanvasElement | undefined;
  #crossAt = { x: 0, y: 0 };
  #asked = false;
  /** A pointer has chosen a pin. */
  onPick: () => void = () => {};
  /** Draws nothing, to measure the rest of the way. */
  blind = false;
  readonly #detail: Detail;
  /** What the canvas shows. */
  #scene: unknown[] = [];

  constructor(studio: Studio, takes: Takes) {
    this.#studio = studio;
    this.#takes = takes;
    this.#canvas = h("canvas", { "aria-hidden": "true" });
    this.#cross = h("div", { class: "cross", "aria-hidden": "true" });
    this.#brush = h("div", { class: "brush", "aria-hidden": "true", hidden: true });
    this.#layer = new PinLayer(
      [this.#cross, this.#brush],
      (chosen) => studio.look({ chosen }),
      () => this.element.focus(),
    );
    const keys = h("p", { id: "stage-hint", class: "unseen" }, words.stage.hint);
    const pinKeys = h("p", { id: "pin-keys", class: "unseen" }, words.pin.keys);
    this.element = h(
      "div",
      {
        class: "stage",
        id: "stage",
        tabindex: 0,
        role: "application",
        "aria-label": words.stage.label,
        "aria-describedby": "stage-hint",
      },
      this.#canvas,
      this.#layer.element,
      keys,
      pinKeys,
    );
    this.#painter = painterOf(this.#canvas);
    this.#detail = new Detail(this.#canvas, () => this.ask());
    this.#listen();
    new ResizeObserver(() => this.#resize()).observe(this.element);
    studio.onShape = () => this.ask();
    studio.listen(() => this.ask());
    takes.listen(() => this.ask());
  }

  /** A graphics processor draws. */
  get isFast(): boolean {
    return this.#painter.isFast;
  }

  /** Draws with the next picture of the browser. */
  ask(): void {
    if (this.#asked) return;
    this.#asked = true;
    requestAnimationFrame((now) => {
      this.#asked = false;
      if (this.#takes.tick(now)) this.ask();
      this.#draw();
    });
  }

  /** A place of the view, in CSS pixels from its middle, stays where it is. */
  zoom(factor: number, dx = 0, dy = 0): void {
    this.#fitted = false;
    this.#camera = zoomed(this.#camera, factor, dx, dy);
    this.ask();
  }
  fit(): void {
    this.#fitted = true;
    this.ask();
  }

  /** From the figure's pixels to CSS pixels of the window. */
  inWindow(x: number, y: number): [number, number] {
    const { left, top } = this.element.getBoundingClientRect();
    const [vx, vy] = toView(this.#camera, this.#size.width, this.#size.height, x, y);
    return [left + vx, top + vy];
  }

  #resize(): void {
    const { clientWidth: width, clientHeight: height } = this.element;
    this.#size = { width, height };
    this.ask();
  }

  #draw(): void {
    const began = performance.now();
    const { figure, puppet } = this.#studio;
    const { body } = puppet;
    const { width, height } = this.#size;
    if (!figure || !body || width === 0) return;
    if (figure.canvas !== this.#figure) {
      this.#figure = figure.canvas;
      this.#painter.picture(figure.canvas);
      this.#fitted = true;
    }
    if (this.#fitted) {
      // Below the tools, with room to pull where there is some.
      const below = height - toolsHeight;
      const margin = Math.min(width, below) > 450 ? 0.24 : 0.12;
      const camera = fit(boxOf(body.picture), width, below, margin);
      this.#camera = { ...camera, y: camera.y + toolsHeight / 2 / camera.zoom };
    }
    const film = this.#takes.film;
    const frame = film && this.#takes.frame;
    const filmed = film && frame !== undefined && film.take.body.triangles === body.triangles;
    const shape = filmed ? film.shapes[frame] : this.#studio.shape;
    const { looks, flipped, trail } = this.#studio;
    const order = filmed ? film.order : this.#studio.drawOrder;
    const { x, y, zoom } = this.#camera;
    const scene = [figure, body, shape, order, looks, flipped, trail, puppet.starch, x, y, zoom];
    const coarse = this.#drags.size > 0 && !this.#painter.isFast;
    // While pins have moved and their shape has not come, the canvas stays: it would cost as much as a new one.
    const isNew =
      scene.some((part, i) => part !== this.#scene[i]) || this.#detail.isOff(width, height, coarse);
    if (isNew && shape.length === body.picture.length && !this.blind) {
      this.#scene = scene;
      this.#detail.resize(width, height, coarse);
      this.#painter.body(body);
      const ghosts = looks.onion
        ? [
            { shape: body.rest, strength: 0.22 },
            ...(filmed ? [] : trail.filter((pose) => pose.length === shape.length)).map(
              (pose, i) => ({ shape: pose, strength: 0.08 + 0.05 * i }),
            ),
          ]
        : [];
      this.#painter.paint(
        {
          camera: this.#camera,
          shape,
          order,
          ghosts,
          layers: layersOf(this.#studio, filmed === true),
          wire: looks.wire ? [0.05, 0.07, 0.1] : null,
        },
        this.#canvas.width / width,
      );
      this.#detail.took(performance.now() - began);
    }
    const pins = filmed ? this.#pinsOf(film, frame) : puppet.pins;
    this.#layer.place(pins, this.#studio.looks.chosen, (x, y) =>
      toView(this.#camera, width, height, x, y),
    );
    const cross = [this.#crossAt.x || width / 2, this.#crossAt.y || height / 2];
    this.#cross.style.transform = `translate(${cross[0]}px, ${cross[1]}px)`;
    this.#studio.meter.frame.add(performance.now() - began);
    this.#studio.painted();
  }

  /** The pins as a frame of the film has them. */
  #pinsOf(film: Film, frame: number): Pin[] {
    return this.#studio.puppet.pins.map((pin) => {
      const at = film.take.pins.findIndex((one) => one.id === pin.id);
      if (at < 0) return pin;
      const [x, y, angle, scale] = film.frames[frame].subarray(perPin * at, perPin * at + perPin);
      return { ...pin, x, y, angle, scale };
    });
  }

  #at(event: PointerEvent | MouseEvent): [number, number] {
    const { left, top } = this.element.getBoundingClientRect();
    const { width, height } = this.#size;
    return toFigure(this.#camera, width, height, event.clientX - left, event.clientY - top);
  }

  #listen(): void {
    this.element.addEventListener("pointerdown", (event) => this.#down(event));
    this.element.addEventListener("pointermove", (event) => this.#move(event));
    for (const end of ["pointerup", "pointercancel"] as const) {
      this.element.addEventListener(end, (event) => this.#up(event));
    }
    this.element.addEventListener("pointerleave", () => (this.#brush.hidden = true));
    this.element.addEventListener("keydown", (event) => this.#key(event));
    this.element.addEventListener(
      "wheel",
      (event) => {
        event.preventDefault();
        const { left, top, width, height } = this.element.getBoundingClientRect();
        const [dx, dy] = [event.clientX - left - width / 2, event.clientY - top - height / 2];
        this.zoom(Math.exp(-event.deltaY * 0.0015), dx, dy);
      },
      { passive: false },
    );
  }

  #down(event: PointerEvent): void {
    if (event.button > 1 || !(event.target instanceof Element)) return;
    this.#takes.leave();
    const [x, y] = this.#at(event);
    const target = event.target.closest<HTMLElement>(".pin, .grip");
    let drag: Drag | undefined;
    const pan: Drag = { kind: "pan", x: event.clientX, y: event.clientY };
    if (event.button === 1 || event.shiftKey) {
      drag = pan;
    } else if (event.altKey && target?.dataset["pin"]) {
      this.#studio.removePin(target.dataset["pin"]);
    } else if (this.#studio.looks.tool === "starch" && !target) {
      this.#studio.beginPaint();
      this.#studio.paint(x, y);
      drag = { kind: "paint" };
    } else if (target?.classList.contains("grip")) {
      drag = { kind: "turn", id: this.#studio.looks.chosen! };
    } else {
      const id = target?.dataset["pin"];
      const pin =
        id === undefined
          ? this.#studio.addPin(x, y)
          : this.#studio.puppet.pins.find((one) => one.id === id);
      if (pin) {
        drag = { kind: "pin", id: pin.id, dx: pin.x - x, dy: pin.y - y };
        this.#studio.look({ chosen: pin.id });
        this.onPick();
      } else {
        this.#studio.look({ chosen: null });
        drag = pan;
      }
    }
    if (!drag) return;
    if (target?.classList.contains("pin")) target.focus({ preventScroll: true });
    else event.preventDefault();
    if (drag.kind === "pin" || drag.kind === "turn") this.#studio.beginMove();
    this.#drags.set(event.pointerId, drag);
    this.element.setPointerCapture(event.pointerId);
    this.element.classList.add("drags");
  }

  #move(event: PointerEvent): void {
    this.#showBrush(event);
    const drag = this.#drags.get(event.pointerId);
    if (!drag) return;
    const [x, y] = this.#at(event);
    switch (drag.kind) {
      case "pin":
        this.#studio.movePin(drag.id, { x: x + drag.dx, y: y + drag.dy }, event.timeStamp);
        break;
      case "turn": {
        const pin = this.#studio.puppet.pins.find((one) => one.id === drag.id);
        if (!pin) return;
        const away = Math.hypot(x - pin.x, y - pin.y) * this.#camera.zoom;
        const angle = Math.atan2(y - pin.y, x - pin.x);
        const turns = Math.round((pin.angle - angle) / (2 * Math.PI));
        const scale = Math.min(2.5, Math.max(0.4, away / gripReach));
        const change = { angle: angle + 2 * Math.PI * turns, scale };
        this.#studio.movePin(drag.id, change, event.timeStamp);
        break;
      }
      case "paint":
        this.#studio.paint(x, y);
        break;
      case "pan":
        this.#pan(event, drag);
        break;
    }
  }

  /** The view goes with the finger; two of them also bring it closer or farther. */
  #pan(event: PointerEvent, drag: Drag & { kind: "pan" }): void {
    const { clientX: x, clientY: y } = event;
    const other = [...this.#drags.values()].find(
      (one): one is Drag & { kind: "pan" } => one.kind === "pan" && one !== drag,
    );
    this.#fitted = false;
    // What moves is the middle between the two.
    const part = other ? 0.5 : 1;
    this.#camera = moved(this.#camera, part * (x - drag.x), part * (y - drag.y));
    if (other) {
      const { left, top, width, height } = this.element.getBoundingClientRect();
      const apart = (ax: number, ay: number): number =>
        Math.max(20, Math.hypot(ax - other.x, ay - other.y));
      const factor = apart(x, y) / apart(drag.x, drag.y);
      this.zoom(factor, (x + other.x) / 2 - left - width / 2, (y + other.y) / 2 - top - height / 2);
    }
    [drag.x, drag.y] = [x, y];
    this.ask();
  }

  #up(event: PointerEvent): void {
    const drag = this.#drags.get(event.pointerId);
    if (!drag) return;
    this.#drags.delete(event.pointerId);
    if (this.#drags.size === 0) this.element.classList.remove("drags");
    if (drag.kind === "paint") this.#studio.endPaint();
    if (drag.kind === "pin" || drag.kind === "turn") this.#studio.endMove();
    if (drag.kind === "pin") this.#layer.focus(drag.id);
  }

  #showBrush(event: PointerEvent): void {
    const { tool, brush } = this.#studio.looks;
    this.#brush.hidden = tool !== "starch";
    if (tool !== "starch") return;
    const { left, top } = this.element.getBoundingClientRect();
    const size = 2 * brush.radius * this.#camera.zoom;
    this.#brush.style.width = this.#brush.style.height = `${size}px`;
    this.#brush.style.transform = `translate(${event.clientX - left - size / 2}px, ${event.clientY - top - size / 2}px)`;
  }

  #key(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const far = event.shiftKey ? 5 : 1;
    const arrow = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[
      event.key
    ];
    const id = (event.target as HTMLElement).dataset["pin"];
    const pin = id && this.#studio.puppet.pins.find((one) => one.id === id);
    if (pin) {
      const step = (4 * far) / this.#camera.zoom;
      if (arrow) {
        this.#studio.movePin(pin.id, { x: pin.x + arrow[0] * step, y: pin.y + arrow[1] * step });
      } else if (event.key === "Delete" || event.key === "Backspace") {
        this.#studio.removePin(pin.id, event.shiftKey);
      } else if (event.key === "[" || event.key === "]") {
        const turn = ((event.key === "[" ? 5 : -5) * Math.PI) / 180;
        this.#studio.changePin(pin.id, { turns: true, angle: pin.angle + turn }, false);
      } else if (event.key === "+" || event.key === "-") {
        const scale = pin.scale * (event.key === "+" ? 1.05 : 1 / 1.05);
        this.#studio.changePin(
          pin.id,
          { turns: true, scale: Math.min(2.5, Math.max(0.4, scale)) },
          false,
        );
      } else return;
      this.#takes.leave();
    } else {
      const { width, height } = this.#size;
      if (arrow) {
        const step = 8 * far;
        const clamp = (value: number, most: number): number =>
          Math.min(most - 1, Math.max(1, value));
        this.#crossAt = {
          x: clamp((this.#crossAt.x || width / 2) + arrow[0] * step, width),
          y: clamp((this.#crossAt.y || height / 2) - arrow[1] * step, height),
        };
        this.ask();
      } else if (event.key === "Enter" || event.key === " ") {
        this.#enter();
      } else return;
    }
    event.preventDefault();
  }

  #enter(): void {
    const { width, height } = this.#size;
    const at = toFigure(
      this.#camera,
      width,
      height,
      this.#crossAt.x || width / 2,
      this.#crossAt.y || height / 2,
    );
    if (this.#studio.looks.tool === "starch") {
      this.#studio.beginPaint();
      this.#studio.paint(...at);
      this.#studio.endPaint();
    } else if (!this.#studio.addPin(...at)) {
      this.#studio.say(words.said.outside);
    }
  }
}
