// MergeRule: which updates may become one with newer ones before they are sent, and which did.
import type { HandleSetInfo } from "../handles.js";
import { float64Run } from "../runs.js";
import type { Edit, Update } from "./messages.js";

/**
 * An update that is surely a good one: of handles that the stream surely has, to places that are
 * numbers. Others go out as they are, so that the server's error tells of them alone.
 */
export class MergeRule {
  #ids = new Set<string>();
  #edits: Edit[] = []; // without answer
  // Updates that became one with newer ones, by the last of these, until its shape tells of them.
  #merged: { count: number; sequence: number }[] = [];

  /** The stream has opened, or opened again, with these. */
  restart(set: HandleSetInfo): void {
    this.#ids = new Set(set.handles.map((handle) => handle.id));
    this.#edits = [];
  }
  sent(edit: Edit): void {
    this.#edits.push(edit);
  }
  /** The answer to `sequence` came; not good: an error. */
  answered(sequence: number, good: boolean): void {
    while (this.#edits.length > 0 && this.#edits[0]!.sequence <= sequence) {
      const edit = this.#edits.shift()!;
      if (!good && edit.sequence === sequence) continue;
      for (const id of edit.remove ?? []) this.#ids.delete(id);
      for (const handle of edit.add ?? []) this.#ids.add(handle.handleId ?? "");
    }
  }

  readonly allows = (update: Update): boolean => {
    if (this.#edits.length > 0) return false;
    const whole = update.positions.length === 16 * this.#ids.size;
    const none = update.positions.length === 0;
    if (!none && (!whole || update.targets.length > 0)) return false;
    if (!float64Run(update.positions).every(Number.isFinite)) return false;
    return update.targets.every(
      ({ handleId, x, y, angleRadians, scale }) =>
        this.#ids.has(handleId ?? "") &&
        [x, y, angleRadians ?? 0, scale ?? 1].every(Number.isFinite),
    );
  };

  /** `count` updates became one with that of this sequence. */
  merged(count: number, sequence: number): void {
    // Without answers for long the newest stands for those before it.
    const before = this.#merged.length >= 64 ? this.#merged.pop()!.count : 0;
    this.#merged.push({ count: count + before, sequence });
  }
  /** How many did up to this sequence, each told once. */
  takeMerged(sequence: number): number {
    let count = 0;
    while (this.#merged.length > 0 && this.#merged[0]!.sequence <= sequence) {
      count += this.#merged.shift()!.count;
    }
    return count;
  }
}
