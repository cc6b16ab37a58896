// Inputs that are made up, of every route and of the stream: nothing but problems comes of them, no
// 500, and the gateway goes on. The same seed makes the same inputs; ARAP_WEB_SEED chooses another.
import assert from "node:assert/strict";
import { test } from "node:test";

import { readSurface } from "#gateway/files/format.js";
import { FileFault } from "#gateway/files/surface.js";

import { ask, json, onStage } from "./support/gateway.js";
import type { Json } from "./support/gateway.js";
import { glb, plyBytes, stlBytes } from "./support/files.js";
import { Page } from "./support/page.js";
import { grid, move, plain, puppet } from "./support/puppet.js";

const rounds = Number(process.env["ARAP_WEB_ROUNDS"] ?? 3);
const seed = Number(process.env["ARAP_WEB_SEED"] ?? 20_090_131);
const timeout = 240_000 + rounds * 60_000;

/** Numbers of a sequence that the seed decides. */
class Dice {
  #state: number;
  constructor(state: number) {
    this.#state = state >>> 0;
  }
  /** 0 to below `limit`. */
  below(limit: number): number {
    this.#state = (Math.imul(this.#state, 1_664_525) + 1_013_904_223) >>> 0;
    return Math.floor((this.#state / 2 ** 32) * limit);
  }
  of<T>(choices: readonly T[]): T {
    return choices[this.below(choices.length)]!;
  }
}

const oddNumbers = [0, -0, 1, -1, 0.5, 2 ** 31, 2 ** 32, -(2 ** 53), 1e-320, 1e300, 4294967295];
const oddTexts = [
  "",
  "h",
  "m",
  "l",
  "none",
  "no name",
  "../..",
  "%2e%2e",
  "\u0000",
  "é".repeat(200),
  "__proto__",
  "constructor",
  "A4",
  "edge",
];

/** A value of any kind, not deep. */
function anything(dice: Dice, depth = 0): unknown {
  switch (dice.below(depth > 2 ? 5 : 8)) {
    case 0:
      return null;
    case 1:
      return dice.below(2) === 0;
    case 2:
    case 3:
      return dice.of(oddNumbers);
    case 4:
      return dice.of(oddTexts);
    case 5:
      return Array.from({ length: dice.below(6) }, () => dice.of(oddNumbers));
    case 6:
      return Array.from({ length: dice.below(4) }, () => anything(dice, depth + 1));
    default:
      return Object.fromEntries(
        Array.from({ length: dice.below(4) }, () => [
          dice.of([...oddTexts, "id", "x", "vertex"]),
          anything(dice, depth + 1),
        ]),
      );
  }
}

/** A copy in which something, somewhere, is another value, missing, or too much. */
function bent(value: Json, dice: Dice): Json {
  if (typeof value !== "object" || value === null || dice.below(6) === 0) return anything(dice);
  if (Array.isArray(value)) {
    const copy: Json[] = [...value];
    const at = dice.below(copy.length + 1);
    if (dice.below(4) === 0) copy.splice(at, 1 + dice.below(3));
    else if (at < copy.length) copy[at] = bent(copy[at], dice);
    else copy.push(copy.length > 0 ? copy[0] : anything(dice));
    return copy;
  }
  const copy: Json = { ...value };
  const keys = Object.keys(copy);
  const key = keys.length > 0 ? dice.of(keys) : "x";
  if (dice.below(5) === 0) delete copy[key];
  else if (dice.below(8) === 0) copy[dice.of(oddTexts)] = anything(dice);
  else copy[key] = bent(copy[key], dice);
  return copy;
}

function bentBytes(bytes: Buffer, dice: Dice): Buffer {
  const copy = Buffer.from(bytes);
  for (let i = dice.below(4); i >= 0 && copy.length > 0; i--)
    copy[dice.below(copy.length)] = dice.below(256);
  switch (dice.below(6)) {
    case 0:
      return copy.subarray(0, dice.below(copy.length));
    case 1:
      return Buffer.concat([copy, copy.subarray(dice.below(copy.length))]);
    default:
      return copy;
  }
}

const words = [
  "v",
  "f",
  "o",
  "g",
  "vt",
  "0",
  "1",
  "-1",
  "1/2",
  "1//3",
  "1e400",
  "nan",
  "\\\n",
  "\n",
  "\n",
  "#",
  "solid",
  "facet",
  "ply",
  "end_header\n",
  "element",
  "vertex",
  "list",
  "\u2028",
];
const made = (dice: Dice): Buffer =>
  Buffer.from(Array.from({ length: dice.below(80) }, () => dice.of(words)).join(" "));

const corner = [0, 0, 0, 1, 0, 0, 0, 1, 0];
const files = [
  Buffer.from(
    "# a\no x\nv 0 0 0\nv 1 0 0\nv 1 1 0.5\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1 4/1\nf -4 -3 -2\n",
  ),
  Buffer.from(
    "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n",
  ),
  stlBytes(corner),
  plyBytes(true),
  plyBytes(false),
  Buffer.from(
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
  ),
  glb({ positions: corner, indices: [0, 1, 2] }),
  glb({ positions: corner, nodes: [{ children: [1] }, { mesh: 0, rotation: [0, 0, 1, 0] }] }),
];

/** Whether an answer is one that a wrong request may have. */
function checkAnswer(status: number, type: string, text: string, what: string): void {
  assert.ok(status !== 500 && status < 505, `${status} ${text}\nof ${what}`);
  if (status < 400) return;
  assert.match(type, /^application\/problem\+json/, what);
  const told = JSON.parse(text) as { reason: string; status: number; detail: string };
  assert.equal(told.status, status);
  assert.match(told.reason, /^[A-Z_]+$/);
  assert.ok(told.detail.length > 0, what);
}

test("readers of files", { timeout }, async () => {
  const dice = new Dice(seed);
  let good = 0;
  for (let i = 0; i < 2000 * rounds; i++) {
    const bytes = dice.below(8) === 0 ? made(dice) : bentBytes(dice.of(files), dice);
    const name = dice.of(["", "a.obj", "a.stl", "a.ply", "a.glb", "a"]);
    try {
      const { vertices, triangles } = await readSurface(bytes, name, {
        vertices: 100,
        triangles: 100,
      });
      assert.ok(vertices.every(Number.isFinite));
      assert.ok(triangles.length > 0 && triangles.length % 3 === 0 && triangles.length <= 300);
      assert.ok(triangles.every((index) => 3 * index < vertices.length));
      good++;
    } catch (error) {
      if (!(error instanceof FileFault))
        throw new Error(`${bytes.toString("base64")} as ${name}`, { cause: error });
      // What is told never brings a terminal out of order.
      // eslint-disable-next-line no-control-regex
      assert.doesNotMatch(error.message, /[\u0000-\u001f\u007f]/, bytes.toString("base64"));
    }
  }
  assert.ok(good > 10, `only ${good} could be read`);
});

test("bodies of every route", { timeout }, () =>
  onStage(
    async ({ url }) => {
      const session = await puppet(url, 4);
      const at = `/v1/sessions/${session}`;
      const surface = plain(grid(3, 3, (x, y) => (x * y) / 4));
      const handle = {
        id: "a",
        vertex: 2,
        weight: 10,
        hard: false,
        areaRadius: 0.5,
        outside: "snap",
        depth: 1,
      };
      const routes: [string, string, Json][] = [
        [
          "POST",
          "/v1/flatten",
          {
            mesh: surface,
            method: "arap_face",
            energy: { basis: "face", weights: "cotangent", rigidity: Array(8).fill(1) },
            anchors: "spectral",
            refine: 3,
            refineStop: 1e-3,
            seamEdges: [4, 5],
            autoCut: true,
            pins: [{ vertex: 1, u: 0, v: 0, weight: 1 }],
            repair: { weld: true, tolerance: 1e-6 },
          },
        ],
        [
          "POST",
          "/v1/flatten",
          {
            mesh: surface,
            injective: true,
            grainLines: [{ fromVertex: 0, toVertex: 2, angleDegrees: 30 }],
            drawings: [
              { format: "svg", paper: "A4", allowance: 5, corners: "round", sheetWidth: 500 },
              { format: "dxf", notches: true },
              { format: "pdf", plain: true },
            ],
            parts: [{ firstTriangle: 0, name: "x" }],
            surfaceKey: "k",
            includeMesh: true,
          },
        ],
        ["POST", "/v1/jobs", { mesh: surface, drawings: [{ format: "svg" }] }],
        [
          "POST",
          "/v1/outlines",
          {
            outlines: [
              [0, 0, 10, 0, 10, 10, 0, 10],
              [2, 2, 2, 4, 4, 4],
            ],
            vertices: 50,
          },
        ],
        ["POST", "/v1/sessions", { ttlSeconds: 60, labels: { a: "b" } }],
        [
          "POST",
          `${at}/meshes`,
          {
            id: "n",
            mesh: plain(grid(3, 3)),
            energy: { basis: "vertex" },
            repair: { stitch: true },
          },
        ],
        [
          "POST",
          `${at}/handle-sets`,
          {
            id: "g",
            meshId: "m",
            handles: [handle, { id: "b", triangle: 0, barycentric: [0.2, 0.3, 0.5] }],
          },
        ],
        ["PATCH", `${at}/handle-sets/h`, { remove: [], add: [handle] }],
        [
          "POST",
          `${at}/handle-sets/h/deform`,
          {
            targets: [
              { id: "l", x: 0, y: 0 },
              { id: "r", x: 3, y: 1, angle: 1, scale: 2 },
            ],
            pickPoints: [0, 0],
            refine: 1,
            mode: "similarity",
            vertexSubset: [0, 1],
          },
        ],
      ];
      const dice = new Dice(seed);
      const statuses = new Map<number, number>();
      const send = async (method: string, path: string, init: RequestInit): Promise<void> => {
        const response = await fetch(`${url}${path}`, { method, ...init });
        const text = await response.text();
        const sent = typeof init.body === "string" ? init.body.slice(0, 2000) : "a form";
        checkAnswer(
          response.status,
          response.headers.get("content-type") ?? "",
          text,
          `${method} ${path} ${sent}`,
        );
        statuses.set(response.status, (statuses.get(response.status) ?? 0) + 1);
      };
      const accepts = [
        "*/*",
        "application/json",
        "image/svg+xml",
        "application/pdf",
        "model/obj",
        "image/*;q=0.5",
        ",;q=,",
        "text/html",
      ];
      for (let i = 0; i < 300 * rounds; i++) {
        const [method, path, body] = dice.of(routes);
        const text =
          dice.below(12) === 0
            ? JSON.stringify(body).slice(0, dice.below(200))
            : JSON.stringify(dice.below(20) === 0 ? body : bent(body, dice));
        const type =
          dice.below(20) === 0
            ? dice.of([
                "text/plain",
                "multipart/form-data; boundary=x",
                "application/json; charset=utf-16",
                "",
              ])
            : "application/json";
        await send(method, path, {
          body: text,
          headers: { "content-type": type, accept: dice.of(accepts) },
        });
      }
      for (let i = 0; i < 100 * rounds; i++) {
        const form = new FormData();
        form.append(
          dice.below(12) === 0 ? "datei" : "file",
          new Blob([bentBytes(dice.of(files), dice)]),
          dice.of(["a.obj", "a.stl", "a.glb", "\u202e.ply", ""]),
        );
        if (dice.below(2) === 0)
          form.append(
            "request",
            JSON.stringify(bent({ autoCut: true, refine: 2, pins: [] }, dice)),
          );
        await send("POST", dice.of(["/v1/surfaces", "/v1/flatten", "/v1/jobs"]), {
          body: form,
          headers: { accept: dice.of(accepts) },
        });
      }
      const methods = ["GET", "DELETE", "PATCH", "PUT", "HEAD", "POST"];
      const ends = [
        "",
        "/result",
        "/events",
        "/meshes/m",
        "/handle-sets/h",
        "/handle-sets/h/deform",
        "/stream",
        "?a=b",
        "//",
      ];
      for (let i = 0; i < 200 * rounds; i++) {
        const name = encodeURIComponent(
          dice.of([...oddTexts, "x".repeat(300)]).replace("\u0000", "%00"),
        );
        const root = dice.of([
          "/v1/sessions/",
          "/v1/jobs/",
          "/problems/",
          "/v1/",
          "/",
          "/docs/",
          `${at}/meshes/`,
          `${at}/handle-sets/`,
        ]);
        const path = `${root}${dice.below(8) === 0 ? "%" : name}${dice.of(ends)}`;
        const method = dice.of(methods);
        const response = await fetch(`${url}${path}`, { method });
        const text = await response.text();
        if (method !== "HEAD")
          checkAnswer(
            response.status,
            response.headers.get("content-type") ?? "",
            text,
            `${method} ${path}`,
          );
        assert.notEqual(response.status, 500);
      }
      assert.ok(
        [...statuses.keys()].some((status) => status < 300) &&
          statuses.has(400) &&
          statuses.has(422),
        JSON.stringify([...statuses]),
      );
      await json(`${url}/v1/info`);
    },
    { maxRequestsPerMinute: 1e9, maxJobsPerUser: 100 },
  ),
);

test("messages of a stream", { timeout }, () =>
  onStage(
    async ({ url }) => {
      const session = await puppet(url, 4);
      const dice = new Dice(seed);
      const messages: Json[] = [
        {
          type: "update",
          sequence: 5,
          targets: [{ id: "r", x: 3, y: 1, angle: 0.1, scale: 1.1 }],
          pickPoints: [0, 0],
        },
        { type: "update", positions: [0, 0, 3, 1] },
        { type: "edit", sequence: 6, remove: ["l"], add: [{ id: "t", vertex: 15 }] },
        { type: "ping", nonce: 3 },
        { type: "seen", sequence: 4 },
      ];
      for (let round = 0; round < 20 * rounds; round++) {
        const page = await Page.connect(url, session);
        const open = {
          type: "open",
          handleSet: "h",
          encoding: "int16",
          delivery: "latest",
          window: 1,
          mode: "rigid",
          refine: 1,
        };
        page.say(dice.below(4) === 0 ? bent(open, dice) : open);
        for (let i = 0; i < 20; i++) {
          const message = dice.of(messages);
          const text = JSON.stringify(dice.below(5) === 0 ? message : bent(message, dice));
          page.socket.send(
            dice.below(30) === 0
              ? Buffer.from(text)
              : dice.below(15) === 0
                ? text.slice(0, dice.below(text.length))
                : text,
          );
        }
        if (dice.below(4) === 0) {
          page.socket.terminate();
          continue;
        }
        page.say({ type: "seen", sequence: 4294967295 });
        page.say({ type: "close" });
        for (let heard = await page.next(); ; heard = await page.next()) {
          if (heard.kind === "frame") {
            assert.ok(heard.frame.positions.every(Number.isFinite));
            page.say({ type: "seen", sequence: heard.frame.sequence });
          }
          if (heard.kind === "text" && "problem" in heard.message) {
            const { status, reason } = heard.message.problem;
            assert.ok(status !== 500 || reason === "NUMERICAL", JSON.stringify(heard.message));
          }
          if (heard.kind !== "closed") continue;
          assert.match(String(heard.code), /^(1000|44\d\d|45(0[1-9]|\d\d))$/);
          break;
        }
      }
      // All is as it was.
      const page = await Page.connect(url, session);
      page.say({ type: "open", handleSet: "h" });
      await page.text("opened");
      page.say(move(3, 1));
      assert.equal((await page.frame()).sequence, 1);
      page.socket.close();
    },
    { maxMessagesPerSecond: 1e9, maxRequestsPerMinute: 1e9, maxSocketsPerUser: 1000 },
  ),
);

test("upgrades", { timeout }, () =>
  onStage(async ({ url }) => {
    const dice = new Dice(seed);
    for (let i = 0; i < 50 * rounds; i++) {
      const session = dice.of([...oddTexts, "%", "a/b"]).replace("\u0000", "%00");
      const headers: Record<string, string> = {
        connection: "upgrade",
        upgrade: dice.of(["websocket", "h2c", "WebSocket"]),
        ...(dice.below(3) > 0 && {
          "sec-websocket-key": dice.of(["dGhlIHNhbXBsZSBub25jZQ==", "x", ""]),
        }),
        ...(dice.below(3) > 0 && { "sec-websocket-version": dice.of(["13", "8", "a"]) }),
        ...(dice.below(3) === 0 && {
          "sec-websocket-protocol": dice.of(["arapd.v1", "a, a", ",", "other"]),
        }),
      };
      const { request } = await import("node:http");
      const path = dice.of([
        `/v1/sessions/${encodeURI(session)}/stream`,
        "/v1/flatten",
        "/",
        `/v1/sessions/${session.length}/stream?x`,
      ]);
      await new Promise<void>((resolve, reject) => {
        const asked = request(`${url}${path}`, { headers });
        asked.on("upgrade", (_, socket) => {
          socket.destroy();
          resolve();
        });
        asked.on("response", (response) => {
          response.resume();
          if (response.statusCode === 500) reject(new Error(`500 of ${path}`));
          response.on("end", resolve);
        });
        asked.on("error", reject);
        asked.end();
      });
    }
    assert.equal((await ask(`${url}/healthz`)).status, 200);
  }),
);
