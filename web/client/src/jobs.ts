// Flattenings as jobs: each answer is checked as it comes, and one that comes in pieces is gone on
// with where it was lost.
import { makeCall, pieces, quickLimit } from "./calls.js";
import type { Attempt, CallOptions, Manner } from "./calls.js";
import type { Channel } from "./channel.js";
import type { Names } from "./checks.js";
import { checkId, checkNumbers, present } from "./checks.js";
import { badAnswer } from "./errors.js";
import type { JobAnswer } from "./gen/arap/v1/Job.js";
import type { JobStateAnswer } from "./gen/arap/v1/JobState.js";
import { flattening, milliseconds } from "./wire.js";
import type { Method } from "./wire.js";

export type JobState = Names<JobStateAnswer, "JOB_STATE_">;

/** How a job stands. */
export interface FlattenJob {
  id: string;
  /** getResult says why one has failed. */
  state: JobState;
  /** While it runs: "cutting", "charts", "layout", "drawing" or "storing". */
  phase: string;
  /** Of the work, 0 to 1; falls only when a server that was started anew begins the job again. */
  fraction: number;
  /** How many jobs start before it, while it waits. */
  place: number;
  /** Until it ends, in milliseconds; 0 when it has ended. */
  expectedMs: number;
  /** When it is done. */
  resultBytes: number;
}

/** Whether nothing more will happen to it. */
export const hasEnded = (job: FlattenJob): boolean =>
  job.state !== "waiting" && job.state !== "running";

/** The job of that name. */
export function jobOf(answer: JobAnswer | null, id: string): FlattenJob {
  const job = present(answer, "the job");
  checkId(job.jobId, id, "job");
  const state = job.state.replace(/^JOB_STATE_/, "").toLowerCase();
  if (!/^(waiting|running|done|failed|cancelled)$/.test(state)) {
    throw badAnswer("The server answered a job in no state that is known.");
  }
  checkNumbers([job.fraction], "a job");
  if (job.fraction < 0 || job.fraction > 1) {
    throw badAnswer(`The server answered that ${job.fraction} of a job is done.`);
  }
  return {
    id: job.jobId,
    state: state as JobState,
    phase: job.phase,
    fraction: job.fraction,
    place: job.place,
    expectedMs: milliseconds(job.expectedEnd),
    resultBytes: job.resultBytes,
  };
}

const inPieces: Manner = { repeat: "harmless", limit: Infinity };
const late = (): string => `The server has told nothing of the job for ${quickLimit / 1000} s.`;

// Reads an answer in pieces to its end, from `request()` anew where a call was lost.
async function read<Request, Answer>(
  channel: Channel,
  method: Method<Request, Answer>,
  request: () => Request,
  options: CallOptions,
  sessionId: string,
  take: (answer: Answer) => void,
): Promise<void> {
  let heard = false;
  const attempt = async (call: Attempt): Promise<void> => {
    heard = false;
    for await (const answer of pieces(channel, method, request(), call, quickLimit, late)) {
      heard = true;
      take(answer);
    }
  };
  await makeCall(channel, inPieces, options, sessionId, attempt, () => heard);
}

/**
 * Until the job has ended; `onChange` hears of it at once, when something has changed and every
 * second or so.
 */
export async function watch(
  channel: Channel,
  sessionId: string,
  jobId: string,
  options: CallOptions,
  onChange?: (job: FlattenJob) => void,
): Promise<FlattenJob> {
  let last: FlattenJob | undefined;
  const take = (answer: { job: JobAnswer | null }): void => {
    last = jobOf(answer.job, jobId);
    onChange?.(last);
  };
  await read(channel, flattening.WatchJob, () => ({ sessionId, jobId }), options, sessionId, take);
  if (last && hasEnded(last)) return last;
  throw badAnswer("The server stopped telling of a job that has not ended.");
}

/** The bytes of the result of a job that is done. */
export async function download(
  channel: Channel,
  sessionId: string,
  jobId: string,
  options: CallOptions,
): Promise<Buffer> {
  const parts: Buffer[] = [];
  let length = 0;
  let total: number | undefined;
  const take = (piece: { data: Buffer; offset: number; totalBytes: number }): void => {
    const fits =
      piece.offset === length &&
      piece.totalBytes === (total ?? piece.totalBytes) &&
      piece.data.length <= piece.totalBytes - length;
    if (!fits) throw badAnswer("The server answered a result whose pieces do not fit.");
    total = piece.totalBytes;
    parts.push(piece.data);
    length += piece.data.length;
  };
  const request = (): object => ({ sessionId, jobId, offset: length });
  await read(channel, flattening.DownloadResult, request, options, sessionId, take);
  if (length !== total)
    throw badAnswer(`The server answered ${length} bytes of a result of ${total ?? 0}.`);
  return Buffer.concat(parts, length);
}
