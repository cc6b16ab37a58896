// The gateway inside applications: Fastify's, Express's, and the program by itself.
import assert from "node:assert/strict";
import { execFileSync, spawn } from "node:child_process";
import type { ChildProcess } from "node:child_process";
import { once } from "node:events";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { createServer } from "node:http";
import type { AddressInfo, Socket } from "node:net";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { createInterface } from "node:readline";
import { test } from "node:test";

import fastifyWebsocket from "@fastify/websocket";
import express from "express";
import Fastify from "fastify";
import type { FastifyInstance } from "fastify";
import { WebSocket } from "ws";

import { createGateway, gateway, numberRules } from "@arapd/gateway";

import { Server } from "../../client/test/support/server.js";
import { ask, form, json, problem } from "./support/gateway.js";
import { drag, grid, move, plain, puppet } from "./support/puppet.js";

const timeout = 120_000;
const bowl = { mesh: plain(grid(4, 4, (x, y) => x * y * 0.1)) };

async function withServer<T>(use: (address: string) => Promise<T>): Promise<T> {
  const server = new Server();
  try {
    await server.start();
    return await use(server.address);
  } finally {
    await server.stop();
  }
}

/** Everything that a page does, through a gateway under /arapd. */
async function journey(host: string): Promise<void> {
  const url = `${host}/arapd`;
  const page = await drag(url, await puppet(url));
  page.say(move(9, 1));
  assert.equal((await page.frame()).sequence, 1);
  page.say({ type: "close" });
  assert.equal(await page.closed(), 1000);
  await json(`${url}/v1/flatten`, { body: bowl });
  await json(`${url}/v1/surfaces`, { body: form("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n") });
  const { id } = await json(`${url}/v1/jobs`, { body: bowl }, 202);
  assert.match(await (await ask(`${url}/v1/jobs/${id}/events`)).text(), /event: end/);
  const told = await problem(`${url}/v1/jobs/none`, {}, "NOT_FOUND");
  assert.equal(told.type, "/arapd/problems/not-found");
  await json(`${host}${told.type}`);
  const paths = Object.keys((await json(`${url}/openapi.json`)).paths);
  assert.ok(paths.includes("/arapd/v1/flatten"), paths.join());
}

for (const withWebsocket of [false, true]) {
  test(
    `in a Fastify application${withWebsocket ? " that has sockets of its own" : ""}`,
    { timeout },
    () =>
      withServer(async (arapd) => {
        // Else it waits for connections that fetch keeps.
        const app: FastifyInstance = Fastify({ forceCloseConnections: true });
        const heard: string[] = [];
        app.addHook("onRequest", async ({ url }) => void heard.push(url));
        if (withWebsocket) {
          await app.register(fastifyWebsocket);
          app.get("/echo", { websocket: true }, (socket) => {
            socket.on("message", (text) => socket.send(text));
          });
        }
        await app.register(gateway, { prefix: "/arapd", arapd, processMetrics: false });
        app.post("/own", async ({ body }) => ({ got: body }));
        const host = await app.listen({ port: 0, host: "127.0.0.1" });
        try {
          await journey(host);
          assert.ok(heard.includes("/arapd/v1/flatten"));
          // What is not the gateway's stays as it was.
          assert.deepEqual(await json(`${host}/own`, { body: { a: 1 } }), { got: { a: 1 } });
          assert.equal(
            ((await (await ask(`${host}/none`)).json()) as { error: string }).error,
            "Not Found",
          );
          const other = new WebSocket(`${host.replace("http", "ws")}/echo`);
          if (withWebsocket) {
            await once(other, "open");
            other.send("hello");
            assert.equal(String((await once(other, "message"))[0]), "hello");
            other.close();
          } else {
            other.on("error", () => {});
            const [, response] = (await once(other, "unexpected-response")) as [
              unknown,
              { statusCode: number },
            ];
            assert.equal(response.statusCode, 404);
          }
          // A socket does not keep the application from closing.
          await drag(`${host}/arapd`, await puppet(`${host}/arapd`));
        } finally {
          await app.close();
        }
      }),
  );
}

