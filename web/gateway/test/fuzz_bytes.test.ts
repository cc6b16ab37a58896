// Bodies that are no JSON of anybody, for every route of the OpenAPI document: nothing but problems
// comes of them, soon, and the gateway goes on. The same seed makes the same bodies.
import assert from "node:assert/strict";
import { connect } from "node:net";
import { test } from "node:test";

import { Dice, files, seed } from "./support/dice.js";
import { hold, json, onStage } from "./support/gateway.js";
import type { Json } from "./support/gateway.js";
import { puppet } from "./support/puppet.js";

const rounds = Number(process.env["ARAP_WEB_ROUNDS"] ?? 3);
const timeout = 240_000 + rounds * 60_000;
/** Every answer has to come within this, on a busy machine too. */
const soonMs = 30_000;

interface Route {
  method: string;
  path: string;
  hasBody: boolean;
}

/** All routes, with names in their paths that are there, or not. */
function routesOf(document: Json, session: string, dice: Dice): Route[] {
  const names: Record<string, string[]> = {
    session: [session],
    mesh: ["m", "none"],
    handleSet: ["h", "none"],
    job: ["none"],
    name: ["malformed", "none"],
  };
  return Object.entries(document.paths as Record<string, Record<string, Json>>).flatMap(
    ([path, methods]) =>
      Object.keys(methods).map((method) => ({
        method: method.toUpperCase(),
        path: path.replace(/\{(\w+)\}/g, (_, name: string) => dice.of(names[name]!)),
        hasBody: ["post", "patch", "put"].includes(method),
      })),
  );
}

const repeated = (text: string, count: number): string => text.repeat(count);
/** Texts and bytes that JSON parsers have stumbled over. */
const bodies: readonly (string | Uint8Array)[] = [
  "",
  " ",
  "\ufeff{}",
  "{",
  '{"a":1}{',
  repeated("[", 100_000),
  repeated("[", 100_000) + repeated("]", 100_000),
  repeated('{"mesh":', 20_000) + "1" + repeated("}", 20_000),
  '{"__proto__":{"isAdmin":true}}',
  '{"constructor":{"prototype":{"x":1}}}',
  '{"mesh":1,"mesh":{"vertices":[],"triangles":[]}}',
  '{"mesh":{"vertices":[1e999,-1e999,0],"triangles":[0,0,0]}}',
  `{"mesh":{"vertices":[${repeated("9", 5000)}],"triangles":[]}}`,
  '{"frames":[{"positions":[NaN]}]}',
  '{"id":"\\ud800"}',
  `{"id":"${repeated("a", 100_000)}"}`,
  `{${Array.from({ length: 20_000 }, (_, i) => `"k${i}":0`).join()}}`,
  `{"outlines":[${repeated("[],", 20_000)}[]]}`,
  `{"handles":[${repeated('{"id":"a","vertex":0},', 5000)}{}]}`,
  Uint8Array.of(0x7b, 0x22, 0xff, 0xfe, 0x22, 0x3a, 0x31, 0x7d), // broken UTF-8 in a name
  Uint8Array.of(0x22, 0xc3, 0x28, 0x22),
  Uint8Array.of(0xff, 0xfe, 0x7b, 0x00, 0x7d, 0x00), // UTF-16
  Uint8Array.of(0x1f, 0x8b, 0x08, 0x00),
  new Uint8Array(1000),
];
const types = [
  "application/json",
  "application/json",
  "application/json",
  "application/json; charset=utf-16",
  "application/x-ndjson",
  "multipart/form-data",
  "multipart/form-data; boundary=",
  "multipart/form-data; boundary=b",
  "application/octet-stream",
  "text/html",
  "a",
  "",
];

async function checked(response: Response, what: string): Promise<void> {
  const text = await response.text();
  assert.ok(
    response.status !== 500 && response.status < 505,
    `${response.status} ${text}: ${what}`,
  );
  if (response.status < 400) return;
  assert.match(response.headers.get("content-type") ?? "", /^application\/problem\+json/, what);
  const told = JSON.parse(text) as { detail: string; status: number };
  assert.equal(told.status, response.status, what);
  assert.ok(told.detail.length > 0 && told.detail.length < 2000, `${what}: ${told.detail.length}`);
}

