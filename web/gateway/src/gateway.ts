// createGateway: the gateway as something that any HTTP server of Node's can hold. Inside it is a
// Fastify application of its own, so that its hooks, parsers and limits are those of its own routes.
import type { IncomingMessage, ServerResponse } from "node:http";
import { resolve } from "node:path";
import type { Duplex } from "node:stream";

import multipart from "@fastify/multipart";
import fastifyStatic from "@fastify/static";
import Fastify, { LogController } from "fastify";
import type { FastifyError, FastifyInstance, FastifyReply, FastifyRequest } from "fastify";

import { Callers } from "./caller.js";
import { Connections } from "./connections.js";
import type { Context } from "./context.js";
import { FileReader } from "./files/read.js";
import { addHeaders } from "./headers.js";
import { Jobs } from "./jobs/jobs.js";
import { toJson } from "./json.js";
import { GatewayMetrics } from "./metrics.js";
import { addOpenApi } from "./openapi.js";
import { settingsOf } from "./options.js";
import type { GatewayOptions, Settings } from "./options.js";
import { Problem, detailsOf, foreseen, unforeseen } from "./problems.js";
import { Rates } from "./rate.js";
import { requestIdOf } from "./request_id.js";
import { factRoutes } from "./routes/facts.js";
import { flattenRoutes } from "./routes/flatten.js";
import { sessionRoutes } from "./routes/sessions.js";
import { trackRoutes } from "./routes/tracks.js";
import { Sockets } from "./stream/sockets.js";
import { check } from "./validate.js";

/** What holds a gateway passes on to it. */
export interface Gateway {
  /** Whether a request is for a path of the gateway. */
  owns(request: IncomingMessage): boolean;
  handle(request: IncomingMessage, response: ServerResponse): void;
  upgrade(request: IncomingMessage, socket: Duplex, head: Buffer): void;
  /** Takes no new work, and closes when what is under way has ended or so many seconds are over. */
  drain(seconds?: number): Promise<void>;
  /** Ends everything now. */
  close(): Promise<void>;
  /** The OpenAPI document. */
  openapi(): object;
}

// What has been begun and not ended, of HTTP.
class Requests {
  readonly #open = new Set<ServerResponse>();
  readonly #waiting: (() => void)[] = [];

