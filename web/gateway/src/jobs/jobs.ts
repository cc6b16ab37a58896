// Jobs that are under way or kept, each of the user who submitted it.
import type { Caller } from "../caller.js";
import type { Connections } from "../connections.js";
import type { FileWarning } from "../files/surface.js";
import type { Question } from "../layout/question.js";
import { Problem } from "../problems.js";
import type { Settings } from "../options.js";
import { Counts } from "../rate.js";
import { Job } from "./job.js";

export class Jobs {
  readonly #settings: Settings;
  readonly #connections: Connections;
  readonly #jobs = new Map<string, Job>();
  readonly #counts = new Counts();
  #bytes = 0;

  constructor(settings: Settings, connections: Connections) {
    this.#settings = settings;
    this.#connections = connections;
  }

  get count(): number {
    return this.#jobs.size;
  }

  /** RATE_LIMITED: there are as many as there may be; and whatever arapd refuses. */
  async submit(caller: Caller, question: Question, warnings: readonly FileWarning[]): Promise<Job> {
    const { jobPatienceMs, jobKeepMs } = this.#settings;
    // The arrays of the request are larger than these copies, and are let go.
    const mesh = {
      vertices: Float64Array.from(question.mesh.vertices),
      triangles: Uint32Array.from(question.mesh.triangles),
    };
    const times = { patienceMs: jobPatienceMs, keepMs: jobKeepMs };
    const job = new Job(caller, { ...question, mesh }, warnings, times, this.#connections, (one) =>
      this.#forget(one),
    );
    this.#checkRoom(caller, job.bytes);
    this.#jobs.set(job.id, job);
    this.#counts.add(caller.key);
    this.#bytes += job.bytes;
    try {
      await job.begin();
    } catch (error) {
      this.#forget(job);
      void job.release();
      throw error;
    }
    return job;
  }

  /** NOT_FOUND: there is none, or it is somebody else's. Without users whoever knows the id has it. */
  get(caller: Caller, id: string): Job {
    const job = this.#jobs.get(id);
    if (job?.caller.owner !== caller.owner) {
      throw new Problem("NOT_FOUND", "There is no such job, or it is forgotten.");
    }
    return job;
  }

  async cancel(job: Job): Promise<void> {
    await job.cancel();
    this.#forget(job);
    await job.release();
  }

  /** Cancels what is under way, and forgets all. */
  async close(): Promise<void> {
    await Promise.all([...this.#jobs.values()].map((job) => this.cancel(job)));
  }

  #checkRoom(caller: Caller, bytes: number): void {
    const { maxJobs, maxJobsPerUser, maxJobBytes } = this.#settings;
    // Those that have ended make room, the oldest first.
    const own = this.#counts.of(caller.key) >= maxJobsPerUser;
    const isFull = (): boolean => this.#jobs.size >= maxJobs || this.#bytes + bytes > maxJobBytes;
    for (const job of this.#jobs.values()) {
      const helps =
        isFull() ||
        (own && job.caller.key === caller.key && this.#counts.of(caller.key) >= maxJobsPerUser);
      if (!helps || !job.ended) continue;
      this.#forget(job);
      void job.release();
    }
    if (isFull())
      throw new Problem("RATE_LIMITED", "The gateway has as many jobs as it may.", {
        retryAfterMs: 5000,
      });
    if (this.#counts.of(caller.key) >= maxJobsPerUser) {
      throw new Problem("RATE_LIMITED", `One user has at most ${maxJobsPerUser} jobs at once.`, {
        retryAfterMs: 5000,
      });
    }
  }

  #forget(job: Job): void {
    if (!this.#jobs.delete(job.id)) return;
    this.#counts.remove(job.caller.key);
    this.#bytes -= job.bytes;
  }
}
