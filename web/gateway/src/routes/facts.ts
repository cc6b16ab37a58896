// Facts: what the server is, what problems mean, whether all is well, and metrics.
import { Type } from "@sinclair/typebox";
import type { FastifyInstance, FastifyReply, FastifyRequest } from "fastify";

import type { Context } from "../context.js";
import { calling } from "../context.js";
import { toldNumbers } from "../options.js";
import { Problem, kinds, slugOf } from "../problems.js";
import type { ProblemReason } from "../problems.js";
import { answers, parameters } from "../schemas/base.js";

const Info = Type.Object({
  version: Type.String(),
  limits: Type.Record(Type.String(), Type.Number(), {
    description: "Of arapd; times are in milliseconds.",
  }),
  capabilities: Type.Array(Type.String()),
  workers: Type.Integer(),
  gateway: Type.Record(Type.String(), Type.Number(), { description: "Limits of the gateway." }),
});
const ProblemPage = Type.Object({
  reason: Type.String(),
  status: Type.Integer(),
  title: Type.String(),
});

const reasons = new Map(
  Object.keys(kinds).map((reason) => [slugOf(reason), reason as ProblemReason]),
);
const adminTimeoutMs = 5000;
const mostMetricBytes = 4 << 20;

export function factRoutes(app: FastifyInstance, context: Context): void {
  const { settings, callers, metrics } = context;
  app.get(
    "/v1/info",
    {
      schema: {
        summary: "Version, limits and capabilities",
        tags: ["facts"],
        response: answers({ 200: Info }),
      },
    },
    (request, reply) =>
      calling(context, request, reply, async (client, call) => ({
        ...(await client.getServerInfo(call)),
        gateway: toldNumbers(settings),
      })),
  );

  app.get(
    "/problems/:name",
    {
      schema: {
        summary: "What a problem means",
        tags: ["facts"],
        params: parameters("name"),
        response: answers({ 200: ProblemPage }),
      },
      config: { always: true },
    },
    async (request) => {
      const reason = reasons.get((request.params as { name: string }).name);
      if (!reason) throw new Problem("NO_SUCH_ROUTE", "There is no such problem.");
      return { reason, ...kinds[reason] };
    },
  );

  const hidden = { schema: { hide: true }, config: { always: true } };
  app.get("/healthz", hidden, async () => ({ status: "ok" }));
  app.get("/readyz", hidden, async (_, reply) => {
    if (context.draining()) throw new Problem("GATEWAY_BUSY", "The gateway is going away.");
    // Of nobody in particular: the answer needs no user.
    const lease = context.connections.lease("");
    try {
      await lease.client.getServerInfo({ timeout: 2000, retryWithin: 0 });
    } finally {
      lease.release();
    }
    return reply.send({ status: "ok" });
  });

  const mayRead = (request: FastifyRequest): void => {
    const { metrics: who } = settings;
    if (who === "all" || (who === "local" && callers.isLocal(request.raw))) return;
    throw new Problem("NO_SUCH_ROUTE", "There is nothing at this path.");
  };
  const text = (reply: FastifyReply, body: string, type: string): FastifyReply =>
    reply.header("cache-control", "no-store").type(type).send(body);
  app.get("/metrics", hidden, async (request, reply) => {
    mayRead(request);
    return text(reply, await metrics.registry.metrics(), metrics.registry.contentType);
  });
  app.get("/metrics/arapd", hidden, async (request, reply) => {
    mayRead(request);
    if (settings.arapdAdmin === undefined) {
      throw new Problem("NO_SUCH_ROUTE", "The gateway does not know the admin page of its server.");
    }
    return text(
      reply,
      await readMetrics(settings.arapdAdmin),
      "text/plain; version=0.0.4; charset=utf-8",
    );
  });
}

// The text of arapd's own metrics, at most so much of it.
async function readMetrics(admin: string): Promise<string> {
  const parts: Uint8Array[] = [];
  let length = 0;
  try {
    const response = await fetch(new URL("/metrics", admin), {
      signal: AbortSignal.timeout(adminTimeoutMs),
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
      {
        retryAfterMs: 1000,
      },
    );
  }
  return Buffer.concat(parts).toString("utf8");
}
