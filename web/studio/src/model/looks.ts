// How the page looks at the document, and with which tool.

/** What is no part of the document: nothing of it is undone. */
export interface Looks {
  tool: "pins" | "starch";
  chosen: string | null;
  wire: boolean;
  flips: boolean;
  onion: boolean;
  follow: "drag" | "release";
  brush: { radius: number; amount: number };
}

export const defaultLooks: Looks = {
  tool: "pins",
  chosen: null,
  wire: false,
  flips: true,
  onion: false,
  follow: "drag",
  brush: { radius: 40, amount: 20 },
};
