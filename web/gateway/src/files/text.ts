// Texts of meshes, line by line and word by word.
import { FileFault, harmless } from "./surface.js";

/** A word of the file in a sentence, cut off where it is long. */
export const quoted = (word: string): string =>
  `'${harmless(word.slice(0, 40))}${word.length > 40 ? "…" : ""}'`;

/** A decimal number, which has to be finite. */
export function numberOf(word: string, line: number): number {
  const value = /^[-+]?[\d.][\d.eE+-]*$/.test(word) ? Number(word) : NaN;
  if (Number.isFinite(value)) return value;
  const comma = /^[-+]?\d+,\d+$/.test(word) ? " (decimal comma?)" : "";
  throw new FileFault(`line ${line}: ${quoted(word)} is not a finite number${comma}.`);
}

/** A whole number, perhaps negative. */
export function wholeOf(word: string, line: number): number {
  if (/^[-+]?\d{1,15}$/.test(word)) return Number(word);
  throw new FileFault(`line ${line}: ${quoted(word)} is not a whole number.`);
}

/** The lines of a text, whatever ends them. */
export class Lines {
  readonly #text: string;
  #at = 0;
  /** Of the line of the moment, from 1. */
  number = 0;
  line = "";

  /** FileFault for what is no text. */
  constructor(bytes: Buffer) {
    if (bytes.subarray(0, 4096).includes(0)) {
      throw new FileFault("The file is neither a text nor of a binary form that is read.");
    }
    const text = bytes.toString("utf8").replace(/^\ufeff/, "");
    this.#text = text.includes("\r") ? text.replace(/\r\n?/g, "\n") : text;
  }

  next(): boolean {
    if (this.#at > this.#text.length) return false;
    const end = this.#text.indexOf("\n", this.#at);
    const stop = end < 0 ? this.#text.length : end;
    this.line = this.#text.slice(this.#at, stop);
    this.#at = stop + 1;
    this.number++;
    return true;
  }
}

/** The words of a line. */
export function wordsOf(line: string): string[] {
  const trimmed = line.trim();
  return trimmed === "" ? [] : trimmed.split(/[ \t\v\f]+/);
}
