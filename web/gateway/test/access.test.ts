// Who may ask: users and tokens, origins, proxies, rates and counts; and what no page ever sees.
import assert from "node:assert/strict";
import { execFileSync, spawnSync } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import type { IncomingMessage } from "node:http";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";

import { Client } from "@arapd/client";
import { createGateway } from "@arapd/gateway";
import { ownerOf } from "#gateway/caller.js";

import { Server } from "../../client/test/support/server.js";
import { ask, hold, json, onStage, problem } from "./support/gateway.js";
import { Page } from "./support/page.js";
import { grid, plain, puppet } from "./support/puppet.js";
import { tokenFile } from "./support/tokens.js";

const timeout = 120_000;
const user = ({ headers }: IncomingMessage): string | undefined =>
  headers["x-user"] as string | undefined;

test("users have sessions of their own, and the token stays where it is", { timeout }, async () => {
  const folder = mkdtempSync(join(tmpdir(), "arapd-gateway-"));
  const { file, token } = tokenFile(folder);
  const server = new Server(["--store", "memory", "--token-file", file], "127.0.0.1:0");
  const logged: string[] = [];
  const log = { write: (line: string): void => void logged.push(line) };
  const { pino } = await import("pino");
  try {
    await server.start();
    await hold({ arapd: server.address, token, user, logger: pino({}, log) }, async (url) => {
      const as = (name: string) => ({ headers: { "x-user": name } });
      const ann = await puppet(url, 5, { "x-user": "ann" });
      await json(`${url}/v1/sessions/${ann}`, as("ann"));
      await problem(`${url}/v1/sessions/${ann}`, as("bob"), "NOT_FOUND");
      await problem(`${url}/v1/sessions/${ann}`, {}, "UNKNOWN_USER");
      // What a browser claims to be goes no further.
      await problem(
        `${url}/v1/sessions/${ann}`,
        { headers: { "x-user": "bob", "x-arapd-owner": "ann" } },
        "NOT_FOUND",
      );
      await problem(
        `${url}/v1/sessions/${ann}`,
        { headers: { "x-user": "bob", authorization: `Bearer ${token}` } },
        "NOT_FOUND",
      );
      const mail = await json(`${url}/v1/sessions`, { body: {}, ...as("ann@example.org") }, 201);
      await json(`${url}/v1/sessions/${mail.id}`, as("ann@example.org"));
      const known = Client.connect(server.address, { token, user: ownerOf("ann@example.org") });
      assert.equal((await known.listSessions()).sessions[0]!.id, mail.id);
      known.close();

      const job = await json(
        `${url}/v1/jobs`,
        { body: { mesh: plain(grid(3, 3, () => 0)) }, ...as("ann") },
        202,
      );
      await problem(`${url}/v1/jobs/${job.id}`, as("bob"), "NOT_FOUND");
      await json(`${url}/v1/jobs/${job.id}`, as("ann"));

      const stranger = await Page.refused(url, `/v1/sessions/${ann}/stream`);
      assert.equal(stranger.reason, "UNKNOWN_USER");
      const bob = await Page.connect(url, ann, { "x-user": "bob" });
      bob.say({ type: "open", handleSet: "h" });
      assert.equal((await bob.failed()).reason, "NOT_FOUND");
      const page = await Page.connect(url, ann, { "x-user": "ann" });
      page.say({ type: "open", handleSet: "h" });
      await page.text("opened");
      page.socket.close();

      const everything = [
        JSON.stringify(await json(`${url}/v1/info`, as("ann"))),
        await (await ask(`${url}/metrics`)).text(),
        ...logged,
      ].join("\n");
      for (const secret of [token, token.slice(-64), ann, "ann@example.org"])
        assert.ok(!everything.includes(secret), secret);
      assert.ok(
        logged.some(
          (line) => (JSON.parse(line) as { route?: string }).route === "/v1/sessions/:session",
        ),
      );
    });
    await hold(
      {
        arapd: server.address,
        token: `${token.slice(0, -1)}${token.endsWith("0") ? "1" : "0"}`,
        user,
      },
      async (url) => {
        const told = await problem(
          `${url}/v1/sessions`,
          { body: {}, headers: { "x-user": "ann" } },
          "UNAUTHENTICATED",
        );
        assert.equal(told.status, 502);
      },
    );
  } finally {
    await server.stop();
    rmSync(folder, { recursive: true, force: true });
  }
});

