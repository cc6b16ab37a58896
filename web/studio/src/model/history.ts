// Undo and redo of a document that is never changed but replaced.

interface Step<T> {
  document: T;
  /** What was done to it next. */
  label: string;
}

/** Steps that belong together, a drag say, have the same key and are one. */
export class History<T> {
  #past: Step<T>[] = [];
  #future: Step<T>[] = [];
  #present: T;
  #key = "";
  readonly #most: number;

  constructor(document: T, most = 300) {
    this.#present = document;
    this.#most = most;
  }

  get present(): T {
    return this.#present;
  }
  /** What undo would take back, or nothing. */
  get undoable(): string | undefined {
    return this.#past.at(-1)?.label;
  }
  get redoable(): string | undefined {
    return this.#future.at(-1)?.label;
  }

  do(document: T, label: string, key = ""): void {
    if (document === this.#present) return;
    const merges = key !== "" && key === this.#key && this.#past.length > 0;
    if (!merges) this.#past.push({ document: this.#present, label });
    if (this.#past.length > this.#most) this.#past.shift();
    this.#present = document;
    this.#future = [];
    this.#key = key;
  }

  /** The next step is one of its own, whatever its key. */
  seal(): void {
    this.#key = "";
  }

  /** Replaces the present as though it had always been so: nothing to undo. */
  amend(document: T): void {
    this.#present = document;
  }

  /** Gives what it has taken back, or nothing. */
  undo(): string | undefined {
    const step = this.#past.pop();
    if (!step) return undefined;
    this.#future.push({ document: this.#present, label: step.label });
    this.#present = step.document;
    this.#key = "";
    return step.label;
  }

  redo(): string | undefined {
    const step = this.#future.pop();
    if (!step) return undefined;
    this.#past.push({ document: this.#present, label: step.label });
    this.#present = step.document;
    this.#key = "";
    return step.label;
  }
}
