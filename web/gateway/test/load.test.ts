// Load: what operators may see of the gateway and its server.
import assert from "node:assert/strict";
import { createServer } from "node:http";
import type { AddressInfo } from "node:net";
import { test } from "node:test";

import { Server } from "../../client/test/support/server.js";
import { Metrics } from "#gateway/load/prometheus.js";
import type { LoadAnswer } from "#gateway/schemas/load.js";
import { ask, hold, json, problem } from "./support/gateway.js";
import { Document } from "./support/openapi.js";
import { drag, move, puppet } from "./support/puppet.js";

const timeout = 240_000;

async function withAdmin(use: (server: Server) => Promise<void>): Promise<void> {
  const server = new Server(["--store", "memory", "--admin", "127.0.0.1:0"]);
  try {
    await server.start();
    await use(server);
  } finally {
    await server.stop();
  }
}

const readLoad = async (url: string): Promise<LoadAnswer> =>
  (await json(`${url}/v1/load`)) as LoadAnswer;

/** Asks until it is so: what is told may be half a second old. */
async function until(url: string, isSo: (load: LoadAnswer) => boolean): Promise<LoadAnswer> {
  for (const limit = Date.now() + 60_000; ; ) {
    const load = await readLoad(url);
    if (isSo(load)) return load;
    assert.ok(Date.now() < limit, JSON.stringify(load));
    await new Promise((resolve) => setTimeout(resolve, 50));
  }
}

test("a drag shows in the numbers of the gateway and of its server", { timeout }, () =>
  withAdmin((server) =>
    hold({ arapd: server.address, arapdAdmin: `http://${server.admin}` }, async (url, gateway) => {
      const session = await puppet(url);
      const page = await drag(url, session);
      for (let i = 1; i <= 5; i++) {
        page.say(move(8 + i, 0));
        await page.frame();
      }
      const frames = (load: LoadAnswer): number => load.server?.phaseSeconds["frame"]?.count ?? 0;
      const load = await until(
        url,
        (told) =>
          told.gateway.shapes === 5 && frames(told) >= 5 && told.gateway.requests["201"] === 3,
      );
      new Document(gateway.openapi()).check("GET", "/v1/load", 200, load);
      assert.equal(load.serverProblem, null);
      const { server: told, gateway: own } = load;
      assert.ok(told);
      assert.match(told.version, /^\d+\.\d+\.\d+/);
      assert.equal(told.sessions, 1);
      assert.equal(told.streams, 1);
      const { counts, bounds, count } = told.phaseSeconds["frame"]!;
      assert.equal(counts.length, bounds.length + 1);
      assert.equal(
        counts.reduce((sum, one) => sum + one, 0),
        count,
      );
      assert.ok(told.workers["interactive"]! > 0);
      assert.ok(told.memoryBytes > 1e6 && own.memoryBytes > 1e6);
      assert.equal(own.sockets, 1);
      assert.equal(own.requests["200"] ?? 0, 0, "who watches is no load");
      assert.equal(own.seconds["/v1/sessions"]!.count, 1);
      page.socket.terminate();
      await until(url, ({ gateway: { sockets } }) => sockets === 0);
    }),
  ),
);

test("a server that is gone leaves the gateway's own numbers", { timeout }, () =>
  withAdmin((server) =>
    hold({ arapd: server.address, arapdAdmin: `http://${server.admin}` }, async (url, gateway) => {
      await until(url, (load) => load.server !== null);
      await server.end("SIGKILL");
      const load = await until(url, (told) => told.server === null);
      assert.match(load.serverProblem!, /admin page does not answer/);
      assert.ok(load.gateway.memoryBytes > 0);
      new Document(gateway.openapi()).check("GET", "/v1/load", 200, load);
    }),
  ),
);

