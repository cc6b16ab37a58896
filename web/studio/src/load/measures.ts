// What the load page shows: numbers that two answers, one after the other, make.
import type { GatewayLoad, Load, ServerLoad, Times } from "./answer.js";

export type Unit = "rate" | "ms" | "count" | "bytes" | "part" | "cores";

/** A line of a chart. `words.load.lines` has its name. */
export interface Measure {
  key: string;
  /** Undefined where nothing can be said. */
  value(pair: Pair): number | undefined;
}
export interface Chart {
  key: string;
  unit: Unit;
  lines: Measure[];
}

/** Two answers of the same gateway, and of the same server where there is one. */
export class Pair {
  readonly gateway: [before: GatewayLoad, now: GatewayLoad] | undefined;
  readonly server: [before: ServerLoad, now: ServerLoad] | undefined;
  readonly seconds: number;

  constructor(
    before: Load | undefined,
    readonly now: Load,
  ) {
    this.seconds = before ? (now.at - before.at) / 1000 : 0;
    // What was started anew has begun to count anew.
    if (!before || this.seconds <= 0) return;
    if (before.gateway.startedAt === now.gateway.startedAt) {
      this.gateway = [before.gateway, now.gateway];
    }
    if (before.server && now.server && before.server.startedAt === now.server.startedAt) {
      this.server = [before.server, now.server];
    }
  }

  /** How much something of the gateway has grown in a second. */
  ofGateway(read: (load: GatewayLoad) => number): number | undefined {
    return this.gateway && (read(this.gateway[1]) - read(this.gateway[0])) / this.seconds;
  }
  ofServer(read: (load: ServerLoad) => number): number | undefined {
    return this.server && (read(this.server[1]) - read(this.server[0])) / this.seconds;
  }
}

export const sum = (of: Record<string, number>, counts = (_key: string): boolean => true): number =>
  Object.entries(of).reduce((total, [key, value]) => total + (counts(key) ? value : 0), 0);

const none: Times = { bounds: [], counts: [], sum: 0, count: 0 };

/** All of them together; they have the same bounds. */
function together(all: Record<string, Times>): Times {
  const [first, ...rest] = Object.values(all);
  if (!first) return none;
  return rest.reduce(
    (total, { counts, sum, count }) => ({
      bounds: total.bounds,
      counts: total.counts.map((value, i) => value + (counts[i] ?? 0)),
      sum: total.sum + sum,
      count: total.count + count,
    }),
    first,
  );
}

/**
 * The time in ms that this part of what came between the two took at most, as finely as the bounds
 * are; undefined when nothing came. Longer than all bounds is the last bound.
 */
export function quantile(before: Times, now: Times, part: number): number | undefined {
  const counts = now.counts.map((count, i) => count - (before.counts[i] ?? 0));
  const all = counts.reduce((total, count) => total + count, 0);
  if (all <= 0) return undefined;
  let left = part * all;
  for (const [i, count] of counts.entries()) {
    if (count > 0 && left <= count) {
      const low = now.bounds[i - 1] ?? 0;
      const high = now.bounds[i] ?? low;
      return 1000 * (low + ((high - low) * left) / count);
    }
    left -= count;
  }
  return 1000 * (now.bounds.at(-1) ?? 0);
}

const quantiles = (read: (pair: Pair) => [before: Times, now: Times] | undefined): Measure[] =>
  (
    [
      ["median", 0.5],
      ["p99", 0.99],
    ] as const
  ).map(([key, part]) => ({
    key,
    value: (pair) => {
      const times = read(pair);
      return times && quantile(...times, part);
    },
  }));
const ofServer =
  (read: (load: ServerLoad) => Times | undefined) =>
  ({ server }: Pair): [Times, Times] | undefined =>
    server && [read(server[0]) ?? none, read(server[1]) ?? none];

const lanes = ["interactive", "control", "jobs"] as const;
const byLane = (value: (pair: Pair, lane: string) => number | undefined): Measure[] =>
  lanes.map((lane) => ({ key: lane, value: (pair) => value(pair, lane) }));
const status =
  (from: number, below: number) =>
  ({ requests }: GatewayLoad): number =>
    sum(requests, (code) => Number(code) >= from && Number(code) < below);

/** In the order of the page. */
export const charts: readonly Chart[] = [
  {
    key: "shapes",
    unit: "rate",
    lines: [
      {
        key: "computed",
        value: (pair) => pair.ofServer((s) => s.phaseSeconds["frame"]?.count ?? 0),
      },
      { key: "sent", value: (pair) => pair.ofGateway((g) => g.shapes) },
      {
        key: "replaced",
        value: (pair) => {
          const skipped = pair.ofGateway((g) => g.skipped);
          return skipped === undefined
            ? undefined
            : skipped + (pair.ofServer((s) => s.coalesced) ?? 0);
        },
      },
    ],
  },
  {
    key: "shapeTime",
    unit: "ms",
    lines: quantiles(ofServer((load) => load.phaseSeconds["frame"])),
  },
  {
    key: "queueTime",
    unit: "ms",
    lines: quantiles(ofServer((load) => load.queueSeconds["interactive"])),
  },
  {
    key: "waiting",
    unit: "count",
    lines: byLane(({ now }, lane) => now.server?.waiting[lane]),
  },
  {
    key: "busy",
    unit: "part",
    lines: byLane((pair, lane) => {
      const threads = pair.now.server?.workers[lane] ?? 0;
      const busy = pair.ofServer((load) => load.busySeconds[lane] ?? 0);
      return busy === undefined || threads === 0 ? undefined : Math.min(1, busy / threads);
    }),
  },
  {
    key: "open",
    unit: "count",
    lines: [
      { key: "sessions", value: ({ now }) => now.server?.sessions },
      { key: "streams", value: ({ now }) => now.server?.streams },
      { key: "sockets", value: ({ now }) => now.gateway.sockets },
    ],
  },
  {
    key: "requests",
    unit: "rate",
    lines: [
      { key: "answered", value: (pair) => pair.ofGateway(status(100, 400)) },
      { key: "refused", value: (pair) => pair.ofGateway(status(400, 500)) },
      { key: "failed", value: (pair) => pair.ofGateway(status(500, 600)) },
    ],
  },
  {
    key: "requestTime",
    unit: "ms",
    lines: quantiles(
      ({ gateway }) => gateway && [together(gateway[0].seconds), together(gateway[1].seconds)],
    ),
  },
  {
    key: "memory",
    unit: "bytes",
    lines: [
      { key: "server", value: ({ now }) => now.server?.memoryBytes },
      { key: "accounted", value: ({ now }) => now.server?.accountedBytes },
      { key: "gateway", value: ({ now }) => now.gateway.memoryBytes },
    ],
  },
  {
    key: "processor",
    unit: "cores",
    lines: [
      { key: "server", value: (pair) => pair.ofServer((load) => load.cpuSeconds) },
      { key: "gateway", value: (pair) => pair.ofGateway((load) => load.cpuSeconds) },
    ],
  },
];
