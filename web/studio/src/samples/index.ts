// The puppets that the page brings along, drawn for it.
import { words } from "../words.js";
import { ginger } from "./ginger.js";
import { pot } from "./pot.js";
import { reef } from "./reef.js";

export interface Sample {
  name: string;
  hint: string;
  /** An address of its drawing. */
  source: string;
  /** Where pins do well: x y, from the upper left corner. */
  pins: readonly (readonly [number, number])[];
}

const drawings = [ginger, pot, reef];
const places: readonly (readonly (readonly [number, number])[])[] = [
  [
    [320, 110],
    [86, 222],
    [554, 222],
    [320, 400],
    [186, 640],
    [454, 640],
  ],
  [
    [370, 88],
    [62, 280],
    [700, 142],
    [250, 556],
    [490, 556],
  ],
  [
    [228, 110],
    [112, 516],
    [264, 570],
    [398, 516],
    [462, 175],
    [750, 170],
    [612, 376],
    [518, 625],
    [672, 628],
    [738, 468],
  ],
];

export const samples: readonly Sample[] = drawings.map((drawing, i) => ({
  name: words.puppet.samples[i],
  hint: words.puppet.sampleHints[i],
  source: `data:image/svg+xml;charset=utf-8,${encodeURIComponent(drawing)}`,
  pins: places[i],
}));