test("in an Express application", { timeout }, () =>
  withServer(async (arapd) => {
    const inner = await createGateway({ arapd, prefix: "/arapd", processMetrics: false });
    const app = express();
    app.use((request, response, next) =>
      inner.owns(request) ? inner.handle(request, response) : next(),
    );
    app.use(express.json());
    app.post("/own", (request, response) => void response.json({ got: request.body as unknown }));
    const server = createServer(app);
    server.on("upgrade", (request, socket, head) => {
      if (inner.owns(request)) inner.upgrade(request, socket as Socket, head);
    });
    await new Promise<void>((resolve) => server.listen(0, "127.0.0.1", resolve));
    const host = `http://127.0.0.1:${(server.address() as AddressInfo).port}`;
    try {
      await journey(host);
      assert.deepEqual(await json(`${host}/own`, { body: { a: 1 } }), { got: { a: 1 } });
      assert.equal((await ask(`${host}/arapdx`)).status, 404);
    } finally {
      await inner.close();
      server.closeAllConnections();
      await new Promise((resolve) => server.close(resolve));
    }
  }),
);

interface Program {
  child: ChildProcess;
  url: string;
  lines: string[];
}
const main = join(process.cwd(), "dist/main.js");

async function program(
  words: string[],
  environment: Record<string, string> = {},
): Promise<Program> {
  const child = spawn(process.execPath, [main, "--listen", "127.0.0.1:0", ...words], {
    stdio: ["ignore", "pipe", "inherit"],
    env: { ...process.env, ...environment },
  });
  const lines: string[] = [];
  const reader = createInterface({ input: child.stdout! });
  const ready = new Promise<string>((resolve, reject) => {
    reader.on("line", (line) => {
      lines.push(line);
      const url = /^gateway listening on (.*)$/.exec(line)?.[1];
      if (url) resolve(url);
    });
    reader.on("close", () => reject(new Error(`the gateway ended:\n${lines.join("\n")}`)));
  });
  return { child, url: await ready, lines };
}

async function ended(words: string[]): Promise<{ code: number; said: string }> {
  const child = spawn(process.execPath, [main, ...words], { stdio: ["ignore", "pipe", "pipe"] });
  let said = "";
  for (const stream of [child.stdout, child.stderr])
    stream.on("data", (text: Buffer) => (said += text.toString()));
  const [code] = (await once(child, "close")) as [number];
  return { code, said };
}

test("the program: pages, logs, and a graceful end", { timeout }, () =>
  withServer(async (arapd) => {
    const folder = mkdtempSync(join(tmpdir(), "arapd-gateway-"));
    writeFileSync(join(folder, "index.html"), "<title>studio</title>");
    const run = await program(["--arapd", arapd, "--static", folder, "--drain-seconds", "60"], {
      ARAPD_GATEWAY_MAX_FILE_BYTES: "4321",
    });
    try {
      assert.match(await (await ask(`${run.url}/`)).text(), /studio/);
      assert.match(
        (await ask(`${run.url}/`)).headers.get("content-security-policy") ?? "",
        /^default-src 'self'/,
      );
      await problem(`${run.url}/none.js`, {}, "NO_SUCH_ROUTE");
      await problem(`${run.url}/../package.json`, {}, "NO_SUCH_ROUTE");
      const { gateway: limits } = await json(`${run.url}/v1/info`, {
        headers: { "x-request-id": "page-7" },
      });
      assert.equal(limits.maxFileBytes, 4321);
      assert.match(
        await (await ask(`${run.url}/metrics`)).text(),
        /^process_resident_memory_bytes \d/m,
      );
      const page = await drag(run.url, await puppet(run.url));
      run.child.kill("SIGTERM");
      await page.text("draining");
      page.say(move(9, 9));
      await page.frame();
      page.say({ type: "close" });
      assert.equal(await page.closed(), 1000);
      const [code] = (await once(run.child, "exit")) as [number];
      assert.equal(code, 0);
      const logged = run.lines
        .filter((line) => line.startsWith("{"))
        .map((line) => JSON.parse(line) as Record<string, unknown>);
      assert.ok(
        logged.some(
          ({ reqId, route, status }) =>
            reqId === "page-7" && route === "/v1/info" && status === 200,
        ),
      );
      assert.ok(logged.some(({ msg }) => msg === "draining"));
    } finally {
      run.child.kill("SIGKILL");
      rmSync(folder, { recursive: true, force: true });
    }
  }),
);

