// Strain as a colour, the same as in the server's drawings: blue compressed, white unchanged, red stretched.

/** Of the two principal strains the one that is farther from 0, in percent. */
export const strainOf = (s1: number, s2: number): number =>
  100 * (Math.abs(s1 - 1) >= Math.abs(s2 - 1) ? s1 - 1 : s2 - 1);

const leastRange = 0.1;

/** 1, 2 or 5 times a power of ten that all but one in fifty strains stay under. */
export function rangeOf(strains: readonly Float64Array[]): number {
  const sizes: number[] = [];
  for (const one of strains) for (const strain of one) sizes.push(Math.abs(strain));
  const sorted = Float64Array.from(sizes).sort();
  const wanted = Math.max(leastRange, sorted[Math.floor((sorted.length * 49) / 50)] ?? 0);
  const power = 10 ** Math.floor(Math.log10(wanted) + 1e-9);
  return ([1, 2, 5].find((step) => step * power >= wanted * (1 - 1e-9)) ?? 10) * power;
}

/** On each side of white. */
export const shades = 24;
const [blue, white, red] = [
  [33, 102, 172],
  [250, 250, 250],
  [178, 24, 43],
];

export const shadeOf = (strain: number, range: number): number =>
  Math.round(shades * Math.min(1, Math.max(-1, Number.isFinite(strain) ? strain / range : 1)));

/** Red, green and blue, 0 to 255. */
export function colourOf(shade: number): [number, number, number] {
  const end = shade < 0 ? blue : red;
  const t = Math.sqrt(Math.abs(shade) / shades);
  return [0, 1, 2].map((i) => Math.round(white[i] + t * (end[i] - white[i]))) as [
    number,
    number,
    number,
  ];
}

/** As the pieces have it that are not the chosen one. */
export const paleOf = (colour: readonly number[]): [number, number, number] =>
  colour.map((value) => Math.round(0.35 * value + 0.65 * 150)) as [number, number, number];

export const cssOf = (colour: readonly number[]): string => `rgb(${colour.join(" ")})`;

/** The colours from one end to the other, for a legend. */
export function gradient(): string {
  const stops = Array.from({ length: 2 * shades + 1 }, (_, i) => cssOf(colourOf(i - shades)));
  return `linear-gradient(to right, ${stops.join(", ")})`;
}
