// A gateway on a free port in front of a real arapd, for one test.
import assert from "node:assert/strict";
import { createServer } from "node:http";
import type { AddressInfo } from "node:net";

import { Client } from "@arapd/client";
import { createGateway } from "@arapd/gateway";
import type { Gateway, GatewayOptions, ProblemDetails, ProblemReason } from "@arapd/gateway";

import { Server } from "../../../client/test/support/server.js";

/** What a test sees of a gateway. */
export interface Stage {
  server: Server;
  /** The same server without the gateway. */
  client: Client;
  gateway: Gateway;
  /** http://127.0.0.1:PORT */
  url: string;
}

/** Holds a gateway in a server of its own. */
export async function hold<T>(
  options: GatewayOptions,
  use: (url: string, gateway: Gateway) => Promise<T>,
): Promise<T> {
  const gateway = await createGateway({ processMetrics: false, ...options });
  const server = createServer((request, response) => gateway.handle(request, response));
  server.on("upgrade", (request, socket, head) => gateway.upgrade(request, socket, head));
  await new Promise<void>((resolve) => server.listen(0, "127.0.0.1", resolve));
  try {
    return await use(`http://127.0.0.1:${(server.address() as AddressInfo).port}`, gateway);
  } finally {
    await gateway.close();
    server.closeAllConnections();
    await new Promise((resolve) => server.close(resolve));
  }
}

export async function onStage<T>(
  use: (stage: Stage) => Promise<T>,
  options: GatewayOptions = {},
  flags?: readonly string[],
): Promise<T> {
  const server = new Server(flags);
  try {
    await server.start();
    const client = Client.connect(server.address);
    try {
      return await hold({ arapd: server.address, ...options }, (url, gateway) =>
        use({ server, client, gateway, url }),
      );
    } finally {
      client.close();
    }
  } finally {
    await server.stop();
  }
}

// What an answer holds is as loose as JSON.
// eslint-disable-next-line @typescript-eslint/no-explicit-any
export type Json = any;

export interface Asked {
  method?: string;
  /** Sent as JSON, unless it is a form. */
  body?: unknown;
  headers?: Record<string, string>;
  signal?: AbortSignal;
}

export async function ask(
  url: string,
  { method, body, headers, signal }: Asked = {},
): Promise<Response> {
  const isJson = body !== undefined && !(body instanceof FormData) && typeof body !== "string";
  return fetch(url, {
    method: method ?? (body === undefined ? "GET" : "POST"),
    headers: { ...(isJson && { "content-type": "application/json" }), ...headers },
    ...(body !== undefined && {
      body: isJson ? JSON.stringify(body) : (body as FormData | string),
    }),
    ...(signal && { signal }),
  });
}

/** The JSON of an answer with this status. */
export async function json(url: string, asked: Asked = {}, status = 200): Promise<Json> {
  const response = await ask(url, asked);
  const text = await response.text();
  assert.equal(response.status, status, text.slice(0, 1000));
  assert.match(response.headers.get("content-type") ?? "", /^application\/json/);
  return JSON.parse(text);
}

/** The problem that an answer is, which has to have this reason. */
export async function problem(
  url: string,
  asked: Asked,
  reason: ProblemReason,
): Promise<ProblemDetails> {
  const response = await ask(url, asked);
  const text = await response.text();
  assert.match(
    response.headers.get("content-type") ?? "",
    /^application\/problem\+json/,
    text.slice(0, 500),
  );
  const told = JSON.parse(text) as ProblemDetails;
  assert.equal(told.reason, reason, text);
  assert.equal(told.status, response.status);
  assert.equal(told.requestId, response.headers.get("x-request-id"));
  return told;
}

/** A form with a file. */
export function form(name: string, content: string | Uint8Array, request?: object): FormData {
  const made = new FormData();
  made.append("file", new Blob([content]), name);
  if (request) made.append("request", JSON.stringify(request));
  return made;
}
