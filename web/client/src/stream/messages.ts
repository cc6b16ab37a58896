// Updates and edits on their way, and how several updates become few.
import type { HandleEdit as WireEdit } from "../gen/arap/v1/HandleEdit.js";
import type { HandleTarget as WireTarget } from "../gen/arap/v1/HandleTarget.js";

/** An update as it goes out. */
export interface Update {
  sequence: number;
  targets: WireTarget[];
  /** Doubles as bytes; empty when there are targets. */
  positions: Uint8Array;
  pickPoints: Uint8Array;
  /** The shape, in any case. */
  measure: boolean;
}
export interface Edit extends WireEdit {
  sequence: number;
}
/** What has an answer. */
export type Message = { update: Update } | { edit: Edit };

export const isEdit = (message: Message): message is { edit: Edit } => "edit" in message;
export const sequenceOf = (message: Message): number =>
  (isEdit(message) ? message.edit : message.update).sequence;

/**
 * Targets that several updates have come to: single ones, then all positions at once, which leave
 * angles and scales as they are, then single ones again. Each with the last sequence that it has
 * something from.
 */
export class Pose {
  #before = new Map<string, WireTarget>();
  #positions: Uint8Array = new Uint8Array(0);
  #after = new Map<string, WireTarget>();
  #sequences = { before: 0, positions: 0, after: 0 };

  add(update: Update): void {
    if (update.positions.length > 0) {
      if (this.#after.size > 0) this.#sequences.before = this.#sequences.after;
      for (const [id, target] of this.#after) this.#before.set(id, target);
      this.#after = new Map();
      this.#positions = update.positions;
      this.#sequences.positions = update.sequence;
    }
    if (update.targets.length > 0) this.#sequences.after = update.sequence;
    for (const target of update.targets) this.#after.set(target.handleId ?? "", target);
  }

  /** At most three updates, in order, with growing sequences. */
  say(out: Message[]): void {
    const none = new Uint8Array(0);
    const say = (
      sequence: number,
      targets: Map<string, WireTarget>,
      positions: Uint8Array,
    ): void => {
      if (targets.size === 0 && positions.length === 0) return;
      out.push({
        update: {
          sequence,
          targets: [...targets.values()],
          positions,
          pickPoints: none,
          measure: false,
        },
      });
    };
    say(this.#sequences.before, this.#before, none);
    say(this.#sequences.positions, new Map(), this.#positions);
    say(this.#sequences.after, this.#after, none);
  }
}

/**
 * Fewer messages that a "latest" stream answers alike. The last update before an edit, and the
 * newest of all, are answered in any case: they stay as they were sent, and so does what `mayMerge`
 * says no to. What answers in the place of one that asks to be measured is measured.
 */
export function fold(
  messages: readonly Message[],
  mayMerge: (update: Update) => boolean = () => true,
): Message[] {
  const folded: Message[] = [];
  let pose = new Pose();
  let measure = false;
  messages.forEach((message, i) => {
    const next = messages[i + 1];
    if (!isEdit(message) && next && !isEdit(next) && mayMerge(message.update)) {
      pose.add(message.update);
      measure ||= message.update.measure;
      return;
    }
    pose.say(folded);
    pose = new Pose();
    folded.push(measure && !isEdit(message) ? { update: { ...message.update, measure } } : message);
    measure = false;
  });
  return folded;
}
