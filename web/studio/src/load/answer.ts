// What GET /v1/load answers (docs/web.md).

/** How long things took since the start; the last count is of what was longer than all bounds. */
export interface Times {
  bounds: number[];
  counts: number[];
  sum: number;
  count: number;
}
type By<T> = Record<string, T>;

export interface GatewayLoad {
  startedAt: number;
  memoryBytes: number;
  cpuSeconds: number;
  requests: By<number>;
  seconds: By<Times>;
  problems: By<number>;
  shapes: number;
  skipped: number;
  resumed: number;
  sockets: number;
  jobs: number;
  connections: number;
}

export interface ServerLoad {
  version: string;
  startedAt: number;
  memoryBytes: number;
  accountedBytes: number;
  cpuSeconds: number;
  sessions: number;
  streams: number;
  connections: number;
  calls: By<number>;
  callSeconds: By<Times>;
  queueSeconds: By<Times>;
  phaseSeconds: By<Times>;
  workers: By<number>;
  waiting: By<number>;
  running: By<number>;
  busySeconds: By<number>;
  oldestSeconds: By<number>;
  rejected: By<number>;
  coalesced: number;
  weaknesses: string[];
}

export interface Load {
  at: number;
  gateway: GatewayLoad;
  server: ServerLoad | null;
  serverProblem: string | null;
}
