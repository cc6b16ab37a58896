// Job: one flattening that goes on while somebody watches it or asks about it.
import { randomBytes } from "node:crypto";

import { ArapError, hasEnded } from "@arapd/client";
import type { FlatSurface, FlattenJob, Session } from "@arapd/client";

import type { Caller } from "../caller.js";
import type { Connections } from "../connections.js";
import type { FileWarning } from "../files/surface.js";
import type { Question } from "../layout/question.js";
import { Problem } from "../problems.js";

export interface JobTimes {
  patienceMs: number;
  keepMs: number;
}

type Watcher = (job: Job) => void;
// The job of its session.
const name = "flatten";

/** A job has a session of arapd's to itself, which goes with it. */
export class Job {
  readonly id = randomBytes(16).toString("hex");
  /** What is kept of the request, in bytes. */
  readonly bytes: number;
  state: FlattenJob;
  /** Why it has failed. */
  failure: unknown;
  #ended = false;
  #watchers = new Set<Watcher>();
  #timer: NodeJS.Timeout | undefined;
  readonly #stop = new AbortController();

  constructor(
    readonly caller: Caller,
    readonly question: Question,
    readonly warnings: readonly FileWarning[],
    readonly times: JobTimes,
    readonly connections: Connections,
    readonly forget: (job: Job) => void,
  ) {
    const { vertices, triangles } = question.mesh;
    this.bytes = 8 * vertices.length + 4 * triangles.length;
    this.state = {
      id: this.id,
      state: "waiting",
      phase: "",
      fraction: 0,
      place: 0,
      expectedMs: 0,
      resultBytes: 0,
    };
  }

  /** Rejects when arapd refuses it. Then goes on by itself. */
  async begin(): Promise<void> {
    await this.#inSession(async (session) => {
      const { mesh, options } = this.question;
      await session.submitFlatten(name, mesh, options, { signal: this.#stop.signal });
    }, true);
    this.touch();
    void this.#follow();
  }

  /** Whether nothing more will happen to it. */
  get ended(): boolean {
    return this.#ended;
  }

  /** Somebody asks. */
  touch(): void {
    clearTimeout(this.#timer);
    if (this.#ended || this.#watchers.size > 0) return;
    this.#timer = setTimeout(() => void this.cancel(), this.times.patienceMs).unref();
  }

  /** `watcher` hears of every change, and of the end. The answer ends that. */
  watch(watcher: Watcher): () => void {
    this.#watchers.add(watcher);
    this.touch();
    return () => {
      this.#watchers.delete(watcher);
      this.touch();
    };
  }

  /** JOB_NOT_DONE before it has ended; else the layout, or why there is none. */
  async result(signal: AbortSignal): Promise<FlatSurface> {
    this.touch();
    if (!this.#ended) throw new Problem("JOB_NOT_DONE", `The job is ${this.state.state}.`);
    if (this.failure !== undefined) throw this.failure;
    const { mesh, options } = this.question;
    return this.#inSession((session) => session.getResult(name, mesh, options, { signal }));
  }

  /** Ends it, wherever it is. Harmless when it has ended. */
  async cancel(): Promise<void> {
    if (this.#ended) return;
    this.#stop.abort();
    this.#end(
      "cancelled",
      new Problem("CANCELLED", "The job was cancelled, or nobody asked about it any more."),
    );
    await this.#inSession((session) => session.cancelJob(name)).catch(() => {});
    await this.release();
  }

  /** Arapd forgets it. */
  async release(): Promise<void> {
    clearTimeout(this.#timer);
    await this.#inSession((session) => session.delete({ retryWithin: 0 })).catch(() => {});
  }

  async #inSession<T>(use: (session: Session) => Promise<T>, create = false): Promise<T> {
    const lease = this.connections.lease(this.caller.owner);
    try {
      // Lives as long as the job is kept, and longer than it is worked on unwatched.
      const ttl = this.times.keepMs + this.times.patienceMs + 600_000;
      const id = `gateway-job-${this.id}`;
      return await use(
        create ? await lease.client.createSession({ id, ttl }) : lease.client.attachSession(id),
      );
    } finally {
      lease.release();
    }
  }

  async #follow(): Promise<void> {
    try {
      const last = await this.#inSession((session) =>
        session.watchJob(
          name,
          (state) => {
            if (!this.#ended && !hasEnded(state)) this.#tell(state);
          },
          { signal: this.#stop.signal },
        ),
      );
      if (this.#ended) return;
      this.state = { ...last, id: this.id };
      const problem = last.state === "done" ? undefined : await this.#whyNone();
      this.#end(last.state, problem);
    } catch (error) {
      if (!this.#ended) this.#end("failed", error);
    }
  }

  async #whyNone(): Promise<unknown> {
    const { mesh, options } = this.question;
    try {
      await this.#inSession((session) => session.getResult(name, mesh, options));
    } catch (error) {
      if (error instanceof ArapError) return error;
    }
    return new Problem("INTERNAL", "The job ended without a result.");
  }

  #tell(state: FlattenJob): void {
    this.state = { ...state, id: this.id };
    for (const watcher of [...this.#watchers]) watcher(this);
  }

  #end(state: FlattenJob["state"], failure: unknown): void {
    this.#ended = true;
    this.failure = failure;
    this.#tell({ ...this.state, state });
    this.#watchers.clear();
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => {
      this.forget(this);
      void this.release();
    }, this.times.keepMs).unref();
  }
}
