// Metrics of the gateway, for Prometheus. No label names a user or a session.
import { Counter, Gauge, Histogram, Registry, collectDefaultMetrics } from "prom-client";

const buckets = [0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1, 2.5, 5, 10, 30, 60];

export class GatewayMetrics {
  readonly registry = new Registry();
  readonly requests = new Counter({
    name: "arapd_gateway_requests_total",
    help: "Requests by route, method and status.",
    labelNames: ["route", "method", "status"],
    registers: [this.registry],
  });
  readonly seconds = new Histogram({
    name: "arapd_gateway_request_seconds",
    help: "How long requests took, by route.",
    labelNames: ["route"],
    buckets,
    registers: [this.registry],
  });
  readonly problems = new Counter({
    name: "arapd_gateway_problems_total",
    help: "Problems by reason, those of streams too.",
    labelNames: ["reason"],
    registers: [this.registry],
  });
  readonly sockets = new Gauge({
    name: "arapd_gateway_sockets",
    help: "Open sockets.",
    registers: [this.registry],
  });
  readonly shapes = new Counter({
    name: "arapd_gateway_shapes_total",
    help: "Shapes sent on sockets.",
    registers: [this.registry],
  });
  readonly skipped = new Counter({
    name: "arapd_gateway_shapes_skipped_total",
    help: "Shapes that newer ones replaced before a socket took them.",
    registers: [this.registry],
  });
  readonly resumed = new Counter({
    name: "arapd_gateway_resumed_total",
    help: "Streams that were lost and went on.",
    registers: [this.registry],
  });

  constructor(ofProcess: boolean) {
    if (ofProcess) collectDefaultMetrics({ register: this.registry });
  }

  /** A number that is asked for when somebody reads. */
  watch(name: string, help: string, read: () => number): void {
    new Gauge({
      name: `arapd_gateway_${name}`,
      help,
      registers: [this.registry],
      collect() {
        this.set(read());
      },
    });
  }
}
