// What the flatten page does: the document with its history, and the layouts that follow it.
import { Desk } from "../desk.js";
import { words } from "../words.js";
import { Flattening, sentenceOf } from "./flattening.js";
import { flatOf } from "./layout.js";
import type { Layout } from "./layout.js";
import { surfaceOfFile } from "./net.js";
import { emptyPattern, isUnlikely, withPin, withoutPin } from "./pattern.js";
import type { Grain, Pattern } from "./pattern.js";
import { samples } from "./samples.js";
import { loopThrough, shortestPath, toggled } from "./seams.js";
import { extentOf, isBorder, isOnBorder, nearestEdge, nearestVertex, otherEnd } from "./surface.js";
import type { Edges, Hit, Surface } from "./surface.js";

export type Tool = "look" | "edge" | "loop" | "path" | "pin" | "grain";

/** What the page shows and nobody takes back. */
export interface Looks {
  tool: Tool;
  /** Under the pointer. */
  hover: Hit | null;
  /** Edges that a click would cut, and the vertex that it would take. */
  preview: readonly number[];
  near: number | null;
  chosenTriangle: number | null;
  /** Where keys walk: a point, and the edge by which it was reached. */
  cursor: { point: number; edge: number } | null;
  /** The point where a path, or the vertex where a grain line, begins. */
  from: number | null;
  /** The vertex whose pin is chosen. */
  pin: number | null;
}

const atFirst: Looks = {
  tool: "look",
  hover: null,
  preview: [],
  near: null,
  chosenTriangle: null,
  cursor: null,
  from: null,
  pin: null,
};

const mostPreviewed = 600_000; // edges: more are searched when clicked, not under the pointer
const mostPins = 64;

export class Workshop extends Desk<Pattern> {
  looks: Looks = atFirst;
  readonly flat = new Flattening(() => this.changed());
  /** A file has been saved. */
  onSaved: () => void = () => {};

  constructor() {
    super(emptyPattern);
  }

  get pattern(): Pattern {
    return this.history.present;
  }
  get surface(): Surface | null {
    return this.pattern.surface;
  }
  get edges(): Edges | null {
    const { surface, mend } = this.pattern;
    return surface && this.flat.edgesOf(surface, mend);
  }
  get layout(): Layout | undefined {
    return this.flat.layouts[0];
  }
  get isSettled(): boolean {
    return this.flat.isOf(this.pattern);
  }
  /** The longest side of the model in millimetres. */
  get size(): number {
    const { surface, millimetresPerUnit } = this.pattern;
    return surface ? Math.max(...extentOf(surface.vertices).size) * millimetresPerUnit : 0;
  }
  get isSizeUnlikely(): boolean {
    return isUnlikely(this.size);
  }

  look(change: Partial<Looks>): void {
    this.looks = { ...this.looks, ...change };
    this.changed();
  }
  choose(tool: Tool): void {
    this.look({ tool, preview: [], near: null, from: null });
  }

  // ---- models

  openSample(index: number): void {
    const { make, millimetresPerUnit } = samples[index];
    this.#open(make(), millimetresPerUnit);
  }

  async openFile(file: File): Promise<void> {
    const signal = this.flat.halt("reading");
    try {
      const surface = await surfaceOfFile(file, signal);
      if (surface.triangles.length === 0) this.#refuse(words.flat.noTriangles(file.name));
      // A GLB file is in metres.
      else this.#open(surface, surface.format === "glb" ? 1000 : 1);
    } catch (error) {
      if (!signal.aborted) this.#refuse(words.flat.badFile(file.name, sentenceOf(error)));
    }
  }

