// The document: a figure, its mesh, its pins and how it moves. Values that are replaced, never changed.
import { holdAt, nearestHold, placeOf } from "./geometry.js";
import type { Hold } from "./geometry.js";
import type { Take } from "./take.js";

/** A mesh of a figure. Units are its pixels, y is up. */
export interface Body {
  /** Where every vertex is on the picture: x y x y…. */
  picture: Float64Array;
  /** Where it rests. The same, until a pose has been kept. */
  rest: Float64Array;
  /** i j k…. */
  triangles: Uint32Array;
}

export type Firmness = "exact" | "firm" | "soft";

export interface Pin {
  id: string;
  hold: Hold;
  /** Where it is to be. */
  x: number;
  y: number;
  /** Whether it also holds an angle and a scale. */
  turns: boolean;
  /** In radians, against the rest pose. */
  angle: number;
  scale: number;
  firmness: Firmness;
  /** Of a soft pin: how much a miss counts, against the figure. */
  weight: number;
  /** Everything within so many pixels moves with it rigidly; 0: nothing. */
  area: number;
  /** Higher is nearer. */
  depth: number;
}

export interface Cut {
  threshold: number;
  tolerance: number;
  expansion: number;
  /** About how many vertices the mesh is to have. */
  vertices: number;
}

export interface Motion {
  basis: "edge" | "edge_as_published" | "face" | "vertex";
  weights: "uniform" | "cotangent";
  mode: "rigid" | "similarity" | "baseline";
  refine: number;
}

export interface Puppet {
  /** Which of the figures that the page has. */
  figure: number;
  cut: Cut;
  body: Body | null;
  /** How stiff every triangle is, or null: 1 everywhere. */
  starch: Float32Array | null;
  pins: readonly Pin[];
  motion: Motion;
  take: Take | null;
}

export const defaultCut: Cut = { threshold: 128, tolerance: 1, expansion: 2, vertices: 600 };
export const defaultMotion: Motion = {
  basis: "edge",
  weights: "uniform",
  mode: "rigid",
  refine: 0,
};

export const emptyPuppet = (figure: number): Puppet => ({
  figure,
  cut: defaultCut,
  body: null,
  starch: null,
  pins: [],
  motion: defaultMotion,
  take: null,
});

/** A name that no pin has. */
export function freshId(pins: readonly Pin[]): string {
  const taken = new Set(pins.map((pin) => pin.id));
  let number = 1;
  while (taken.has(`pin-${number}`)) ++number;
  return `pin-${number}`;
}

export const newPin = (pins: readonly Pin[], hold: Hold, x: number, y: number): Pin => ({
  id: freshId(pins),
  hold,
  x,
  y,
  turns: false,
  angle: 0,
  scale: 1,
  firmness: "firm",
  weight: 1,
  area: 0,
  depth: 0,
});

/** Where a pin's place rests. */
export const restOf = (pin: Pin, body: Body): [number, number] =>
  placeOf(pin.hold, body.triangles, body.rest);

/** Whether the server has to hear of a pin anew, and not only of where it goes. */
export const sameHandle = (a: Pin, b: Pin): boolean =>
  a.id === b.id &&
  a.hold === b.hold &&
  a.turns === b.turns &&
  a.firmness === b.firmness &&
  (a.firmness !== "soft" || a.weight === b.weight) &&
  a.area === b.area &&
  a.depth === b.depth;

/** Pins on another mesh of the same picture, at rest where they were on the picture. */
export function moveTo(body: Body, pins: readonly Pin[], old: Body | null): Pin[] {
  return pins.map((pin) => {
    if (!old) return pin;
    const [x, y] = placeOf(pin.hold, old.triangles, old.picture);
    const hold = nearestHold(x, y, body.triangles, body.picture);
    const [restX, restY] = placeOf(hold, body.triangles, body.rest);
    return { ...pin, hold, x: restX, y: restY, angle: 0, scale: 1 };
  });
}

/** The same puppet, at rest in this pose: pins that are left need not hold it any more. */
export function keepPose(puppet: Puppet, shape: ArrayLike<number>, pins: readonly Pin[]): Puppet {
  if (!puppet.body || shape.length !== puppet.body.rest.length) return { ...puppet, pins };
  const body = { ...puppet.body, rest: Float64Array.from(shape) };
  const settled = pins.map((pin) => {
    const [x, y] = placeOf(pin.hold, body.triangles, body.rest);
    return { ...pin, x, y, angle: 0, scale: 1 };
  });
  return { ...puppet, body, pins: settled };
}

/** All pins where they rest. */
export const atRest = (puppet: Puppet): Puppet => {
  const { body } = puppet;
  if (!body) return puppet;
  const rested = puppet.pins.map((pin) => {
    const [x, y] = restOf(pin, body);
    return { ...pin, x, y, angle: 0, scale: 1 };
  });
  return { ...puppet, pins: rested };
};

/** Paints stiffness around a point of the shape. 1 is as it was; `amount` above 0. */
export function paintStarch(
  body: Body,
  shape: ArrayLike<number>,
  starch: Float32Array | null,
  x: number,
  y: number,
  radius: number,
  amount: number,
): Float32Array | null {
  const count = body.triangles.length / 3;
  let painted: Float32Array | null = null;
  for (let triangle = 0; triangle < count; ++triangle) {
    const [cx, cy] = placeOf({ triangle, weights: [1 / 3, 1 / 3, 1 / 3] }, body.triangles, shape);
    if (Math.hypot(cx - x, cy - y) > radius) continue;
    painted ??= starch ? starch.slice() : new Float32Array(count).fill(1);
    painted[triangle] = amount;
  }
  return painted ?? starch;
}

/** A pin where the shape has this point, or nothing outside of it. */
export function pinAt(
  puppet: Puppet,
  shape: ArrayLike<number>,
  order: ArrayLike<number>,
  x: number,
  y: number,
): Pin | undefined {
  if (!puppet.body) return undefined;
  const hold = holdAt(x, y, puppet.body.triangles, shape, order);
  return hold && newPin(puppet.pins, hold, x, y);
}