test("only operators see it, and nobody where nobody has asked for it", { timeout }, async () => {
  const arapdAdmin = "http://127.0.0.1:9"; // nobody there
  await hold({}, async (url) => {
    const told = await problem(`${url}/v1/load`, {}, "NO_SUCH_ROUTE");
    assert.match(told.detail, /does not know the admin page/);
  });
  await hold({ arapdAdmin, metrics: "none" }, async (url) => {
    await problem(`${url}/v1/load`, {}, "NO_SUCH_ROUTE");
  });
  await hold({ arapdAdmin, metrics: "all", user: () => undefined }, async (url) => {
    // Also where users are told apart an operator needs to be none of them.
    const headers = { "x-forwarded-for": "10.0.0.7" };
    assert.equal((await ask(`${url}/v1/load`, { headers })).status, 200);
    await problem(`${url}/v1/info`, {}, "UNKNOWN_USER");
  });
  await hold({ arapdAdmin }, async (url) => {
    assert.equal((await ask(`${url}/v1/load`)).status, 200);
    for (const path of ["/v1/load", "/metrics", "/metrics/arapd"]) {
      for (const header of ["x-forwarded-for", "forwarded", "via"]) {
        await problem(`${url}${path}`, { headers: { [header]: "for=10.0.0.7" } }, "NO_SUCH_ROUTE");
      }
    }
  });
});

test(
  "a page under a name that a stranger has pointed at this machine reads none of it",
  { timeout },
  () =>
    hold({ arapdAdmin: "http://127.0.0.1:9", origins: ["http://ours.example"] }, async (url) => {
      // fetch writes Host itself, so the request is written here.
      const { request } = await import("node:http");
      const statusFor = (host: string, path: string): Promise<number> =>
        new Promise((resolve, reject) => {
          const asked = request(`${url}${path}`, { headers: { host } }, (response) => {
            response.resume();
            resolve(response.statusCode ?? 0);
          });
          asked.on("error", reject);
          asked.end();
        });
      for (const path of ["/v1/load", "/metrics"]) {
        assert.equal(await statusFor("evil.example", path), 404, path);
        for (const host of ["localhost:1", "127.0.0.1", "[::1]:8080", "ours.example"]) {
          assert.equal(await statusFor(host, path), 200, `${path} ${host}`);
        }
      }
    }),
);

test(
  "an admin page that is none, too long, or leads elsewhere is told as such",
  { timeout },
  async () => {
    const texts: Record<string, [status: number, headers: Record<string, string>, body: string]> = {
      long: [200, {}, "x 1\n".repeat(1_500_000)],
      away: [302, { location: "http://127.0.0.1:9/metrics" }, ""],
      wrong: [500, {}, ""],
    };
    let what = "";
    const admin = createServer((_, response) => {
      const [status, headers, body] = texts[what] ?? [
        200,
        {},
        '\u0000{}\nx{y="z\n arapd_sessions nan\n',
      ];
      response.writeHead(status, headers).end(body);
    });
    await new Promise<void>((resolve) => admin.listen(0, "127.0.0.1", resolve));
    const arapdAdmin = `http://127.0.0.1:${(admin.address() as AddressInfo).port}`;
    try {
      for (what of Object.keys(texts)) {
        await hold({ arapdAdmin }, async (url) => {
          assert.equal((await readLoad(url)).server, null, what);
          await problem(`${url}/metrics/arapd`, {}, "DRAINING");
        });
      }
      what = "garbage";
      await hold({ arapdAdmin }, async (url) => {
        const { server } = await readLoad(url);
        assert.ok(server);
        assert.equal(server.version, "");
        assert.deepEqual(server.phaseSeconds, {});
      });
    } finally {
      admin.closeAllConnections();
      admin.close();
    }
  },
);

test("metrics are read as they are written", () => {
  const text = [
    "# HELP a_seconds x",
    'a_seconds_bucket{m="x",le="0.1"} 1',
    'a_seconds_bucket{m="x",le="1"} 3',
    'a_seconds_bucket{m="x",le="+Inf"} 4',
    'a_seconds_sum{m="x"} 2.5',
    'a_seconds_count{m="x"} 4',
    'n{a="q\\"\\\\\\n{}",b="1"} 1e3',
    'n{a="other",b="1"} 2',
    "plain -1",
    "nothing",
  ].join("\n");
  const metrics = new Metrics(text);
  assert.deepEqual(metrics.times("a_seconds", "m"), {
    x: { bounds: [0.1, 1], counts: [1, 2, 1], sum: 2.5, count: 4 },
  });
  assert.deepEqual(metrics.by("n", "a"), { 'q"\\\n{}': 1000, other: 2 });
  assert.equal(metrics.total("n"), 1002);
  assert.equal(metrics.total("plain"), -1);
  assert.equal(metrics.total("nothing"), 0);
});
