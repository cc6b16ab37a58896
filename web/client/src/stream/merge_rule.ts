// MergeRule: which updates may become one with newer ones before they are sent.
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
}