  // The model that was there stays.
  #refuse(sentence: string): void {
    this.say(sentence, true);
    if (this.surface) this.again();
    else this.flat.halt("empty");
  }

  #open(surface: Surface, millimetresPerUnit: number): void {
    const { method, other, autoCut, injective } = this.pattern;
    const kept = { method, other, autoCut, injective };
    const mend = surface.format === "glb";
    const fresh = { ...emptyPattern, ...kept, surface, millimetresPerUnit, mend };
    this.looks = { ...atFirst, tool: this.looks.tool };
    if (this.surface) this.#do(fresh, words.flat.steps.open(surface.name));
    else {
      this.history.amend(fresh);
      this.#follow();
    }
    for (const warning of surface.warnings) this.say(warning, true);
  }

  // ---- pointing

  /** The pointer is over the surface, in whichever view; null: it is not. */
  point(hit: Hit | null): void {
    const { surface, edges, looks } = this;
    if (!surface || !edges || (hit === null && looks.hover === null)) return;
    let preview: readonly number[] = [];
    const { tool, from } = looks;
    if (hit && tool === "edge") preview = [nearestEdge(edges, hit)];
    else if (hit && tool === "loop") preview = loopThrough(surface, edges, nearestEdge(edges, hit));
    else if (hit && tool === "path" && from !== null && edges.count < mostPreviewed)
      preview = shortestPath(surface, edges, from, edges.pointOf[nearestVertex(surface, hit)]);
    const takesVertex = tool === "path" || tool === "pin" || tool === "grain";
    const near = hit && takesVertex ? edges.pointOf[nearestVertex(surface, hit)] : null;
    this.look({ hover: hit, preview, near });
  }

  /** The surface is clicked. */
  press(hit: Hit | null): void {
    const { surface, edges } = this;
    if (!surface || !edges) return;
    if (this.looks.tool === "look") {
      const chosen = hit?.triangle ?? null;
      this.look({
        chosenTriangle: chosen === this.looks.chosenTriangle ? null : chosen,
        pin: null,
      });
    } else if (hit) {
      const edge = nearestEdge(edges, hit);
      this.#use(nearestVertex(surface, hit), edge);
    }
  }

  /** Enter where the keys have walked to. */
  act(): void {
    const { cursor, tool } = this.looks;
    const { surface, edges } = this;
    if (!cursor || !surface || !edges) return this.say(words.flat.said.walkFirst);
    if (tool === "look") {
      const corner = surface.triangles.findIndex((one) => edges.pointOf[one] === cursor.point);
      this.look({ chosenTriangle: Math.floor(corner / 3) });
    } else this.#use(cursor.point, cursor.edge);
  }

  // The tool at a vertex, and at an edge; -1: none.
  #use(vertex: number, edge: number): void {
    const [surface, edges] = [this.surface!, this.edges!];
    const { tool, from } = this.looks;
    const point = edges.pointOf[vertex];
    if (tool === "edge" || tool === "loop") {
      if (edge < 0) return this.say(words.flat.said.walkFirst);
      if (isBorder(edges, edge)) return this.say(words.flat.said.border, true);
      this.seam(tool === "edge" ? [edge] : loopThrough(surface, edges, edge));
    } else if (tool === "path") {
      if (from === null) {
        this.say(words.flat.said.from);
        return this.look({ from: point });
      }
      const path = shortestPath(surface, edges, from, point);
      if (path.length === 0) return this.say(words.flat.said.noPath, true);
      // At the border it has ended; elsewhere it goes on.
      const next = isOnBorder(edges, point) ? null : point;
      this.looks = { ...this.looks, from: next, preview: [], near: null };
      const inside = path.filter((one) => !isBorder(edges, one));
      if (inside.length === 0) return this.say(words.flat.said.border, true);
      this.seam(inside);
    } else if (tool === "pin") this.addPin(vertex);
    else if (tool === "grain") {
      if (from === null) {
        this.say(words.flat.said.from);
        return this.look({ from: vertex });
      }
      if (from !== vertex) this.addGrain(from, vertex);
      this.look({ from: null });
    }
  }

  /**
   * The cursor goes to the neighbour that lies most nearly in this direction of the view, where `place` puts
   * points; the first time to `start`.
   */
  walk(
    place: (point: number) => readonly [number, number],
    dx: number,
    dy: number,
    start: number,
  ): void {
    const { edges } = this;
    if (!edges) return;
    const { cursor } = this.looks;
    if (!cursor) {
      this.#stand(edges.pointOf[start], -1);
      return;
    }
    const [x, y] = place(cursor.point);
    let best = -1;
    let most = 0.2;
    for (let i = edges.first[cursor.point]; i < edges.first[cursor.point + 1]; ++i) {
      const [nx, ny] = place(otherEnd(edges, edges.around[i], cursor.point));
      const length = Math.hypot(nx - x, ny - y) || 1;
      const cosine = ((nx - x) * dx + (ny - y) * dy) / length;
      if (cosine > most) [best, most] = [edges.around[i], cosine];
    }
    if (best < 0) this.say(words.flat.said.noWay);
    else this.#stand(otherEnd(edges, best, cursor.point), best);
  }

  #stand(point: number, edge: number): void {
    const [surface, edges] = [this.surface!, this.edges!];
    const { tool, from } = this.looks;
    let preview: readonly number[] = [];
    if (edge >= 0 && tool === "edge") preview = [edge];
    else if (edge >= 0 && tool === "loop") preview = loopThrough(surface, edges, edge);
    else if (tool === "path" && from !== null) preview = shortestPath(surface, edges, from, point);
    this.look({ cursor: { point, edge }, preview });
    this.say(words.flat.said.at(point, edge >= 0 && this.pattern.seams.includes(edge)));
  }

  /** Leaves what is half done. */
  escape(): void {
    this.look({ from: null, preview: [], near: null, chosenTriangle: null, cursor: null });
  }

  // ---- changes of the document

  change(change: Partial<Pattern>, label: string, key = ""): void {
    this.#do({ ...this.pattern, ...change }, label, key);
  }

  seam(edges: readonly number[]): void {
    const before = this.pattern.seams.length;
    const seams = toggled(this.pattern.seams, edges);
    const added = seams.length > before;
    this.change({ seams }, added ? words.flat.steps.seam : words.flat.steps.unseam);
    this.say(added ? words.flat.said.seam(edges.length) : words.flat.said.unseam(edges.length));
  }

  addPin(vertex: number): void {
    const { layout } = this;
    if (!layout) return this.say(words.flat.said.noLayout, true);
    if (this.pattern.pins.length >= mostPins)
      return this.say(words.flat.said.manyPins(mostPins), true);
    const [u, v] = flatOf(layout, vertex);
    this.looks = { ...this.looks, pin: vertex };
    this.#do(withPin(this.pattern, { vertex, u, v }), words.flat.steps.pin);
    this.say(words.flat.said.pin(vertex));
  }
  movePin(vertex: number, u: number, v: number): void {
    this.#do(withPin(this.pattern, { vertex, u, v }), words.flat.steps.movePin, `pin-${vertex}`);
  }
  removePin(vertex: number): void {
    this.#do(withoutPin(this.pattern, vertex), words.flat.steps.removePin);
    if (this.looks.pin === vertex) this.look({ pin: null });
  }

  addGrain(from: number, to: number): void {
    const { layout, surface } = this;
    if (!layout || !surface) return this.say(words.flat.said.noLayout, true);
    // One for each piece.
    const pieceOf = (vertex: number): number =>
      layout.pieceOf[Math.floor(surface.triangles.indexOf(vertex) / 3)] ?? 0;
    const piece = pieceOf(from);
    if (pieceOf(to) !== piece) return this.say(words.flat.said.grainPieces, true);
    const others = this.pattern.grains.filter((grain) => pieceOf(grain.from) !== piece);
    const grain: Grain = { from, to, angle: 90 };
    this.change({ grains: [...others, grain] }, words.flat.steps.grain);
    this.say(words.flat.said.grain);
  }

  protected override jumped(): void {
    this.looks = { ...atFirst, tool: this.looks.tool };
    this.#follow();
  }
  #do(pattern: Pattern, label: string, key = ""): void {
    this.history.do(pattern, label, key);
    this.#follow();
  }

  // ---- layouts

  #follow(): void {
    this.flat.follow(this.pattern);
  }
  /** Tries again, after it was cancelled or has failed. */
  again(): void {
    this.flat.again(this.pattern);
  }
  cancel(): void {
    this.flat.halt("cancelled");
    this.say(words.flat.said.cancelled);
  }
}