  add(response: ServerResponse): void {
    this.#open.add(response);
    response.once("close", () => {
      this.#open.delete(response);
      if (this.#open.size === 0) for (const done of this.#waiting.splice(0)) done();
    });
  }
  async ended(): Promise<void> {
    if (this.#open.size > 0) await new Promise<void>((done) => this.#waiting.push(done));
  }
  cut(): void {
    for (const response of this.#open) response.destroy();
  }
}

// What bodies under way may take in memory together.
class Bodies {
  #bytes = 0;
  constructor(readonly settings: Settings) {}

  /** GATEWAY_BUSY where there is no room. A body that does not say its length counts as the largest. */
  admit(request: FastifyRequest, reply: FastifyReply): void {
    const { "content-length": length, "transfer-encoding": coding } = request.headers;
    const { maxBytesUnderWay, maxBodyBytes } = this.settings;
    const bytes = coding !== undefined ? maxBodyBytes : Number(length ?? 0) || 0;
    if (bytes > 0 && this.#bytes + bytes > maxBytesUnderWay) {
      throw new Problem("GATEWAY_BUSY", "The gateway has no room for more bodies now.", {
        retryAfterMs: 1000,
      });
    }
    if (reply.raw.closed) return;
    this.#bytes += bytes;
    reply.raw.once("close", () => (this.#bytes -= bytes));
  }
}

function logOf(request: FastifyRequest, reply: FastifyReply, milliseconds: number): void {
  // The route, not the path: whoever knows the id of a session has the session.
  const route = request.routeOptions.url ?? "none";
  request.log.info(
    {
      method: request.method,
      route,
      status: reply.statusCode,
      ms: Math.round(milliseconds * 1000) / 1000,
    },
    "request",
  );
}

function addHooks(app: FastifyInstance, context: Context, rates: Rates): void {
  const { settings, callers, metrics } = context;
  const bodies = new Bodies(settings);
  const isApi = (request: FastifyRequest): boolean =>
    request.routeOptions.url?.startsWith(`${settings.prefix}/v1/`) === true;
  app.addHook("onRequest", async (request, reply) => {
    void reply.header("x-request-id", request.id);
    const isPage = !isApi(request) && request.routeOptions.config.always !== true;
    addHeaders(reply, isPage);
    if (request.method !== "GET" && request.method !== "HEAD") callers.checkOrigin(request.raw);
    if (!isApi(request)) return;
    const { ofNobody } = request.routeOptions.config;
    request.caller = ofNobody ? callers.nobody(request.raw) : await callers.of(request.raw);
    const wait = rates.take(request.caller.key);
    if (wait > 0)
      throw new Problem("RATE_LIMITED", "Too many requests came at once.", { retryAfterMs: wait });
    if (context.draining() && request.routeOptions.config.always !== true) {
      throw new Problem("GATEWAY_BUSY", "The gateway is going away.", { retryAfterMs: 1000 });
    }
    bodies.admit(request, reply);
  });
  app.addHook("onResponse", async (request, reply) => {
    const route = request.routeOptions.url ?? "none";
    const { elapsedTime } = reply;
    metrics.requests.inc({ route, method: request.method, status: String(reply.statusCode) });
    metrics.seconds.observe({ route }, elapsedTime / 1000);
    logOf(request, reply, elapsedTime);
  });
  app.setNotFoundHandler(() => {
    throw new Problem("NO_SUCH_ROUTE", "There is nothing at this path for this method.");
  });
  app.setErrorHandler((error: FastifyError, request, reply) =>
    tell(context, error, request, reply),
  );
}

function tell(
  context: Context,
  error: Error,
  request: FastifyRequest,
  reply: FastifyReply,
): FastifyReply {
  const known = foreseen(error, request.routeOptions.config?.fields);
  if (!known) request.log.error({ err: error }, "unforeseen");
  const problem = known ?? unforeseen();
  context.metrics.problems.inc({ reason: problem.reason });
  const { retryAfterMs } = problem.facts;
  if (retryAfterMs !== undefined)
    void reply.header("retry-after", String(Math.ceil(retryAfterMs / 1000)));
  void reply.removeHeader("content-disposition");
  return reply
    .code(problem.status)
    .header("cache-control", "no-store")
    .type("application/problem+json")
    .send(toJson(detailsOf(problem, context.settings.prefix, request.id)));
}

async function appOf(settings: Settings, context: Context, rates: Rates): Promise<FastifyInstance> {
  const app = Fastify({
    ...(settings.logger ? { loggerInstance: settings.logger } : { logger: false }),
    logController: new LogController({ disableRequestLogging: true }),
    genReqId: (raw) => requestIdOf(raw.headers["x-request-id"]),
    bodyLimit: settings.maxBodyBytes,
    exposeHeadRoutes: false,
    routerOptions: { maxParamLength: 200 },
    // Paths that are none come here before any hook.
    frameworkErrors: (error, request, reply) => {
      void reply.header("x-request-id", request.id);
      addHeaders(reply, false);
      tell(context, error, request as FastifyRequest, reply as FastifyReply);
    },
  }) as unknown as FastifyInstance;
  app.removeContentTypeParser("text/plain");
  app.decorateRequest("caller");
  app.setValidatorCompiler(({ schema, httpPart }) => (value: unknown) => {
    try {
      check(schema as object, value, httpPart === "body" ? "The body" : `The ${httpPart}`);
      return { value };
    } catch (error) {
      return { error: error as Error };
    }
  });
  app.setSerializerCompiler(() => toJson);
  app.setReplySerializer((payload) => toJson(payload));
  await app.register(multipart, {
    limits: {
      files: 1,
      fields: 1,
      parts: 4,
      fileSize: settings.maxFileBytes,
      fieldSize: settings.maxBodyBytes,
    },
  });
  addHooks(app, context, rates);
  await addOpenApi(app, settings.prefix);
  await app.register(
    async (scope) => {
      factRoutes(scope, context);
      flattenRoutes(scope, context);
      sessionRoutes(scope, context);
      trackRoutes(scope, context);
    },
    { prefix: settings.prefix },
  );
  if (settings.static !== undefined) {
    await app.register(fastifyStatic, {
      root: resolve(settings.static),
      prefix: `${settings.prefix}/`,
      decorateReply: false,
    });
  }
  await app.ready();
  return app;
}

/**
 * RangeError, with a sentence, for an option that is wrong; ArapError for what cannot go with
 * arapd's address. Connects in the background, when somebody asks.
 */
export async function createGateway(options: GatewayOptions = {}): Promise<Gateway> {
  const settings = settingsOf(options);
  const metrics = new GatewayMetrics(settings.processMetrics ?? true);
  const connections = new Connections(settings);
  const jobs = new Jobs(settings, connections);
  let draining = false;
  const context: Context = {
    settings,
    callers: new Callers(settings),
    connections,
    files: new FileReader(settings),
    jobs,
    metrics,
    draining: () => draining,
  };
  const rates = new Rates(settings.maxRequestsPerMinute / 60, settings.maxRequestsPerMinute);
  const app = await appOf(settings, context, rates);
  const sockets = new Sockets(context, rates, (error, reqId) =>
    app.log.error({ err: error, reqId }, "unforeseen"),
  );
  metrics.watch("jobs", "Jobs that are under way or kept.", () => jobs.count);
  metrics.watch("connections", "Connections to arapd.", () => connections.count);
  const requests = new Requests();

  let closing: Promise<void> | undefined;
  const close = async (): Promise<void> => {
    draining = true;
    sockets.close();
    await jobs.close();
    requests.cut();
    connections.close();
    await app.close();
  };
  const drain = async (seconds = settings.drainSeconds): Promise<void> => {
    draining = true;
    sockets.drain();
    let timer: NodeJS.Timeout | undefined;
    const late = new Promise<void>((done) => (timer = setTimeout(done, seconds * 1000)));
    await Promise.race([late, Promise.all([requests.ended(), sockets.ended()])]);
    clearTimeout(timer);
  };
  return {
    owns: ({ url = "" }) => {
      const { prefix } = settings;
      return url === prefix || url.startsWith(`${prefix}/`) || url.startsWith(`${prefix}?`);
    },
    handle: (request, response) => {
      requests.add(response);
      app.routing(request, response);
    },
    upgrade: (request, socket, head) => void sockets.upgrade(request, socket, head),
    drain: async (seconds) => {
      await drain(seconds);
      await (closing ??= close());
    },
    close: () => (closing ??= close()),
    openapi: () => app.swagger(),
  };
}