test("bodies that are no JSON, for every route", { timeout }, () =>
  onStage(
    async ({ url, gateway }) => {
      const session = await puppet(url, 4);
      const dice = new Dice(seed);
      for (let round = 0; round < rounds; round++) {
        for (const { method, path, hasBody } of routesOf(gateway.openapi(), session, dice)) {
          // Its session would be gone for the others.
          if (method === "DELETE" && path.endsWith(session)) continue;
          for (let i = 0; i < (hasBody ? 12 : 1); i++) {
            const body = hasBody ? dice.of(bodies) : undefined;
            const type = dice.of(types);
            const coding = dice.below(10) === 0 ? { "content-encoding": "gzip" } : {};
            const what = `${method} ${path} ${type} ${String(body).slice(0, 60)}`;
            const response = await fetch(`${url}${path}`, {
              method,
              ...(body !== undefined && { body }),
              headers: { ...(hasBody && { "content-type": type }), ...coding },
              signal: AbortSignal.timeout(soonMs),
            });
            await checked(response, what);
          }
        }
      }
      await json(`${url}/v1/sessions/${session}`);
    },
    { maxRequestsPerMinute: 1e9, maxJobsPerUser: 100 },
  ),
);

/** Sends bytes as they are and cuts the connection, or waits for what comes. */
function raw(url: string, bytes: Buffer, cuts: boolean): Promise<string> {
  return new Promise((resolve, reject) => {
    const { hostname, port } = new URL(url);
    const socket = connect(Number(port), hostname);
    let heard = "";
    const late = setTimeout(() => socket.destroy(new Error("no answer came")), soonMs);
    socket.on("data", (data: Buffer) => (heard += data.toString("latin1")));
    socket.on("error", (error: NodeJS.ErrnoException) =>
      // The gateway may cut what it need not read.
      ["ECONNRESET", "EPIPE"].includes(error.code ?? "") ? resolve(heard) : reject(error),
    );
    socket.on("close", () => {
      clearTimeout(late);
      resolve(heard);
    });
    socket.write(bytes, () => (cuts ? socket.destroy() : socket.end()));
  });
}

test("uploads that end too soon, and requests that are none", { timeout }, () =>
  onStage(
    async ({ url }) => {
      const dice = new Dice(seed);
      const form = (file: Buffer): Buffer =>
        Buffer.concat([
          Buffer.from('--b\r\ncontent-disposition: form-data; name="file"; filename="a"\r\n\r\n'),
          file,
          Buffer.from("\r\n--b--\r\n"),
        ]);
      for (let i = 0; i < 40 * rounds; i++) {
        const path = dice.of(["/v1/surfaces", "/v1/flatten", "/v1/jobs", "/v1/sessions"]);
        const whole = form(dice.of(files));
        const body = whole.subarray(0, dice.below(whole.length));
        const length = dice.of([
          `content-length: ${whole.length}`,
          `content-length: ${body.length}`,
          "content-length: 999999999999",
          "content-length: -1",
          "transfer-encoding: chunked",
          "transfer-encoding: chunked\r\ncontent-length: 5",
          "x: y",
        ]);
        const head =
          `${dice.of(["POST", "POST", "PATCH", "BREW"])} ${path} HTTP/1.1\r\nhost: localhost\r\nconnection: close\r\n` +
          `content-type: ${dice.of(["multipart/form-data; boundary=b", "application/json"])}\r\n${length}\r\n\r\n`;
        const heard = await raw(url, Buffer.concat([Buffer.from(head), body]), dice.below(2) === 0);
        const status = Number(/^HTTP\/1\.1 (\d+)/.exec(heard)?.[1] ?? 0);
        assert.ok(status !== 500, `${head}${heard.slice(0, 500)}`);
      }
      for (const garbage of [
        "\r\n\r\n",
        "GET\r\n\r\n",
        "\u0000\u0001\u0002",
        "PRI * HTTP/2.0\r\n\r\n",
      ]) {
        await raw(url, Buffer.from(garbage), false);
      }
      await json(`${url}/v1/info`);
    },
    { maxRequestsPerMinute: 1e9, maxJobsPerUser: 1000 },
  ),
);

test("nobody where arapd should be is a problem of every route, not a crash", { timeout }, () =>
  hold({ arapd: "unix:/nowhere", maxRequestsPerMinute: 1e9 }, async (url, gateway) => {
    const asked = routesOf(gateway.openapi(), "s", new Dice(seed)).map(async ({ method, path }) => {
      const response = await fetch(`${url}${path}`, {
        method,
        headers: { "content-type": "application/json" },
        ...(method !== "GET" && method !== "DELETE" && { body: "{}" }),
        signal: AbortSignal.timeout(2 * soonMs),
      });
      await checked(response, `${method} ${path}`);
    });
    await Promise.all(asked);
  }),
);