test("the program: metrics of its server", { timeout }, async () => {
  const admin = createServer((_, response) => response.end("arapd_up 1\n"));
  await new Promise<void>((resolve) => admin.listen(0, "127.0.0.1", resolve));
  const { port } = admin.address() as AddressInfo;
  const run = await program([
    "--arapd",
    "unix:/nowhere",
    "--arapd-admin",
    `http://127.0.0.1:${port}`,
  ]);
  try {
    const response = await ask(`${run.url}/metrics/arapd`);
    assert.equal(await response.text(), "arapd_up 1\n");
    assert.match(response.headers.get("content-type") ?? "", /^text\/plain/);
    admin.closeAllConnections();
    await new Promise((resolve) => admin.close(resolve));
    await problem(`${run.url}/metrics/arapd`, {}, "DRAINING");
    run.child.kill("SIGINT");
    assert.equal((await once(run.child, "exit"))[0], 0);
  } finally {
    run.child.kill("SIGKILL");
    admin.close();
  }
});

test("the program: flags that are wrong", { timeout }, async () => {
  const wrong: [string[], RegExp][] = [
    [["--max-sockets", "many"], /--max-sockets: "many" is no whole number/],
    [["--max-sockets", "0"], /maxSockets is 0/],
    [["--listen", "here"], /--listen: "here" is no HOST:PORT/],
    [["--colour"], /colour/],
    [["--token-file", "/nowhere"], /--token-file: .*\/nowhere/],
    [["--static", "/nowhere"], /--static: \/nowhere is no folder/],
    [["--log-level", "loud"], /--log-level/],
    [["--metrics", "some"], /metrics/],
    [["word"], /word/],
  ];
  const check = async ([words, said]: (typeof wrong)[number]): Promise<void> => {
    const { code, said: text } = await ended(words);
    assert.equal(code, 2, text);
    assert.match(text, said);
  };
  await Promise.all(wrong.map(check));
});

test("the package has what it runs with, and nothing else", { timeout }, () => {
  const words = ["pack", "--dry-run", "--json", "--ignore-scripts", "--offline"];
  const told = execFileSync("npm", words, {
    encoding: "utf8",
    stdio: ["ignore", "pipe", "ignore"],
  });
  const paths = (JSON.parse(told) as [{ files: { path: string }[] }])[0].files.map(
    ({ path }) => path,
  );
  for (const file of [
    "index.js",
    "index.d.ts",
    "main.js",
    "files/worker.js",
    "schemas/base.d.ts",
  ]) {
    assert.ok(paths.includes(`dist/${file}`), file);
  }
  assert.deepEqual(
    paths.filter((path) => !/^(dist\/.*|package\.json|LICENSE)$/.test(path)),
    [],
  );
});

test("docs/web.md has every flag with its default, and so has the help", { timeout }, async () => {
  const page = readFileSync(join(process.cwd(), "../../docs/web.md"), "utf8");
  const { said } = await ended(["--help"]);
  const flags = [...said.matchAll(/^ {2}--([a-z-]+)/gm)].map(([, flag]) => flag!);
  const told = [...page.matchAll(/`--([a-z-]+)[ A-Z:]*`/g)].map(([, flag]) => flag!);
  assert.deepEqual(
    flags.filter((flag) => !told.includes(flag)),
    [],
  );
  for (const [name, rule] of Object.entries(numberRules)) {
    const flag = name.replace(/[A-Z]/g, (letter) => `-${letter.toLowerCase()}`);
    const row = page
      .split("\n")
      .find((line) => line.startsWith("|") && line.includes(`\`--${flag} `));
    assert.ok(
      row?.includes(` ${rule.default}`),
      `the row of --${flag} has to say ${rule.default}: ${row}`,
    );
  }
});