const hasOpenssl = spawnSync("openssl", ["version"]).status === 0;

test(
  "TLS to arapd, with a certificate of the gateway's own",
  { timeout, skip: hasOpenssl ? false : "there is no openssl" },
  async () => {
    const folder = mkdtempSync(join(tmpdir(), "arapd-gateway-"));
    const path = (name: string): string => join(folder, name);
    const openssl = (...words: string[]): void =>
      void execFileSync("openssl", words, { cwd: folder, stdio: "pipe" });
    const key = [
      "-newkey",
      "ec",
      "-pkeyopt",
      "ec_paramgen_curve:prime256v1",
      "-nodes",
      "-days",
      "2",
    ];
    // Each is its own authority.
    for (const name of ["localhost", "web"]) {
      const names = ["-subj", `/CN=${name}`, "-addext", `subjectAltName=DNS:${name}`];
      openssl("req", "-x509", ...key, "-keyout", `${name}.key`, "-out", `${name}.crt`, ...names);
    }
    const tls = [
      "--tls-cert",
      path("localhost.crt"),
      "--tls-key",
      path("localhost.key"),
      "--tls-client-ca",
      path("web.crt"),
    ];
    const server = new Server(
      ["--store", "memory", "--require-client-cert", ...tls],
      "127.0.0.1:0",
    );
    try {
      await server.start();
      const arapd = server.address.replace("127.0.0.1", "localhost");
      await hold(
        { arapd, tlsCa: path("localhost.crt"), tlsCert: path("web.crt"), tlsKey: path("web.key") },
        async (url) => {
          await puppet(url, 3);
        },
      );
      await hold(
        { arapd, tlsCa: path("localhost.crt") },
        async (url) => void (await problem(`${url}/readyz`, {}, "DRAINING")),
      );
    } finally {
      await server.stop();
      rmSync(folder, { recursive: true, force: true });
    }
  },
);

test("names that arapd does not know are given others", () => {
  assert.equal(ownerOf("ann"), "ann");
  assert.match(ownerOf("ann@example.org"), /^u\.[0-9a-f]{32}$/);
  // Nobody can be somebody else by calling himself so.
  const taken = ownerOf("ann@example.org");
  assert.notEqual(ownerOf(taken), taken);
  assert.match(ownerOf("x".repeat(500)), /^u\./);
});

test("pages of other sites may not ask", { timeout }, () =>
  onStage(
    async ({ url }) => {
      const own = url;
      const asked = (origin: string) => ({ body: {}, headers: { origin } });
      const response = await ask(`${url}/v1/sessions`, asked(own));
      assert.equal(response.status, 201);
      assert.equal(response.headers.get("access-control-allow-origin"), null);
      await json(`${url}/v1/sessions`, asked("https://shop.example"), 201);
      for (const origin of [
        "https://evil.example",
        "null",
        own.replace("http:", "https:"),
        `${own}1`,
      ]) {
        await problem(`${url}/v1/sessions`, asked(origin), "FORBIDDEN_ORIGIN");
        const told = await Page.refused(url, "/v1/sessions/any/stream", { origin });
        assert.equal(told.reason, "FORBIDDEN_ORIGIN");
      }
      // A name that its owner has pointed at this machine.
      const { port } = new URL(url);
      const sameEverywhere = (name: string) => ({
        origin: `http://${name}:${port}`,
        host: `${name}:${port}`,
      });
      const rebound = await Page.refused(
        url,
        "/v1/sessions/any/stream",
        sameEverywhere("evil.example"),
      );
      assert.equal(rebound.reason, "FORBIDDEN_ORIGIN");
      for (const name of ["localhost", "arapd.localhost", "127.0.0.1", "[::1]"])
        (await Page.connect(url, "any", sameEverywhere(name))).socket.terminate();
      await json(`${url}/v1/info`, { headers: { origin: "https://evil.example" } });
      assert.equal(
        (
          await ask(`${url}/v1/flatten`, {
            method: "OPTIONS",
            headers: { origin: "https://evil.example" },
          })
        ).status,
        403,
      );
      for (const origin of [own, "https://shop.example"])
        (await Page.connect(url, "any", { origin })).socket.terminate();
      assert.equal((await Page.refused(url, "/elsewhere")).reason, "NO_SUCH_ROUTE");
    },
    { origins: ["https://shop.example"] },
  ),
);

