// Facts: what the server is, what problems mean, whether all is well, and metrics.
import { Type } from "@sinclair/typebox";
import type { FastifyInstance, FastifyReply, FastifyRequest } from "fastify";

import type { Context } from "../context.js";
import { calling } from "../context.js";
import { Load, readMetrics } from "../load/load.js";
import { toldNumbers } from "../options.js";
import { Problem, kinds, slugOf } from "../problems.js";
import type { ProblemReason } from "../problems.js";
import { answers, parameters } from "../schemas/base.js";
import { LoadAnswer } from "../schemas/load.js";

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

  const mayRead = async (request: FastifyRequest): Promise<void> => {
    const { metrics: who } = settings;
    if (who === "all" || (who === "local" && callers.isOwn(request.raw))) return;
    throw new Problem("NO_SUCH_ROUTE", "There is nothing at this path.");
  };
  const adminOf = (): string => {
    if (settings.arapdAdmin !== undefined) return settings.arapdAdmin;
    throw new Problem("NO_SUCH_ROUTE", "The gateway does not know the admin page of its server.");
  };
  const text = (reply: FastifyReply, body: string, type: string): FastifyReply =>
    reply.header("cache-control", "no-store").type(type).send(body);
  const forOperators = { ...hidden, preHandler: mayRead };
  app.get("/metrics", forOperators, async (_, reply) =>
    text(reply, await metrics.registry.metrics(), metrics.registry.contentType),
  );
  app.get("/metrics/arapd", forOperators, async (_, reply) =>
    text(reply, await readMetrics(adminOf()), "text/plain; version=0.0.4; charset=utf-8"),
  );

  let load: Load | undefined;
  app.get(
    "/v1/load",
    {
      schema: {
        summary: "How busy the gateway and its server are, for operators",
        tags: ["facts"],
        response: answers({ 200: LoadAnswer }),
      },
      config: { always: true, ofNobody: true },
      preHandler: mayRead,
    },
    async (_, reply) => {
      void reply.header("cache-control", "no-store");
      load ??= new Load(metrics, adminOf());
      return load.read();
    },
  );
}
