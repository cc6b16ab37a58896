// A take as the files of `arapctl bake`: the mesh as OBJ, and TRACK.json.
import type { Body, Pin } from "../model/puppet.js";
import { restOf } from "../model/puppet.js";
import { perPin } from "../model/take.js";
import type { Take } from "../model/take.js";

/** The mesh at rest, with its places on the picture. Numbers are written so that they are read back exactly. */
export function objOf(body: Body, width: number, height: number): string {
  const lines: string[] = [];
  for (let i = 0; i < body.rest.length; i += 2) {
    lines.push(`v ${body.rest[i]} ${body.rest[i + 1]} 0`);
  }
  for (let i = 0; i < body.picture.length; i += 2) {
    lines.push(`vt ${body.picture[i] / width} ${body.picture[i + 1] / height}`);
  }
  for (let i = 0; i < body.triangles.length; i += 3) {
    const corners = [...body.triangles.subarray(i, i + 3)].map((vertex) => vertex + 1);
    lines.push(`f ${corners.map((corner) => `${corner}/${corner}`).join(" ")}`);
  }
  return lines.join("\n") + "\n";
}

const holdsAngle = (pin: Pin): boolean => pin.turns || pin.area > 0;

/** TRACK.json of the frames as they are played. */
export function trackOf(take: Take, frames: readonly Float64Array[], mesh: string): string {
  const handles = take.pins.map((pin) => ({
    name: pin.id,
    rest: restOf(pin, take.body),
    triangle: pin.hold.triangle,
    bary: pin.hold.weights,
    ...(pin.firmness === "soft" && { weight: pin.weight }),
    ...(pin.firmness === "exact" && { hard: true }),
    ...(pin.turns && { oriented: true }),
    ...(pin.area > 0 && { area_radius: pin.area }),
    ...(pin.depth !== 0 && { depth: pin.depth }),
  }));
  const turned = take.pins.some(holdsAngle);
  const track = {
    mesh,
    handles,
    frames: frames.map((frame) => ({
      kind: "take",
      targets: take.pins.map((_, i) => [frame[perPin * i], frame[perPin * i + 1]]),
      ...(turned && {
        angles: take.pins.map((pin, i) => (holdsAngle(pin) ? frame[perPin * i + 2] : 0)),
        scales: take.pins.map((pin, i) => (holdsAngle(pin) ? frame[perPin * i + 3] : 1)),
      }),
    })),
    ...(take.starch && { rigidity: [...take.starch] }),
  };
  return JSON.stringify(track) + "\n";
}

/** What computes the same shapes. */
export function commandOf(take: Take, name: string): string {
  const { basis, weights, mode, refine } = take.motion;
  return [
    `arapctl bake ${name}.obj ${name}.track.json --out ${name}.csv --spawn`,
    basis !== "edge" && `--basis ${basis.replaceAll("_", "-")}`,
    weights !== "uniform" && `--weights ${weights}`,
    mode !== "rigid" && `--mode ${mode}`,
    refine > 0 && `--refine ${refine}`,
  ]
    .filter(Boolean)
    .join(" ");
}
