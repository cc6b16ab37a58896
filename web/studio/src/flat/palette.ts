// Colours of what is marked, which have to be seen on every strain, in both views.
export const mark = {
  seam: "#b0126b",
  cut: "#6b4ea8",
  flip: "#1f7a1f",
  hover: "#0b57d0",
  chosen: "#8f3d00",
  from: "#8f3d00",
  grain: "#1c2530",
  paper: "rgb(255 255 255 / 80%)",
} as const;

/** Those that follow the page's colours. */
export interface Palette {
  ink: string;
  veil: string;
}

export function paletteOf(element: Element): Palette {
  const style = getComputedStyle(element);
  return { ink: style.getPropertyValue("--ink"), veil: style.getPropertyValue("--veil") };
}