test("proxies are believed where that was said, and nobody else", { timeout }, () =>
  onStage(async ({ server }) => {
    const forwarded = {
      "x-forwarded-for": "10.0.0.7",
      "x-forwarded-host": "web.example",
      "x-forwarded-proto": "https",
    };
    const origin = { origin: "https://web.example", ...forwarded };
    await hold(
      { arapd: server.address, trustProxy: ["127.0.0.1"], maxRequestsPerMinute: 1 },
      async (url) => {
        await json(`${url}/v1/sessions`, { body: {}, headers: origin }, 201);
        // Rates are those of the address that the proxy tells.
        await problem(`${url}/v1/sessions`, { body: {}, headers: origin }, "RATE_LIMITED");
        await json(
          `${url}/v1/sessions`,
          { body: {}, headers: { ...origin, "x-forwarded-for": "10.0.0.8" } },
          201,
        );
        assert.equal((await ask(`${url}/metrics`, { headers: forwarded })).status, 404);
      },
    );
    await hold({ arapd: server.address, maxRequestsPerMinute: 1 }, async (url) => {
      await problem(`${url}/v1/sessions`, { body: {}, headers: origin }, "FORBIDDEN_ORIGIN");
      await json(`${url}/v1/sessions`, { body: {}, headers: forwarded }, 201);
      await problem(
        `${url}/v1/sessions`,
        { body: {}, headers: { ...forwarded, "x-forwarded-for": "10.0.0.9" } },
        "RATE_LIMITED",
      );
    });
  }),
);

test("rates and counts", { timeout }, () =>
  onStage(
    async ({ url }) => {
      const first = await Page.connect(url, "any");
      const second = await Page.connect(url, "any");
      const third = await Page.refused(url, "/v1/sessions/any/stream");
      assert.equal(third.reason, "RATE_LIMITED");
      first.say({ type: "open", handleSet: "h" });
      await first.failed();
      // It made room.
      const again = await Page.connect(url, "any");
      again.socket.terminate();
      second.socket.terminate();
    },
    { maxSocketsPerUser: 2 },
  ),
);

test("too many messages end a stream", { timeout }, () =>
  onStage(
    async ({ url }) => {
      const page = await Page.connect(url, await puppet(url));
      page.say({ type: "open", handleSet: "h" });
      await page.text("opened");
      // All in one packet, faster than any bucket fills.
      for (let i = 0; i < 1000; i++) page.say({ type: "seen", sequence: i });
      const told = await page.failed();
      assert.equal(told.reason, "RATE_LIMITED");
      assert.ok(told.retryAfterMs! > 0);
      const large = await Page.connect(url, "any");
      large.socket.send(" ".repeat(2000));
      assert.equal(await large.closed(), 1009);
    },
    { maxMessagesPerSecond: 20, maxMessageBytes: 1000 },
  ),
);

