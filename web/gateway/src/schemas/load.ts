// How busy the gateway and its server are.
import { Type } from "@sinclair/typebox";
import type { Static, TSchema } from "@sinclair/typebox";

const by = <T extends TSchema>(of: T, what: string) =>
  Type.Record(Type.String(), of, { description: what });
const count = (what: string) => Type.Number({ description: what });
const Times = Type.Object(
  {
    bounds: Type.Array(Type.Number(), { description: "Upper bounds in seconds, ascending." }),
    counts: Type.Array(Type.Number(), {
      description: "How many lay below each bound and not below the one before; then the rest.",
    }),
    sum: Type.Number({ description: "In seconds." }),
    count: Type.Number(),
  },
  { description: "How long things took since the start." },
);

const GatewayLoad = Type.Object({
  startedAt: count("Milliseconds since 1970."),
  memoryBytes: count("Resident."),
  cpuSeconds: count("Processor time since the start."),
  requests: by(Type.Number(), "Requests by their status, since the start."),
  seconds: by(Times, "Requests by their route."),
  problems: by(Type.Number(), "Problems by their reason, those of streams too, since the start."),
  shapes: count("Shapes sent on sockets, since the start."),
  skipped: count("Shapes that newer ones replaced, since the start."),
  resumed: count("Streams that were lost and went on, since the start."),
  sockets: count("Open now."),
  jobs: count("Under way or kept now."),
  connections: count("To arapd now."),
});

const ServerLoad = Type.Object({
  version: Type.String(),
  startedAt: count("Milliseconds since 1970."),
  memoryBytes: count("Resident."),
  accountedBytes: count("What counts towards max_bytes."),
  cpuSeconds: count("Processor time since the start."),
  sessions: count("In memory now."),
  streams: count("Open streams and running tracks now."),
  connections: count("Open now."),
  calls: by(Type.Number(), "Calls that have ended, by their code, since the start."),
  callSeconds: by(Times, "Calls by their method."),
  queueSeconds: by(Times, "How long jobs waited for a worker, by lane."),
  phaseSeconds: by(Times, "How long the work took without waiting, by phase."),
  workers: by(Type.Number(), "Threads by lane."),
  waiting: by(Type.Number(), "Jobs that wait now, by lane."),
  running: by(Type.Number(), "Jobs that run now, by lane."),
  busySeconds: by(Type.Number(), "Time of all threads on jobs by lane, since the start."),
  oldestSeconds: by(Type.Number(), "How long the longest running job runs, by lane."),
  rejected: by(Type.Number(), "Calls that a quota refused, by quota, since the start."),
  coalesced: count("Updates that newer ones replaced, since the start."),
  weaknesses: Type.Array(Type.String(), { description: "What is wrong with the store now." }),
});

export const LoadAnswer = Type.Object({
  at: count("When it was read, in milliseconds since 1970, on a clock that never goes back."),
  gateway: GatewayLoad,
  server: Type.Union([ServerLoad, Type.Null()], {
    description: "Null while its admin page does not answer.",
  }),
  serverProblem: Type.Union([Type.String(), Type.Null()], {
    description: "Why there is no server, in a sentence.",
  }),
});
export type LoadAnswer = Static<typeof LoadAnswer>;
