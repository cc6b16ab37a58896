// Inputs that are made up, of every route and of the stream: nothing but problems comes of them, no
// 500, and the gateway goes on. The same seed makes the same inputs; ARAP_WEB_SEED chooses another.
import assert from "node:assert/strict";
import { request } from "node:http";
import { test } from "node:test";

import { Dice, bent, bentBytes, files, oddTexts, seed } from "./support/dice.js";
import { ask, json, onStage } from "./support/gateway.js";
import type { Json } from "./support/gateway.js";
import { Page } from "./support/page.js";
import { grid, move, plain, puppet } from "./support/puppet.js";

const rounds = Number(process.env["ARAP_WEB_ROUNDS"] ?? 3);
const timeout = 240_000 + rounds * 60_000;

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
            tolerance: 0.1,
            expansion: 0.5,
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
        [
          "POST",
          `${at}/handle-sets/h/track`,
          {
            handles: ["l", "r"],
            frames: [
              { positions: [0, 0, 3, 1], angles: [0, 0], scales: [1, 1] },
              { positions: [0, 0, 3, 2] },
            ],
            refine: 1,
            boundaryOnly: true,
            encoding: "int16",
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
        "application/octet-stream",
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