test("all sockets, and all connections, together", { timeout }, () =>
  onStage(async ({ server }) => {
    await hold({ arapd: server.address, maxSockets: 1 }, async (url) => {
      const page = await Page.connect(url, "any");
      assert.equal((await Page.refused(url, "/v1/sessions/any/stream")).reason, "GATEWAY_BUSY");
      page.socket.terminate();
    });
    // Streams of users hold connections; those that nobody uses are closed for others.
    await hold({ arapd: server.address, maxConnections: 1, user }, async (url) => {
      for (const name of ["ann", "bob", "ann"])
        await json(`${url}/v1/info`, { headers: { "x-user": name } });
      assert.match(await (await ask(`${url}/metrics`)).text(), /^arapd_gateway_connections 1$/m);
    });
  }),
);

test("bodies have a limit together", { timeout }, () =>
  onStage(
    async ({ url }) => {
      const body = { mesh: plain(grid(3, 3, () => 0)) };
      await json(`${url}/v1/flatten`, { body });
      const large = { mesh: plain(grid(9, 9, () => 0)) };
      const told = await problem(`${url}/v1/flatten`, { body: large }, "GATEWAY_BUSY");
      assert.equal(told.retryAfterMs, 1000);
      await json(`${url}/v1/flatten`, { body }); // what was answered counts no more
    },
    { maxBytesUnderWay: 800, maxBodyBytes: 1024 },
  ),
);

test("metrics are told to whom they are for", { timeout }, () =>
  onStage(async ({ server }) => {
    await hold(
      { arapd: server.address, metrics: "none" },
      async (url) => void (await problem(`${url}/metrics`, {}, "NO_SUCH_ROUTE")),
    );
    await hold({ arapd: server.address, metrics: "all" }, async (url) => {
      assert.equal(
        (await ask(`${url}/metrics`, { headers: { "x-forwarded-for": "10.0.0.7" } })).status,
        200,
      );
    });
    await hold({ arapd: server.address }, async (url) => {
      assert.equal((await ask(`${url}/metrics`)).status, 200);
      for (const header of ["x-forwarded-for", "forwarded", "via"]) {
        await problem(`${url}/metrics`, { headers: { [header]: "for=10.0.0.7" } }, "NO_SUCH_ROUTE");
      }
      await problem(`${url}/metrics/arapd`, {}, "NO_SUCH_ROUTE");
    });
  }),
);

test("every answer has headers that shut out what does not belong there", { timeout }, () =>
  onStage(async ({ url }) => {
    for (const path of ["/v1/info", "/v1/nothing", "/docs/", "/openapi.json", "/healthz"]) {
      const { headers } = await ask(`${url}${path}`);
      assert.equal(headers.get("x-content-type-options"), "nosniff", path);
      assert.equal(headers.get("referrer-policy"), "no-referrer");
      assert.equal(headers.get("x-frame-options"), "DENY");
      assert.match(
        headers.get("content-security-policy") ?? "",
        /^default-src '(none|self)'.*frame-ancestors 'none'/,
      );
      assert.match(headers.get("x-request-id") ?? "", /^[0-9a-f]{16}$/);
      assert.equal(headers.get("access-control-allow-origin"), null);
    }
    const named = await ask(`${url}/v1/sessions/none`, { headers: { "x-request-id": "page-7" } });
    assert.equal(named.headers.get("x-request-id"), "page-7");
    const unfit = await ask(`${url}/v1/info`, { headers: { "x-request-id": "no name" } });
    assert.match(unfit.headers.get("x-request-id") ?? "", /^[0-9a-f]{16}$/);
  }),
);

test("options that are wrong are told when the gateway is made", async () => {
  for (const [options, said] of [
    [{ maxSockets: 0 }, /^maxSockets is 0; it has to be a whole number, 1 to/],
    [{ prefix: "arapd" }, /^prefix/],
    [{ origins: ["shop.example"] }, /no origin/],
    [{ trustProxy: ["nowhere"] }, /^trustProxy/],
    [{ arapdAdmin: "nowhere" }, /^arapdAdmin/],
    [{ arapd: "10.0.0.1:1", token: "secret" }, /in plaintext/],
    [{ tlsCa: "/nowhere.pem" }, /cannot be read/],
  ] as const) {
    await assert.rejects(createGateway({ ...options }), (error) =>
      said.test((error as Error).message),
    );
  }
});
