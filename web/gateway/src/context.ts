// What all routes share.
import type { FastifyReply, FastifyRequest } from "fastify";

import type { CallOptions, Client } from "@arapd/client";

import type { Caller, Callers } from "./caller.js";
import type { Connections } from "./connections.js";
import type { FileReader } from "./files/read.js";
import type { Jobs } from "./jobs/jobs.js";
import type { GatewayMetrics } from "./metrics.js";
import { Problem } from "./problems.js";
import type { Settings } from "./options.js";

declare module "fastify" {
  interface FastifyRequest {
    /** Set before any handler of /v1 runs. */
    caller: Caller;
  }
  interface FastifyContextConfig {
    /** What fields of arapd's faults are called in the JSON of a route, where that is special. */
    fields?: Readonly<Record<string, string>>;
    /** Whether it goes on when the gateway drains. */
    always?: boolean;
    /** Whether it is asked without a user also where users are told apart. */
    ofNobody?: boolean;
  }
}

export interface Context {
  settings: Settings;
  callers: Callers;
  connections: Connections;
  files: FileReader;
  jobs: Jobs;
  metrics: GatewayMetrics;
  draining: () => boolean;
}

const signals = new WeakMap<FastifyReply, AbortSignal>();

/** Aborted when the caller hangs up before the answer is sent; the same for all of a request. */
export function leaving(reply: FastifyReply): AbortSignal {
  const known = signals.get(reply);
  if (known) return known;
  const controller = new AbortController();
  const left = (): void => controller.abort(new Problem("CANCELLED", "The caller has left."));
  if (reply.raw.closed || reply.raw.destroyed) left();
  else {
    reply.raw.once("close", () => {
      if (!reply.raw.writableFinished) left();
    });
  }
  signals.set(reply, controller.signal);
  return controller.signal;
}

/** How calls to arapd are made for a request: cancelled with it, and named as it is. */
export function callOf(request: FastifyRequest, signal: AbortSignal): CallOptions {
  const { traceparent } = request.headers;
  return {
    signal,
    requestId: request.id,
    ...(typeof traceparent === "string" && { traceparent }),
  };
}

/** Calls arapd as the user of a request. */
export async function calling<T>(
  { connections }: Context,
  request: FastifyRequest,
  reply: FastifyReply,
  use: (client: Client, call: CallOptions) => Promise<T>,
): Promise<T> {
  const lease = connections.lease(request.caller.owner);
  try {
    return await use(lease.client, callOf(request, leaving(reply)));
  } finally {
    lease.release();
  }
}
