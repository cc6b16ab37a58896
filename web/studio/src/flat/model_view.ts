// The surface in space, drawn with three.js, in a file that is loaded when it is needed.
import {
  AmbientLight,
  BufferAttribute,
  BufferGeometry,
  Color,
  DirectionalLight,
  DoubleSide,
  Group,
  MathUtils,
  Mesh,
  MeshLambertMaterial,
  PerspectiveCamera,
  Raycaster,
  Scene,
  Spherical,
  Triangle,
  Vector2,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";

import { h } from "../ui/dom.js";
import { words } from "../words.js";
import { listenToKeys } from "./keys.js";
import { Lines, dot } from "./marks.js";
import { mark, paletteOf } from "./palette.js";
import { colourOf, shadeOf } from "./strain.js";
import { extentOf, hitBeside, isBorder } from "./surface.js";
import type { Hit, Surface } from "./surface.js";
import type { Workshop } from "./workshop.js";

const clickReach = 5;
const dotRadius = 6; // pixels
const half = 0.31; // of the angle of view
const angle = Math.PI / 18; // that an arrow key turns by
const [nearest, farthest] = [0.1, 20]; // The model has the size 2.
const mostInner = 60_000; // triangles whose edges are shown, and found beside them

export class ModelView {
  readonly element: HTMLElement;
  readonly #shop: Workshop;
  readonly #renderer: WebGLRenderer;
  readonly #scene = new Scene();
  readonly #camera = new PerspectiveCamera(2 * MathUtils.radToDeg(half), 1, 0.01, 50);
  readonly #controls: OrbitControls;
  readonly #body = new Mesh(
    new BufferGeometry(),
    new MeshLambertMaterial({
      vertexColors: true,
      side: DoubleSide,
      polygonOffset: true,
      polygonOffsetFactor: 1.5,
      polygonOffsetUnits: 2,
    }),
  );
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
  #surface: Surface | null = null;
  #drawn: unknown[] = [];
  #asked = false;
  #down: { x: number; y: number } | null = null;

  /** Throws where there is no WebGL. */
  constructor(shop: Workshop) {
    this.#shop = shop;
    const canvas = h("canvas", { "aria-hidden": "true" });
    this.#renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true });
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
    light.position.set(0.6, 0.9, 1.4);
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
  #inDepth = (point: number): [number, number, number] => {
    const place = this.#place(point).project(this.#camera);
    const { clientWidth: width, clientHeight: height } = this.element;
    return [((place.x + 1) / 2) * width, ((1 - place.y) / 2) * height, place.z];
  };
  #inView = (point: number): [number, number] => {
    const [x, y] = this.#inDepth(point);
    return [x, y];
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
    const { left, top, width, height } = this.element.getBoundingClientRect();
    const at = new Vector2(((x - left) / width) * 2 - 1, 1 - ((y - top) / height) * 2);
    const ray = new Raycaster();
    ray.setFromCamera(at, this.#camera);
    const [found] = ray.intersectObject(this.#body);
    if (!found || found.faceIndex === null || found.faceIndex === undefined) {
      const isLarge = this.#surface.triangles.length > 3 * mostInner;
      if (this.#shop.looks.tool === "look" || isLarge) return null;
      return hitBeside(this.#surface, this.#inDepth, x - left, y - top);
    }
    const { triangles } = this.#surface;
    const [a, b, c] = [0, 1, 2].map((k) => this.#place(triangles[3 * found.faceIndex! + k]));
    const weights = Triangle.getBarycoord(found.point, a, b, c, new Vector3());
    return weights && { triangle: found.faceIndex, weights: [weights.x, weights.y, weights.z] };
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
      if (down && Math.hypot(x - down.x, y - down.y) < clickReach)
        this.#shop.press(this.#hitAt(x, y));
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
    this.#renderer.setPixelRatio(Math.min(2, devicePixelRatio));
    this.#renderer.setSize(width, height, false);
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
    const { triangles } = surface;
    const positions = new Float32Array(3 * triangles.length);
    const normals = new Float32Array(surface.vertices.length);
    const at = [new Vector3(), new Vector3(), new Vector3()];
    for (let corner = 0; corner < triangles.length; corner += 3) {
      at.forEach((place, k) => {
        this.#place(triangles[corner + k], place).toArray(positions, 3 * (corner + k));
      });
      // As long as twice the area: large triangles count for more.
      const normal = at[1].clone().sub(at[0]).cross(at[2].clone().sub(at[0]));
      for (let k = 0; k < 3; ++k) {
        const vertex = 3 * triangles[corner + k];
        normals[vertex] += normal.x;
        normals[vertex + 1] += normal.y;
        normals[vertex + 2] += normal.z;
      }
    }
    const perCorner = new Float32Array(3 * triangles.length);
    triangles.forEach((vertex, corner) => {
      const normal = new Vector3().fromArray(normals, 3 * vertex).normalize();
      normal.toArray(perCorner, 3 * corner);
    });
    const { geometry } = this.#body;
    geometry.setAttribute("position", new BufferAttribute(positions, 3));
    geometry.setAttribute("normal", new BufferAttribute(perCorner, 3));
    geometry.setAttribute("color", new BufferAttribute(new Float32Array(3 * triangles.length), 3));
    this.fit();
  }

  // As in the layout; where there is none, as cloth.
  #colour(piece: number): void {
    const { layout, flat } = this.#shop;
    const attribute = this.#body.geometry.getAttribute("color") as BufferAttribute;
    const colour = new Color();
    for (let t = 0; 3 * t < attribute.count; ++t) {
      const shade = layout ? shadeOf(layout.strain[t], flat.range) : 0;
      const [r, g, b] = layout ? colourOf(shade) : [214, 208, 196];
      const pale = layout && piece >= 0 && layout.pieceOf[t] !== piece;
      const mixed = pale ? [r, g, b].map((value) => 0.35 * value + 0.65 * 150) : [r, g, b];
      colour.setRGB(mixed[0] / 255, mixed[1] / 255, mixed[2] / 255, "srgb");
      for (let k = 0; k < 3; ++k) attribute.setXYZ(3 * t + k, colour.r, colour.g, colour.b);
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
      // Dots keep their size on the screen.
      const far = this.#camera.position.distanceTo(this.#controls.target);
      const size = (dotRadius * 2 * far * Math.tan(half)) / Math.max(1, this.element.clientHeight);
      for (const one of [...Object.values(this.#dots), ...this.#pins.children])
        one.scale.setScalar(size);
      this.#renderer.render(this.#scene, this.#camera);
    });
  }
}
