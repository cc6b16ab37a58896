// What a gateway may be told. Flags, environment, options and GET /v1/info come from these tables.
import type { IncomingMessage } from "node:http";

import type { FastifyBaseLogger } from "fastify";

interface NumberRule {
  default: number;
  most: number;
  least?: number;
  /** What it is of, for the help text. */
  about: string;
}

/** Limits, by their names in options; `GET /v1/info` tells those in force. */
export const numberRules = {
  maxBodyBytes: { default: 32 << 20, most: 256 << 20, least: 1024, about: "bytes of a JSON body" },
  maxFileBytes: { default: 64 << 20, most: 256 << 20, about: "bytes of an uploaded file" },
  maxFileVertices: { default: 1_000_000, most: 20_000_000, about: "vertices of a file" },
  maxFileTriangles: { default: 2_000_000, most: 40_000_000, about: "triangles of a file" },
  maxBytesUnderWay: { default: 512 << 20, most: 2 ** 40, about: "bytes of all bodies at once" },
  maxMessageBytes: { default: 1 << 20, most: 64 << 20, about: "bytes of a text on a socket" },
  maxRequestsPerMinute: { default: 600, most: 1e9, about: "requests of one user or address" },
  maxMessagesPerSecond: { default: 500, most: 1e9, about: "texts on a socket" },
  maxSockets: { default: 1000, most: 1e6, about: "open sockets" },
  maxSocketsPerUser: { default: 32, most: 1e6, about: "open sockets of one user or address" },
  maxJobs: { default: 200, most: 1e5, about: "jobs under way or kept" },
  maxJobsPerUser: { default: 8, most: 1e5, about: "the same of one user or address" },
  maxJobBytes: { default: 256 << 20, most: 2 ** 40, about: "memory of the requests of all jobs" },
  maxConnections: { default: 200, most: 1e5, about: "connections to arapd" },
  maxConcurrentUploads: { default: 2, most: 64, about: "files that are read at once" },
  jobPatienceMs: {
    default: 10_000,
    most: 3.6e6,
    about: "until a job nobody asks for is cancelled",
  },
  jobKeepMs: { default: 600_000, most: 8.64e7, about: "that a job is kept after its end" },
  resumeWithinMs: {
    default: 60_000,
    most: 3.6e6,
    least: 0,
    about: "that a lost arapd is waited for",
  },
  openWithinMs: { default: 10_000, most: 3.6e6, about: "that a socket may take to say open" },
  socketPingMs: { default: 20_000, most: 3.6e6, about: "between pings of a socket" },
  drainSeconds: { default: 10, most: 3600, least: 0, about: "for what is under way after SIGTERM" },
} satisfies Record<string, NumberRule>;

export type Numbers = { readonly [Name in keyof typeof numberRules]: number };

/** How a gateway runs. Every number of the table may be given too. */
export interface GatewayOptions extends Partial<Numbers> {
  /** host:port or unix:PATH. Default "localhost:50051". */
  arapd?: string | undefined;
  /** The admin page of arapd, "http://127.0.0.1:9464": for /v1/load and /metrics/arapd. */
  arapdAdmin?: string | undefined;
  /** The gateway's bearer token. */
  token?: string | undefined;
  /** Files in PEM, or their texts, for TLS to arapd. */
  tlsCa?: string | undefined;
  tlsCert?: string | undefined;
  tlsKey?: string | undefined;
  /** The path that all routes are under: "/arapd". Default: none. */
  prefix?: string | undefined;
  /**
   * Who is asking; undefined refuses with UNKNOWN_USER. Needs a token of the role gateway. Default:
   * users are not told apart.
   */
  user?:
    | ((request: IncomingMessage) => string | undefined | Promise<string | undefined>)
    | undefined;
  /** Other origins whose pages may ask: "https://shop.example". */
  origins?: readonly string[] | undefined;
  /** Addresses, or ranges, of proxies whose X-Forwarded headers are believed. */
  trustProxy?: readonly string[] | undefined;
  /** A folder with pages to serve at "/". */
  static?: string | undefined;
  /** Who may read /metrics and /v1/load. Default "local": who connects from this machine, not through a proxy. */
  metrics?: "local" | "all" | "none" | undefined;
  /** Also metrics of the Node process. Default true. */
  processMetrics?: boolean | undefined;
  /** Default: nothing is logged. */
  logger?: FastifyBaseLogger | undefined;
}

/** Options that have been checked, with their defaults. */
export type Settings = Omit<GatewayOptions, keyof Numbers> &
  Numbers & {
    arapd: string;
    prefix: string;
    origins: readonly string[];
    trustProxy: readonly string[];
    metrics: "local" | "all" | "none";
  };

/** RangeError, with a sentence, for an option that is wrong. */
export function settingsOf(options: GatewayOptions): Settings {
  const numbers: Record<string, number> = {};
  for (const [name, rule] of Object.entries<NumberRule>(numberRules)) {
    const value = options[name as keyof Numbers] ?? rule.default;
    const least = rule.least ?? 1;
    if (!Number.isInteger(value) || value < least || value > rule.most) {
      throw new RangeError(
        `${name} is ${value}; it has to be a whole number, ${least} to ${rule.most}.`,
      );
    }
    numbers[name] = value;
  }
  const { prefix = "", origins = [], metrics = "local" } = options;
  if (!/^(\/[A-Za-z0-9._~-]+)*$/.test(prefix)) {
    throw new RangeError(`prefix is ${JSON.stringify(prefix)}; it has to be like "/arapd".`);
  }
  for (const origin of origins) {
    if (!URL.canParse(origin) || new URL(origin).origin !== origin) {
      throw new RangeError(`${JSON.stringify(origin)} is no origin, like "https://shop.example".`);
    }
  }
  if (options.arapdAdmin !== undefined && !URL.canParse(options.arapdAdmin)) {
    throw new RangeError(`arapdAdmin is ${JSON.stringify(options.arapdAdmin)}, which is no URL.`);
  }
  if (!["local", "all", "none"].includes(metrics)) {
    throw new RangeError(
      `metrics is ${JSON.stringify(metrics)}, which is none of local, all, none.`,
    );
  }
  return {
    ...options,
    ...(numbers as Numbers),
    arapd: options.arapd ?? "localhost:50051",
    prefix,
    origins,
    trustProxy: options.trustProxy ?? [],
    metrics,
  };
}

/** The numbers that pages have to know. */
export const toldNumbers = (settings: Settings): Numbers =>
  Object.fromEntries(
    Object.keys(numberRules).map((name) => [name, settings[name as keyof Numbers]]),
  ) as Numbers;
