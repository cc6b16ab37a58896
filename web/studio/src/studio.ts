// What the page does: the document with its history, and the stream that follows it.
import { Desk } from "./desk.js";
import { bodyOf, spread } from "./meshing.js";
import type { MeshFacts } from "./meshing.js";
import { figureOf } from "./model/figure.js";
import type { Figure } from "./model/figure.js";
import { nearestHold, placeOf } from "./model/geometry.js";
import type { Hold } from "./model/geometry.js";
import { defaultLooks } from "./model/looks.js";
import type { Looks } from "./model/looks.js";
import {
  atRest,
  emptyPuppet,
  keepPose,
  moveTo,
  newPin,
  paintStarch,
  pinAt,
} from "./model/puppet.js";
import type { Body, Cut, Motion, Pin, Puppet } from "./model/puppet.js";
import { Problem } from "./net/api.js";
import { Live } from "./net/live.js";
import type { Connection } from "./net/live.js";
import { Session } from "./net/session.js";
import { samples } from "./samples/index.js";
import { Meter } from "./view/meter.js";
import { orderOf } from "./view/order.js";
import { words } from "./words.js";

const none: readonly number[] = [];

export class Studio extends Desk<Puppet> {
  readonly figures: Figure[] = [];
  readonly session = new Session();
  readonly meter = new Meter();
  looks: Looks = defaultLooks;
  connection: Connection = "idle";
  /** The newest shape of the body; at rest before there is one. */
  shape: Float64Array = new Float64Array(0);
  flipped: readonly number[] = none;
  order: readonly number[] = none;
  /** Poses that were, for the onion skin. */
  trail: Float64Array[] = [];
  working = false;
  /** What the mesh is being made with. */
  pendingCut: Cut | null = null;
  readonly #facts = new WeakMap<Body, MeshFacts>();
  readonly #live: Live;
  #moving = 0;
  #gesture = 0;
  #making = 0;
  #pointerAt = new Map<number, number>();
  #newestPointer: number | undefined;
  #lastTrail = 0;

