// The nginx configuration of docs/web.md, word for word, in a real nginx before the gateway.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import type { ChildProcess } from "node:child_process";
import { once } from "node:events";
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { createServer } from "node:http";
import type { AddressInfo, Server as HttpServer } from "node:net";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import { setTimeout as delay } from "node:timers/promises";

import { Server } from "../../client/test/support/server.js";
import { eventsOf } from "./support/events.js";
import { stlBytes } from "./support/files.js";
import { ask, form, hold, json, problem } from "./support/gateway.js";
import { Page } from "./support/page.js";
import { long, move, puppet } from "./support/puppet.js";
import { tokenFile } from "./support/tokens.js";

const nginx = "/usr/sbin/nginx";
const skip = existsSync(nginx) ? false : "nginx is not installed";
const timeout = 240_000;

const running = new Set<ChildProcess>();
process.on("exit", () => running.forEach((child) => child.kill("SIGKILL")));

const page = readFileSync(join(process.cwd(), "../../docs/web.md"), "utf8");
const locations = /```nginx\n([\s\S]*?)```/.exec(page)![1]!;

async function freePort(): Promise<number> {
  const server = createServer().listen(0, "127.0.0.1");
  await once(server, "listening");
  const { port } = server.address() as AddressInfo;
  server.close();
  await once(server, "close");
  return port;
}

/** Where somebody says who is asking: whom the cookie names. */
async function guard(): Promise<{ server: HttpServer; port: number }> {
  const server = createServer((request, response) => {
    const user = /user=(\w+)/.exec(request.headers.cookie ?? "")?.[1];
    if (user !== undefined) response.setHeader("x-user", user);
    response.writeHead(user === undefined ? 401 : 204).end();
  }).listen(0, "127.0.0.1");
  await once(server, "listening");
  return { server, port: (server.address() as AddressInfo).port };
}

/** Runs nginx with the locations of the docs, and gives its address. */
async function withNginx(
  folder: string,
  gatewayUrl: string,
  use: (url: string) => Promise<void>,
): Promise<void> {
  const { server, port: guardPort } = await guard();
  const written = locations
    .replace("http://127.0.0.1:8080;", `${gatewayUrl};`)
    .replace("http://127.0.0.1:9000/;", `http://127.0.0.1:${guardPort}/;`);
  assert.ok(written.includes(gatewayUrl) && written.includes(`:${guardPort}/`));
  try {
    // A port that was free may be taken by then: nginx says so and ends.
    for (let tries = 0; ; tries++) {
      const port = await freePort();
      const configuration = `
        daemon off;
        ${process.getuid?.() === 0 ? "user root;" : ""}
        pid ${folder}/pid;
        error_log ${folder}/error.log notice;
        events {}
        http {
          access_log off;
          ${["client_body", "proxy", "fastcgi", "uwsgi", "scgi"].map((name) => `${name}_temp_path ${folder}/${name};`).join(" ")}
          server {
            listen 127.0.0.1:${port};
            ${written}
          }
        }`;
      writeFileSync(join(folder, "nginx.conf"), configuration);
      const words = [
        "-c",
        join(folder, "nginx.conf"),
        "-p",
        folder,
        "-e",
        join(folder, "error.log"),
      ];
      const child = spawn(nginx, words, { stdio: "inherit" });
      running.add(child);
      const ended = once(child, "exit").then(() => running.delete(child));
      try {
        if (!(await answers(`http://127.0.0.1:${port}/healthz`, child))) {
          if (tries < 5) continue;
          assert.fail(readFileSync(join(folder, "error.log"), "utf8"));
        }
        return await use(`http://127.0.0.1:${port}`);
      } finally {
        child.kill("SIGTERM");
        await ended;
      }
    }
  } finally {
    server.close();
  }
}

async function answers(url: string, child: ChildProcess): Promise<boolean> {
  for (const limit = Date.now() + 60_000; child.exitCode === null && Date.now() < limit; ) {
    const response = await fetch(url, { headers: { cookie: "user=ann" } }).catch(() => undefined);
    if (response?.status === 200) return true;
    await delay(50);
  }
  return false;
}

test("behind nginx as docs/web.md has it", { timeout, skip }, async () => {
  const folder = mkdtempSync(join(tmpdir(), "arapd-nginx-"));
  const { file, token } = tokenFile(folder);
  const server = new Server(["--store", "memory", "--token-file", file]);
  try {
    await server.start();
    const options = {
      arapd: server.address,
      token,
      user: ({ headers }: { headers: Record<string, string | string[] | undefined> }) =>
        headers["x-forwarded-user"] as string | undefined,
      trustProxy: ["127.0.0.1"],
    };
    await hold(options, (own) =>
      withNginx(folder, own, async (url) => {
        const ann = { cookie: "user=ann" };
        const bob = { cookie: "user=bob" };
        assert.equal((await ask(`${url}/v1/info`)).status, 401);
        // What is for operators is for nobody who comes through a proxy.
        for (const path of ["/metrics", "/v1/load"]) {
          await problem(`${url}${path}`, { headers: ann }, "NO_SUCH_ROUTE");
        }

        const session = await puppet(url, 5, ann);
        await json(`${url}/v1/sessions/${session}`, { headers: ann });
        await problem(`${url}/v1/sessions/${session}`, { headers: bob }, "NOT_FOUND");
        // Nobody else is who he says he is.
        const liar = { ...bob, "x-forwarded-user": "ann" };
        await problem(`${url}/v1/sessions/${session}`, { headers: liar }, "NOT_FOUND");

        // A file that nginx by itself would not take.
        const corners = Array.from({ length: 30_000 }, (_, i) => [i, 0, 0, i + 1, 0, 0, i, 1, 0]);
        const large = stlBytes(corners.flat());
        assert.ok(large.length > 1 << 20);
        const surface = { body: form("a.stl", large), headers: ann };
        const read = await json(`${url}/v1/surfaces`, surface);
        assert.equal(read.mesh.triangles.length, 90_000);

        // Events come while the job goes on, and its address leads through the proxy.
        const submitted = await ask(`${url}/v1/jobs`, { body: long, headers: ann });
        assert.equal(submitted.status, 202);
        const at = `${url}${submitted.headers.get("location")}`;
        const states: string[] = [];
        for await (const { event, data } of eventsOf(await ask(`${at}/events`, { headers: ann }))) {
          states.push(event === "end" ? event : (data.state as string));
          if (states.length === 1) await json(at, { method: "DELETE", headers: ann });
        }
        assert.match(states[0]!, /^(waiting|running)$/);
        assert.deepEqual(states.slice(-2), ["cancelled", "end"]);

        // A page of the proxy's own origin drags; one of another does not.
        const stream = `/v1/sessions/${session}/stream`;
        const live = await Page.connect(url, session, { ...ann, origin: url });
        live.say({ type: "open", handleSet: "h" });
        await live.text("opened");
        for (let i = 1; i <= 5; i++) {
          live.say(move(4, i));
          assert.equal((await live.frame()).sequence, i);
        }
        live.say({ type: "close" });
        assert.equal(await live.closed(), 1000);
        const stranger = await Page.refused(url, stream, { ...ann, origin: "http://evil.example" });
        assert.equal(stranger.reason, "FORBIDDEN_ORIGIN");
        const other = await Page.connect(url, session, { ...bob, origin: url });
        other.say({ type: "open", handleSet: "h" });
        assert.equal((await other.failed()).reason, "NOT_FOUND");
      }),
    );
  } finally {
    await server.stop();
    rmSync(folder, { recursive: true, force: true });
  }
});
