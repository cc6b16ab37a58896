// Load: how busy the gateway and its server are, from the metrics of both.
import { performance } from "node:perf_hooks";

import type { GatewayMetrics } from "../metrics.js";
import { Problem } from "../problems.js";
import type { LoadAnswer } from "../schemas/load.js";
import { Metrics } from "./prometheus.js";

const adminTimeoutMs = 5000;
const mostMetricBytes = 4 << 20;
// So long an answer is the same for all: however many watch, the server is asked no oftener.
const sameMs = 500;

/** The text of arapd's own metrics, at most so much of it. DRAINING when nobody answers. */
export async function readMetrics(admin: string): Promise<string> {
  const parts: Uint8Array[] = [];
  let length = 0;
  try {
    const response = await fetch(new URL("/metrics", admin), {
      signal: AbortSignal.timeout(adminTimeoutMs),
      redirect: "error",
    });
    if (!response.ok || !response.body) throw new Error(`status ${response.status}`);
    for await (const part of response.body as unknown as AsyncIterable<Uint8Array>) {
      length += part.length;
      if (length > mostMetricBytes) throw new Error("the text is too long");
      parts.push(part);
    }
  } catch (error) {
    throw new Problem(
      "DRAINING",
      `The server's admin page does not answer: ${(error as Error).message}.`,
      { retryAfterMs: 1000 },
    );
  }
  return Buffer.concat(parts).toString("utf8");
}

export class Load {
  #last: { until: number; answer: Promise<LoadAnswer> } | undefined;

  constructor(
    readonly metrics: GatewayMetrics,
    readonly admin: string,
  ) {}

  /** Without a server where its admin page does not answer. */
  read(): Promise<LoadAnswer> {
    const now = performance.now();
    if (!this.#last || this.#last.until < now) {
      this.#last = { until: now + sameMs, answer: this.#read() };
    }
    return this.#last.answer;
  }

  async #read(): Promise<LoadAnswer> {
    let server: LoadAnswer["server"] = null;
    let serverProblem: string | null = null;
    try {
      server = serverOf(new Metrics(await readMetrics(this.admin)));
    } catch (error) {
      if (!(error instanceof Problem)) throw error;
      serverProblem = error.message;
    }
    return {
      at: performance.timeOrigin + performance.now(),
      gateway: gatewayOf(new Metrics(await this.metrics.registry.metrics())),
      server,
      serverProblem,
    };
  }
}

const name = (rest: string): string => `arapd_gateway_${rest}`;
const isOwn = ({ route }: Readonly<Record<string, string>>): boolean =>
  route?.endsWith("/v1/load") === true;

function gatewayOf(metrics: Metrics): LoadAnswer["gateway"] {
  const { user, system } = process.cpuUsage();
  // Who only watches is no load.
  const watching = metrics.all(name("requests_total")).filter(({ labels }) => isOwn(labels));
  const requests = metrics.by(name("requests_total"), "status");
  for (const { labels, value } of watching) requests[labels["status"] ?? ""]! -= value;
  const seconds = metrics.times(name("request_seconds"), "route");
  return {
    startedAt: performance.timeOrigin,
    memoryBytes: process.memoryUsage.rss(),
    cpuSeconds: (user + system) / 1e6,
    requests,
    seconds: Object.fromEntries(Object.entries(seconds).filter(([route]) => !isOwn({ route }))),
    problems: metrics.by(name("problems_total"), "reason"),
    shapes: metrics.total(name("shapes_total")),
    skipped: metrics.total(name("shapes_skipped_total")),
    resumed: metrics.total(name("resumed_total")),
    sockets: metrics.total(name("sockets")),
    jobs: metrics.total(name("jobs")),
    connections: metrics.total(name("connections")),
  };
}

function serverOf(metrics: Metrics): LoadAnswer["server"] {
  const lanes = (name: string): Record<string, number> => metrics.by(name, "lane");
  const weak = metrics.all("arapd_store_weakness").filter(({ value }) => value > 0);
  return {
    version: metrics.all("arapd_build_info")[0]?.labels["version"] ?? "",
    startedAt: 1000 * metrics.total("process_start_time_seconds"),
    memoryBytes: metrics.total("process_resident_memory_bytes"),
    accountedBytes: metrics.total("arapd_accounted_bytes"),
    cpuSeconds: metrics.total("process_cpu_seconds_total"),
    sessions: metrics.total("arapd_sessions"),
    streams: metrics.total("arapd_open_streams"),
    connections: metrics.total("arapd_connections"),
    calls: metrics.by("arapd_rpcs_total", "code"),
    callSeconds: metrics.times("arapd_rpc_seconds", "method"),
    queueSeconds: metrics.times("arapd_queue_seconds", "lane"),
    phaseSeconds: metrics.times("arapd_phase_seconds", "phase"),
    workers: lanes("arapd_workers"),
    waiting: lanes("arapd_queue_length"),
    running: lanes("arapd_jobs_running"),
    busySeconds: lanes("arapd_busy_seconds_total"),
    oldestSeconds: lanes("arapd_oldest_job_seconds"),
    rejected: metrics.by("arapd_rejected_total", "quota"),
    coalesced: metrics.total("arapd_coalesced_frames_total"),
    weaknesses: weak.map(({ labels }) => labels["reason"] ?? ""),
  };
}