  constructor() {
    super(emptyPuppet(0));
    this.#live = new Live(this.session, {
      connection: (state, problem) => {
        this.connection = state;
        if (state === "lost" && problem && !problem.passes && problem.status !== 404) {
          this.say(words.wentWrong(problem.message), true);
        }
        this.changed();
      },
      shape: (shape, after) => {
        const { facts } = shape;
        const now = performance.now();
        const server = (facts.queueMicros + facts.solveMicros) / 1000;
        this.meter.shapes.add(1, now);
        this.meter.server.add(server, now);
        if (after !== undefined) this.meter.network.add(Math.max(0, after - server), now);
        for (const [sequence, at] of this.#pointerAt) {
          if (sequence > shape.sequence) continue;
          this.#newestPointer = at;
          this.#pointerAt.delete(sequence);
        }
        this.#show(shape.positions, facts.flippedIds ?? none);
        this.onShape();
      },
      order: (order) => {
        this.order = order;
        this.onShape();
      },
      refused: (problem) => {
        this.say(words.wentWrong(problem.message), true);
        // What was refused changed nothing there, and is taken back here.
        if (!problem.passes && this.history.undoable !== undefined) this.undo();
      },
    });
  }

  /** The stage draws. */
  onShape: () => void = () => {};

  get puppet(): Puppet {
    return this.history.present;
  }
  get figure(): Figure | undefined {
    return this.figures[this.puppet.figure];
  }
  get facts(): MeshFacts | undefined {
    return this.puppet.body ? this.#facts.get(this.puppet.body) : undefined;
  }
  /** Triangles back to front: as depths have it, else limbs before the body. */
  get drawOrder(): ArrayLike<number> {
    const { body } = this.puppet;
    return this.order.length > 0 || !body ? this.order : orderOf(body.triangles);
  }
  /** Whether the shape is that of the document. */
  get isSettled(): boolean {
    return !this.working && this.#live.isSettled;
  }
  /** For how many ms the server owes an answer. */
  get waiting(): number {
    return this.#live.waiting;
  }
  get chosen(): Pin | undefined {
    return this.puppet.pins.find((pin) => pin.id === this.looks.chosen);
  }

  look(looks: Partial<Looks>): void {
    this.looks = { ...this.looks, ...looks };
    this.changed();
  }

  async openSample(index: number): Promise<void> {
    const sample = samples[index];
    const known = this.figures.findIndex((one) => one.name === sample.name);
    const figure = this.figures[known] ?? (await figureOf(sample.name, sample.source, sample.pins));
    await this.#open(figure);
  }

  async openFile(file: File): Promise<void> {
    let figure: Figure;
    try {
      figure = await figureOf(file.name.replace(/\.[^.]*$/, ""), file);
    } catch {
      this.say(words.puppet.noPicture(file.name), true);
      return;
    }
    if (figure.scaled) this.say(words.puppet.scaled(figure.canvas.width, figure.canvas.height));
    await this.#open(figure);
  }

  async #open(figure: Figure): Promise<void> {
    let index = this.figures.indexOf(figure);
    if (index < 0) index = this.figures.push(figure) - 1;
    const fresh = { ...emptyPuppet(index), cut: this.puppet.cut, motion: this.puppet.motion };
    const first = this.puppet.body === null;
    await this.#mesh(fresh, words.steps.open(figure.name), first);
  }

  /** Makes the mesh anew; pins stay where they are on the picture. */
  async cut(cut: Cut): Promise<void> {
    if (!this.puppet.body) return;
    await this.#mesh({ ...this.puppet, cut }, words.steps.mesh, false);
  }

  async #mesh(wanted: Puppet, step: string, first: boolean): Promise<void> {
    const making = ++this.#making;
    const figure = this.figures[wanted.figure];
    this.working = true;
    this.pendingCut = wanted.cut;
    this.changed();
    try {
      const meshed = await bodyOf(figure, wanted.cut);
      if (making !== this.#making) return;
      if (!meshed) {
        this.say(words.puppet.empty, true);
        return;
      }
      const { body, facts } = meshed;
      this.#facts.set(body, facts);
      if (facts.opaque) this.say(words.puppet.opaque);
      // Pins that have come meanwhile go along.
      const now = this.puppet;
      const pins = now.figure === wanted.figure ? moveTo(body, now.pins, now.body) : [];
      const made = { ...wanted, body, pins, starch: null };
      if (first) this.history.amend(made);
      else this.#do(made, step);
      this.#follow();
    } catch (error) {
      if (making !== this.#making) return;
      // Of the gateway, or of the server behind it.
      const unreachable =
        error instanceof Problem && (error.status === 0 || error.reason === "DRAINING");
      this.say(
        unreachable ? words.state.unreachable : words.wentWrong((error as Error).message),
        true,
      );
      if (error instanceof Problem && error.passes) {
        setTimeout(() => {
          if (making === this.#making) void this.#mesh(wanted, step, first);
        }, error.retryAfterMs ?? 2000);
      }
    } finally {
      if (making === this.#making) {
        this.working = false;
        this.pendingCut = null;
        this.changed();
      }
    }
  }

  /** Where the figure is hit, in its pixels; gives the pin, or undefined outside of it. */
  addPin(x: number, y: number): Pin | undefined {
    const pin = pinAt(this.puppet, this.shape, this.drawOrder, x, y);
    if (!pin) return undefined;
    this.#do({ ...this.puppet, pins: [...this.puppet.pins, pin] }, words.steps.add(pin.id));
    this.looks = { ...this.looks, chosen: pin.id };
    this.say(words.said.added(pin.id));
    this.#follow();
    return pin;
  }

  /** Places the pins that do well on this figure, or some that lie far apart. */
  suggestPins(): void {
    const { body } = this.puppet;
    const { figure } = this;
    if (!body || !figure) return;
    const places = figure.pins.length > 0 ? figure.pins : spread(body, 5);
    const pins = [...this.puppet.pins];
    for (const [x, y] of places) {
      const hold: Hold = nearestHold(x, y, body.triangles, body.picture);
      const [px, py] = placeOf(hold, body.triangles, this.shape);
      pins.push(newPin(pins, hold, px, py));
    }
    this.#go({ ...this.puppet, pins }, words.steps.suggest);
  }

  /** Pins that are being dragged belong to one step until all are let go. */
  beginMove(): void {
    if (this.#moving++ === 0) ++this.#gesture;
  }
  endMove(): void {
    if (--this.#moving > 0) return;
    this.history.seal();
    if (this.looks.follow === "release") this.#follow();
  }

  /** `at` is when the pointer moved, in ms of performance.now(). */
  movePin(id: string, change: Partial<Pin>, at?: number): void {
    const pins = this.puppet.pins.map((pin) => (pin.id === id ? { ...pin, ...change } : pin));
    const key = this.#moving > 0 ? `move-${this.#gesture}` : `keys-${id}`;
    this.#do({ ...this.puppet, pins }, words.steps.move(id), key);
    if (this.#moving > 0 && this.looks.follow === "release") return;
    const sequence = this.#follow();
    if (sequence !== undefined && at !== undefined) this.#pointerAt.set(sequence, at);
  }

  changePin(id: string, change: Partial<Pin>, done = true): void {
    const pins = this.puppet.pins.map((pin) => (pin.id === id ? { ...pin, ...change } : pin));
    const key = `change-${id}-${Object.keys(change).join()}`;
    this.#do({ ...this.puppet, pins }, words.steps.change(id), key);
    if (done) this.history.seal();
    this.#follow();
  }

  removePin(id: string, keep = false): void {
    const pins = this.puppet.pins.filter((pin) => pin.id !== id);
    const without = keep ? keepPose(this.puppet, this.shape, pins) : { ...this.puppet, pins };
    this.#go(without, words.steps.remove(id));
    this.say(words.said.removed(id));
  }

  removeAllPins(): void {
    this.#go({ ...this.puppet, pins: [] }, words.steps.removeAll);
  }

  rest(): void {
    this.#go(atRest(this.puppet), words.steps.rest);
  }

  keepPose(): void {
    this.#go(keepPose(this.puppet, this.shape, this.puppet.pins), words.steps.keep);
  }

  // A step of the same mesh, perhaps in another pose, which the server is to follow.
  #go(puppet: Puppet, label: string): void {
    const { facts } = this;
    if (puppet.body && facts) this.#facts.set(puppet.body, facts);
    this.#do(puppet, label);
    this.#follow();
  }

  setMotion(motion: Partial<Motion>, done = true): void {
    const key = `motion-${Object.keys(motion).join()}`;
    this.#do(
      { ...this.puppet, motion: { ...this.puppet.motion, ...motion } },
      words.steps.motion,
      key,
    );
    if (done) this.history.seal();
    this.#follow();
  }

  /** A stroke is one step; the mesh is made stiff when it ends. */
  paint(x: number, y: number): void {
    const { body, starch } = this.puppet;
    if (!body) return;
    const { radius, amount } = this.looks.brush;
    const painted = paintStarch(body, this.shape, starch, x, y, radius, amount);
    this.#do({ ...this.puppet, starch: painted }, words.steps.starch, `paint-${this.#gesture}`);
  }
  beginPaint(): void {
    ++this.#gesture;
  }
  endPaint(): void {
    this.history.seal();
    this.#follow();
  }
  wash(): void {
    this.#go({ ...this.puppet, starch: null }, words.steps.wash);
  }

  /** A step made elsewhere: of the take, say. */
  step(puppet: Puppet, label: string, key = ""): void {
    this.#do(puppet, label, key);
  }

  protected override jumped(): void {
    ++this.#making;
    this.working = false;
    this.pendingCut = null;
    this.#follow();
    this.changed();
  }

  #do(puppet: Puppet, label: string, key = ""): void {
    this.history.do(puppet, label, key);
    this.changed();
  }

  #shown: Body | null = null;

  /** What the document says goes to the server, if there is something to say. */
  #follow(): number | undefined {
    const { body, pins, starch, motion } = this.puppet;
    if (!body) return undefined;
    if (body !== this.#shown) {
      const likewise = this.#shown?.triangles === body.triangles;
      this.#shown = body;
      this.order = likewise ? this.order : none;
      this.trail = [];
      if (!likewise || this.shape.length !== body.rest.length) {
        this.#show(body.rest, none);
      }
      this.onShape();
    }
    return this.#live.want({ body, pins, starch, motion });
  }

  #show(positions: Float64Array, flipped: readonly number[]): void {
    const now = performance.now();
    if (this.looks.onion && this.shape.length === positions.length && now - this.#lastTrail > 180) {
      this.trail = [...this.trail.slice(-3), this.shape];
      this.#lastTrail = now;
    }
    this.shape = positions;
    this.flipped = flipped;
  }

  /** The picture that shows the newest shape is there. */
  painted(): void {
    if (this.#newestPointer === undefined) return;
    this.meter.lag.add(performance.now() - this.#newestPointer);
    this.#newestPointer = undefined;
  }
}
