// The surface in space, drawn with three.js, in a file that is loaded when it is needed.
import {
  AmbientLight,
  BufferAttribute,
  BufferGeometry,
  Color,
  DirectionalLight,
  Group,
  MathUtils,
  Mesh,
  MeshBasicMaterial,
  Matrix4,
  PerspectiveCamera,
  Scene,
  Spherical,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";

import { h } from "../ui/dom.js";
import { hasGraphics } from "../view/painter.js";
import { packed } from "../view/raster.js";
import { words } from "../words.js";
import { listenToKeys } from "./keys.js";
import { coloursOf } from "./layout_facts.js";
import { Lines, cloth, dot } from "./marks.js";
import { mark, paletteOf } from "./palette.js";
import { Sight } from "./sight.js";
import { SoftModel } from "./soft_model.js";
import { colourOf, paleOf, shadeOf, shades } from "./strain.js";
import { extentOf, isBorder, normalsOf } from "./surface.js";
import type { Hit, Surface } from "./surface.js";
import type { Workshop } from "./workshop.js";

const lightPlace = new Vector3(0.6, 0.9, 1.4); // from the eye
const slip = 5; // pixels that a click may slip
const dotRadius = 6; // pixels
const half = 0.31; // of the angle of view
const angle = Math.PI / 18; // that an arrow key turns by
const [nearest, farthest] = [0.1, 20]; // of the model, whose size is 2
const bare = [214, 208, 196] as const; // before there is a layout
const mostInner = 60_000; // triangles whose edges are shown

export class ModelView {
  readonly element: HTMLElement;
  readonly #shop: Workshop;
  readonly #canvas: HTMLCanvasElement;
  // One of both.
  readonly #renderer: WebGLRenderer | null;
  readonly #soft: SoftModel | null;
  readonly #scene = new Scene();
  readonly #camera = new PerspectiveCamera(2 * MathUtils.radToDeg(half), 1, 0.01, 50);
  readonly #controls: OrbitControls;
  readonly #body = cloth();
  readonly #lines = {
    inner: new Lines("#1c2530", 1, 0.3),
    border: new Lines("#1c2530", 1.8),
    cut: new Lines(mark.cut, 3),
    seam: new Lines(mark.seam, 4),
    preview: new Lines(mark.hover, 4.5),
    chosen: new Lines(mark.chosen, 3.5),
    hover: new Lines(mark.hover, 2.5),
  };
  readonly #dots = { cursor: dot(mark.hover), from: dot(mark.from), near: dot(mark.hover) };
  readonly #pins = new Group();
  #middle = [0, 0, 0];
  #scale = 1;
  #normals: Float32Array = new Float32Array(0);
  #colours: Uint32Array = new Uint32Array(0);
  #surface: Surface | null = null;
  #drawn: unknown[] = [];
  #asked = false;
  #down: { x: number; y: number } | null = null;
  // As long as the view does not turn.
  #sight: { key: unknown[]; sight: Sight } | undefined;

  constructor(shop: Workshop) {
    this.#shop = shop;
    const canvas = h("canvas", { "aria-hidden": "true" });
    this.#canvas = canvas;
    this.#renderer = hasGraphics()
      ? new WebGLRenderer({ canvas, antialias: true, alpha: true })
      : null;
    this.#soft = this.#renderer ? null : new SoftModel(canvas);
    this.element = h(
      "div",
      {
        class: "view model",
        id: "model",
        tabindex: 0,
        role: "application",
        "aria-label": words.flat.modelLabel,
        "aria-describedby": "model-keys",
      },
      canvas,
      h("p", { id: "model-keys", class: "unseen" }, words.flat.modelKeys),
    );
    const light = new DirectionalLight(0xffffff, 1.9);
    light.position.copy(lightPlace);
    this.#camera.add(light);
    this.#scene.add(new AmbientLight(0xffffff, 1.6), this.#camera, this.#body, this.#pins);
    this.#scene.add(...Object.values(this.#lines));
    this.#scene.add(...Object.values(this.#dots));
    this.#controls = new OrbitControls(this.#camera, this.element);
    this.#controls.minDistance = nearest;
    this.#controls.maxDistance = farthest;
    this.#controls.addEventListener("change", () => this.#ask());
    canvas.addEventListener("webglcontextrestored", () => this.#ask());
    this.#listen();
    new ResizeObserver(() => this.#resize()).observe(this.element);
  }

  // ---- from the surface to the view

  #place(point: number, into = new Vector3()): Vector3 {
    const { vertices } = this.#surface!;
    return into.set(
      (vertices[3 * point] - this.#middle[0]) * this.#scale,
      (vertices[3 * point + 1] - this.#middle[1]) * this.#scale,
      (vertices[3 * point + 2] - this.#middle[2]) * this.#scale,
    );
  }
  #inView = (point: number): [number, number] => {
    const { x, y } = this.#place(point).project(this.#camera);
    return [((x + 1) / 2) * this.element.clientWidth, ((1 - y) / 2) * this.element.clientHeight];
  };
  /** Where a point is in the window, for tests. */
  inWindow(point: number): [number, number] {
    const { left, top } = this.element.getBoundingClientRect();
    this.#camera.updateMatrixWorld();
    const [x, y] = this.#inView(point);
    return [left + x, top + y];
  }

  #hitAt(x: number, y: number): Hit | null {
    if (!this.#surface) return null;
    const { left, top } = this.element.getBoundingClientRect();
    const sight = this.#sightOf(this.#surface);
    const hit = sight.at(x - left, y - top);
    return hit || this.#shop.looks.tool === "look" ? hit : sight.beside(x - left, y - top);
  }

  // From the surface to the view, by way of the size 2 about the middle.
  #sightOf(surface: Surface): Sight {
    const { clientWidth: width, clientHeight: height } = this.element;
    const [x, y, z] = this.#middle.map((value) => -value);
    const { elements } = this.#clip()
      .scale(new Vector3().setScalar(this.#scale))
      .multiply(new Matrix4().makeTranslation(x, y, z));
    const key = [surface, width, height, ...elements];
    if (!this.#sight || key.some((value, i) => value !== this.#sight!.key[i]))
      this.#sight = { key, sight: new Sight(surface, elements, width, height) };
    return this.#sight.sight;
  }
  #clip(): Matrix4 {
    this.#camera.updateMatrixWorld();
    const { projectionMatrix, matrixWorldInverse } = this.#camera;
    return new Matrix4().multiplyMatrices(projectionMatrix, matrixWorldInverse);
  }

  #listen(): void {
    const { element } = this;
    element.addEventListener("pointerdown", (event) => {
      this.#down =
        event.isPrimary && event.button === 0 ? { x: event.clientX, y: event.clientY } : null;
    });
    element.addEventListener("pointerup", (event) => {
      const { clientX: x, clientY: y } = event;
      const down = this.#down;
      this.#down = null;
      if (down && Math.hypot(x - down.x, y - down.y) < slip) this.#shop.press(this.#hitAt(x, y));
    });
    element.addEventListener("pointermove", (event) => {
      if (event.buttons === 0 && event.pointerType !== "touch")
        this.#shop.point(this.#hitAt(event.clientX, event.clientY));
    });
    element.addEventListener("pointerleave", () => this.#shop.point(null));
    listenToKeys(this.#shop, this);
  }

  walk(dx: number, dy: number): void {
    if (!this.#surface) return;
    const { left, top, width, height } = this.element.getBoundingClientRect();
    const hit = this.#hitAt(left + width / 2, top + height / 2);
    const start = this.#surface.triangles[3 * (hit?.triangle ?? 0)];
    this.#shop.walk(this.#inView, dx, dy, start);
  }
  turn(dx: number, dy: number): void {
    const { target } = this.#controls;
    const way = new Spherical().setFromVector3(this.#camera.position.clone().sub(target));
    way.theta -= dx * angle;
    way.phi = Math.min(Math.PI - 0.05, Math.max(0.05, way.phi + dy * angle));
    this.#camera.position.setFromSpherical(way).add(target);
    this.#controls.update();
    this.#ask();
  }
  zoom(factor: number): void {
    const { target } = this.#controls;
    const way = this.#camera.position.clone().sub(target);
    way.setLength(Math.min(farthest, Math.max(nearest, way.length() / factor)));
    this.#camera.position.copy(way).add(target);
    this.#controls.update();
    this.#ask();
  }
  fit(): void {
    const { clientWidth: width, clientHeight: height } = this.element;
    const { size } = extentOf(this.#surface?.vertices ?? new Float64Array(0));
    // From the front and a little from above and the side; wide things need more room where it is narrow.
    const across = Math.hypot(size[0], size[2] * 0.5) * this.#scale;
    const up = Math.hypot(size[1], size[2] * 0.4) * this.#scale;
    const aspect = Math.max(0.2, width / Math.max(1, height));
    const away = (0.62 * Math.max(up, across / aspect, 0.3)) / Math.tan(half);
    this.#controls.target.set(0, 0, 0);
    this.#camera.position.set(0.42, 0.3, 1).setLength(away + 0.25);
    this.#controls.update();
    this.#ask();
  }

  // ---- drawing

  #resize(): void {
    const { clientWidth: width, clientHeight: height } = this.element;
    if (width === 0 || height === 0) return;
    const ratio = Math.min(2, devicePixelRatio);
    this.#renderer?.setPixelRatio(ratio);
    this.#renderer?.setSize(width, height, false);
    if (this.#soft)
      [this.#canvas.width, this.#canvas.height] = [width, height].map((one) =>
        Math.round(ratio * one),
      );
    this.#camera.aspect = width / height;
    this.#camera.updateProjectionMatrix();
    if (this.#drawn.length === 0) this.fit();
    this.#ask();
  }

  sync(): void {
    const { surface, edges, flat, pattern, looks } = this.#shop;
    if (surface !== this.#surface) this.#take(surface);
    if (!surface || !edges) return this.#ask();
    const { layout } = this.#shop;
    const piece =
      looks.chosenTriangle === null ? -1 : (layout?.pieceOf[looks.chosenTriangle] ?? -1);
    const palette = paletteOf(this.element);
    const now: unknown[] = [
      surface,
      edges,
      layout,
      flat.range,
      pattern.seams,
      piece,
      looks.tool === "look",
    ];
    now.push(palette.ink);
    if (now.some((value, i) => value !== this.#drawn[i])) {
      this.#drawn = now;
      this.#colour(piece);
      const count = surface.triangles.length / 3;
      const [inner, border]: [number[], number[]] = [[], []];
      for (let edge = 0; edge < edges.count; ++edge)
        (isBorder(edges, edge) ? border : inner).push(edge);
      const picks = looks.tool !== "look" && count <= mostInner;
      this.#lines.border.colour = palette.ink;
      this.#lines.inner.draw(picks ? this.#ends(inner) : []);
      this.#lines.border.draw(this.#ends(border));
      this.#lines.seam.draw(this.#ends(pattern.seams));
      this.#lines.cut.draw(this.#ends(layout?.autoCuts ?? []));
    }
    this.#lines.preview.draw(this.#ends(looks.preview));
    const sides = (triangle: number | null): number[] =>
      triangle === null ? [] : [0, 1, 2].map((k) => edges.ofTriangle[3 * triangle + k]);
    this.#lines.chosen.draw(this.#ends(sides(looks.chosenTriangle)));
    this.#lines.hover.draw(this.#ends(sides(looks.hover?.triangle ?? null)));
    this.#dot(this.#dots.cursor, looks.cursor?.point ?? null);
    this.#dot(this.#dots.from, looks.from);
    this.#dot(this.#dots.near, looks.near);
    while (this.#pins.children.length < pattern.pins.length) this.#pins.add(dot("#0b6e5f"));
    this.#pins.children.forEach((one, i) =>
      this.#dot(one as Mesh, pattern.pins[i]?.vertex ?? null),
    );
    this.#ask();
  }

  #dot(one: Mesh, point: number | null): void {
    one.visible = point !== null;
    if (point !== null) this.#place(point, one.position);
  }

  // Everything is drawn about the middle, at the size 2.
  #take(surface: Surface | null): void {
    this.#surface = surface;
    this.#drawn = [];
    this.#body.geometry.dispose();
    this.#body.geometry = new BufferGeometry();
    if (!surface) return;
    const { middle, size } = extentOf(surface.vertices);
    this.#middle = middle;
    this.#scale = 2 / (Math.hypot(...size) || 1);
    this.#normals = normalsOf(surface);
    if (this.#soft) return this.fit();
    const { triangles } = surface;
    const positions = new Float32Array(3 * triangles.length);
    const normals = new Float32Array(3 * triangles.length);
    const place = new Vector3();
    triangles.forEach((vertex, corner) => {
      this.#place(vertex, place).toArray(positions, 3 * corner);
      normals.set(this.#normals.subarray(3 * vertex, 3 * vertex + 3), 3 * corner);
    });
    const { geometry } = this.#body;
    geometry.setAttribute("position", new BufferAttribute(positions, 3));
    geometry.setAttribute("normal", new BufferAttribute(normals, 3));
    geometry.setAttribute("color", new BufferAttribute(new Float32Array(3 * triangles.length), 3));
    this.fit();
  }

  // As in the layout; where there is none, as cloth.
  #colour(piece: number): void {
    const { layout, flat } = this.#shop;
    if (this.#soft) {
      const count = this.#surface!.triangles.length / 3;
      this.#colours = layout
        ? coloursOf(layout, flat.range, piece)
        : new Uint32Array(count).fill(packed(...bare));
      return;
    }
    const attribute = this.#body.geometry.getAttribute("color") as BufferAttribute;
    const colours = attribute.array as Float32Array;
    const ink = (rgb: readonly number[]): number[] =>
      new Color().setRGB(rgb[0] / 255, rgb[1] / 255, rgb[2] / 255, "srgb").toArray();
    const inks = Array.from({ length: 2 * shades + 1 }, (_, i) => colourOf(i - shades));
    const full = inks.map(ink);
    const pale = inks.map((one) => ink(paleOf(one)));
    const plain = ink(bare);
    for (let t = 0; 3 * t < attribute.count; ++t) {
      const others = layout && piece >= 0 && layout.pieceOf[t] !== piece;
      const colour = layout
        ? (others ? pale : full)[shadeOf(layout.strain[t], flat.range) + shades]
        : plain;
      for (let k = 0; k < 3; ++k) colours.set(colour, 9 * t + 3 * k);
    }
    attribute.needsUpdate = true;
  }

  #ends(edges: readonly number[]): number[] {
    const known = this.#shop.edges!;
    const ends: number[] = [];
    const place = new Vector3();
    for (const edge of edges) {
      for (const point of [known.ends[2 * edge], known.ends[2 * edge + 1]])
        ends.push(...this.#place(point, place).toArray());
    }
    return ends;
  }

  #ask(): void {
    if (this.#asked) return;
    this.#asked = true;
    requestAnimationFrame(() => {
      this.#asked = false;
      if (this.#soft) return this.#drawSoftly(this.#soft);
      // Dots keep their size on the screen.
      const far = this.#camera.position.distanceTo(this.#controls.target);
      const size = (dotRadius * 2 * far * Math.tan(half)) / Math.max(1, this.element.clientHeight);
      for (const one of [...Object.values(this.#dots), ...this.#pins.children])
        one.scale.setScalar(size);
      this.#renderer!.render(this.#scene, this.#camera);
    });
  }

  #drawSoftly(soft: SoftModel): void {
    const surface = this.#surface;
    const { clientWidth: width } = this.element;
    if (!surface || width === 0 || this.#colours.length === 0) return;
    const sight = this.#sightOf(surface);
    const light = lightPlace.clone().normalize().transformDirection(this.#camera.matrixWorld);
    const shown = [...Object.values(this.#dots), ...this.#pins.children].filter(
      (one) => one.visible,
    ) as Mesh<BufferGeometry, MeshBasicMaterial>[];
    soft.draw(
      {
        sight,
        triangles: surface.triangles,
        normals: this.#normals,
        light: [light.x, light.y, light.z],
        colours: this.#colours,
        strokes: Object.values(this.#lines)
          .filter((one) => one.visible)
          .map((one) => ({ ends: one.ends, ...one.ink })),
        dots: shown.map(({ position, material }) => ({
          place: [position.x, position.y, position.z],
          colour: `#${material.color.getHexString()}`,
        })),
        dotRadius,
        clip: this.#clip().elements,
      },
      this.#canvas.width / width,
    );
  }
}
