// Sockets: upgrades of /v1/sessions/{session}/stream, and all that are open.
import { STATUS_CODES } from "node:http";
import type { IncomingMessage } from "node:http";
import type { Duplex } from "node:stream";

import { WebSocketServer } from "ws";

import type { Context } from "../context.js";
import { Problem, detailsOf, foreseen, unforeseen } from "../problems.js";
import { Counts } from "../rate.js";
import type { Rates } from "../rate.js";
import { toJson } from "../json.js";
import { requestIdOf } from "../request_id.js";
import { LiveSocket } from "./live.js";

export const subprotocol = "arapd.v1";

export class Sockets {
  readonly #context: Context;
  readonly #rates: Rates;
  readonly #log: (error: unknown, requestId: string) => void;
  readonly #server: WebSocketServer;
  readonly #path: RegExp;
  readonly #open = new Set<LiveSocket>();
  readonly #counts = new Counts();
  readonly #waiting: (() => void)[] = [];

  constructor(context: Context, rates: Rates, log: (error: unknown, requestId: string) => void) {
    this.#context = context;
    this.#rates = rates;
    this.#log = log;
    const { prefix, maxMessageBytes } = context.settings;
    this.#path = new RegExp(`^${prefix.replaceAll(".", "\\.")}/v1/sessions/([^/]+)/stream$`);
    this.#server = new WebSocketServer({
      noServer: true,
      maxPayload: maxMessageBytes,
      perMessageDeflate: false,
      clientTracking: false,
      handleProtocols: (offered) => (offered.has(subprotocol) ? subprotocol : false),
    });
  }

  get count(): number {
    return this.#open.size;
  }

  /** Takes a socket over, or answers with a problem. Never throws. */
  async upgrade(request: IncomingMessage, socket: Duplex, head: Buffer): Promise<void> {
    const requestId = requestIdOf(request.headers["x-request-id"]);
    const cut = (): void => void socket.destroy();
    socket.on("error", cut);
    try {
      const [path = ""] = (request.url ?? "").split("?");
      const session = this.#path.exec(path)?.[1];
      if (session === undefined)
        throw new Problem("NO_SUCH_ROUTE", "There is no socket at this path.");
      this.#context.callers.checkOrigin(request);
      const caller = await this.#context.callers.of(request);
      this.#admit(caller.key);
      const { traceparent } = request.headers;
      this.#server.handleUpgrade(request, socket, head, (ws) => {
        socket.off("error", cut);
        const live = new LiveSocket(this.#context, ws, {
          session: decoded(session),
          caller,
          requestId,
          traceparent: typeof traceparent === "string" ? traceparent : undefined,
          log: (error) => this.#log(error, requestId),
        });
        this.#open.add(live);
        this.#counts.add(caller.key);
        this.#context.metrics.sockets.set(this.#open.size);
        ws.once("close", () => {
          this.#open.delete(live);
          this.#counts.remove(caller.key);
          this.#context.metrics.sockets.set(this.#open.size);
          if (this.#open.size === 0) for (const done of this.#waiting.splice(0)) done();
        });
      });
    } catch (error) {
      this.#refuse(error, socket, requestId);
    }
  }

  #admit(key: string): void {
    const { maxSockets, maxSocketsPerUser } = this.#context.settings;
    if (this.#context.draining())
      throw new Problem("GATEWAY_BUSY", "The gateway is going away.", { retryAfterMs: 1000 });
    const wait = this.#rates.take(key);
    if (wait > 0)
      throw new Problem("RATE_LIMITED", "Too many requests came at once.", { retryAfterMs: wait });
    if (this.#open.size >= maxSockets) {
      throw new Problem(
        "GATEWAY_BUSY",
        `The gateway has ${maxSockets} sockets, as many as it may.`,
        { retryAfterMs: 5000 },
      );
    }
    if (this.#counts.of(key) >= maxSocketsPerUser) {
      throw new Problem(
        "RATE_LIMITED",
        `One user has at most ${maxSocketsPerUser} sockets at once.`,
        { retryAfterMs: 5000 },
      );
    }
  }

  #refuse(error: unknown, socket: Duplex, requestId: string): void {
    const known = foreseen(error);
    if (!known) this.#log(error, requestId);
    const problem = known ?? unforeseen();
    this.#context.metrics.problems.inc({ reason: problem.reason });
    const body = toJson(detailsOf(problem, this.#context.settings.prefix, requestId));
    const retry = problem.facts.retryAfterMs;
    const lines = [
      `HTTP/1.1 ${problem.status} ${STATUS_CODES[problem.status] ?? ""}`,
      "Connection: close",
      "Content-Type: application/problem+json; charset=utf-8",
      `Content-Length: ${Buffer.byteLength(body)}`,
      `X-Request-Id: ${requestId}`,
      ...(retry === undefined ? [] : [`Retry-After: ${Math.ceil(retry / 1000)}`]),
    ];
    socket.end(`${lines.join("\r\n")}\r\n\r\n${body}`);
  }

  /** Tells all that the gateway is going away. */
  drain(): void {
    for (const live of this.#open) live.drain();
  }

  /** Waits until none is open. */
  async ended(): Promise<void> {
    if (this.#open.size > 0) await new Promise<void>((done) => this.#waiting.push(done));
  }

  /** Closes all, and cuts those that do not answer to that. */
  close(): void {
    for (const live of this.#open) live.close(1001);
    const cut = setTimeout(() => {
      for (const live of this.#open) live.terminate();
    }, 1000);
    cut.unref();
  }
}

// What is no id after all is refused by arapd.
function decoded(text: string): string {
  try {
    return decodeURIComponent(text);
  } catch {
    return text;
  }
}
