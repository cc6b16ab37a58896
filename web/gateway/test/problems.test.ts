// Problems: every one there is, made for real where a request can make it, and told alike in the
// table of docs/web.md.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";

import { reasons } from "@arapd/client";
import type { Reason } from "@arapd/client";
import { kinds } from "@arapd/gateway";
import type { ProblemReason } from "@arapd/gateway";
import { pathOf, slugOf } from "#gateway/problems.js";

import { fault, pretend } from "../../client/test/support/stub.js";
import type { Unary } from "../../client/test/support/stub.js";
import { ask, form, hold, json, onStage, problem } from "./support/gateway.js";
import type { Asked } from "./support/gateway.js";
import { grid, move, plain, puppet, drag } from "./support/puppet.js";

const timeout = 120_000;
const page = readFileSync(join(process.cwd(), "../../docs/web.md"), "utf8");
const sheet = { mesh: plain(grid(4, 4, () => 0)) };

test("docs/web.md has every problem once, with its status", () => {
  const told = new Map<string, number>();
  const table = /^\| status \| reason \|[\s\S]*?\n\n/m.exec(page)![0];
  for (const [, status, names] of table.matchAll(/^\| (\d{3}) \| ([^|]*) \|/gm)) {
    for (const [, reason] of names!.matchAll(/`([A-Z_]+)`/g)) {
      assert.ok(!told.has(reason!), `${reason} is there twice`);
      told.set(reason!, Number(status));
    }
  }
  assert.deepEqual(
    Object.fromEntries([...told].sort()),
    Object.fromEntries(
      Object.entries(kinds)
        .map(([reason, { status }]) => [reason, status] as const)
        .sort(),
    ),
  );
  for (const reason of reasons) assert.ok(kinds[reason], reason);
});

test("every problem has a page that says what it means", { timeout }, () =>
  hold({ arapd: "unix:/nowhere", prefix: "/a" }, async (url) => {
    for (const [reason, { status, title }] of Object.entries(kinds)) {
      assert.deepEqual(await json(`${url}/a/problems/${slugOf(reason)}`), {
        reason,
        status,
        title,
      });
    }
    const { type } = await problem(`${url}/a/problems/none`, {}, "NO_SUCH_ROUTE");
    assert.equal(type, "/a/problems/no-such-route");
    await json(`${url}${type}`);
  }),
);

const codes: Partial<Record<Reason, number>> = {
  NOT_FOUND: 5,
  ALREADY_EXISTS: 6,
  UNAUTHENTICATED: 16,
  DRAINING: 14,
};

test("every reason of arapd becomes its problem", { timeout }, async () => {
  let next: Reason = "INTERNAL";
  let retryMs: number | undefined;
  const GetSession: Unary = (_, answer) =>
    answer(fault(codes[next] ?? 3, `${next} it is.`, next, retryMs));
  await pretend({ GetSession }, async (_, address) => {
    await hold({ arapd: address }, async (url) => {
      for (next of reasons) {
        // What may be tried again is tried again by the gateway, for a while.
        if (["OVERLOADED", "DRAINING"].includes(next)) continue;
        const told = await problem(`${url}/v1/sessions/s`, {}, next);
        const { status, title } = kinds[next];
        assert.equal(told.status, status);
        assert.equal(told.title, title);
        assert.equal(told.type, `/problems/${slugOf(next)}`);
        // That the gateway's own token is wrong is told, and no more.
        assert.equal(told.detail, next === "UNAUTHENTICATED" ? title : `${next} it is.`);
        if (status !== 503) assert.equal(told.retryAfterMs, undefined);
      }
      [next, retryMs] = ["LIMIT_EXCEEDED", 3500];
      const response = await ask(`${url}/v1/sessions/s`);
      assert.equal(response.headers.get("retry-after"), "4");
      assert.equal(((await response.json()) as { retryAfterMs: number }).retryAfterMs, 3500);
      for (next of ["OVERLOADED", "DRAINING"] as const) {
        retryMs = 60_000; // longer than anybody waits
        const told = await problem(`${url}/v1/sessions/s`, {}, next);
        assert.equal(told.status, 503);
        assert.equal(told.retryAfterMs, 60_000);
      }
    });
  });
});

test("what the wire calls a field is what the JSON calls it", () => {
  for (const [wire, path] of [
    ["handles[3].weight", "handles[3].weight"],
    ["handles[3].triangle_point.barycentric", "handles[3].barycentric"],
    ["add[0].area_radius", "add[0].areaRadius"],
    ["options.vertex_subset", "vertexSubset"],
    ["drawings[1].millimetres_per_unit", "drawings[1].millimetresPerUnit"],
    ["handles[1].handle_id", "handles[1].id"],
    ["include_first_step", "firstStep"],
    ["handle_set_id", "id"],
    ["", ""],
  ] as const) {
    assert.equal(pathOf(wire), path);
  }
  assert.equal(pathOf("mesh_id", { meshId: "id" }), "id");
  assert.equal(pathOf("mesh_id"), "meshId");
});

const shared = [0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, -1, 0];
/** [reason, what the mesh is, where, which elements] */
const surfaces: [ProblemReason, { vertices: number[]; triangles: number[] }, number[]?][] = [
  ["EMPTY_MESH", { vertices: [], triangles: [] }],
  ["ARRAY_LENGTH", { vertices: [0, 0, 0, 1], triangles: [0, 0, 0] }],
  ["INDEX_OUT_OF_RANGE", { vertices: shared, triangles: [0, 1, 2, 0, 1, 9] }, [1]],
  ["REPEATED_INDEX", { vertices: shared, triangles: [0, 1, 1] }, [0]],
  ["DEGENERATE_TRIANGLE", { vertices: [0, 0, 0, 1, 0, 0, 2, 0, 0], triangles: [0, 1, 2] }, [0]],
  ["DUPLICATE_TRIANGLE", { vertices: shared, triangles: [0, 1, 2, 1, 2, 0] }, [0, 1]],
  ["NON_MANIFOLD_EDGE", { vertices: shared, triangles: [0, 1, 2, 1, 0, 3, 0, 1, 4] }],
  [
    "NOT_A_DISK",
    { vertices: shared.slice(0, 12), triangles: [0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2] },
    [0],
  ],
];

test("surfaces that cannot be laid flat", { timeout }, () =>
  onStage(async ({ url }) => {
    for (const [reason, mesh, elements] of surfaces) {
      const told = await problem(`${url}/v1/flatten`, { body: { mesh } }, reason);
      if (elements)
        assert.deepEqual(told.elements?.slice(0, elements.length), elements, JSON.stringify(told));
    }
    const wrong: [ProblemReason, object, string?][] = [
      ["UNKNOWN_EDGE", { seamEdges: [0, 15] }],
      [
        "INVALID_OPTION",
        { drawings: [{ format: "svg", overlap: 1e9, paper: "A4" }] },
        "drawings[0].overlap",
      ],
      ["INVALID_OPTION", { method: "lscm", energy: { basis: "edge" } }, "energy.basis"],
      ["INVALID_NAME", { surfaceKey: "no name" }, "surfaceKey"],
    ];
    for (const [reason, options, field] of wrong) {
      const accept = { headers: { accept: "application/json" } };
      const told = await problem(
        `${url}/v1/flatten`,
        { body: { ...sheet, ...options }, ...accept },
        reason,
      );
      if (field) assert.equal(told.field, field);
      assert.ok(told.detail.length > 10);
    }
  }),
);

test("what is wrong with sessions", { timeout }, () =>
  onStage(
    async ({ url }) => {
      const session = await puppet(url);
      const at = `${url}/v1/sessions/${session}`;
      const mesh = plain(grid(3, 3));
      const handle = { id: "a", vertex: 0 };
      const set = (handles: object[]): Asked => ({ body: { id: "x", meshId: "m", handles } });
      const cases: [ProblemReason, string, Asked, string?, number[]?][] = [
        ["NOT_FOUND", `${url}/v1/sessions/none`, {}],
        ["NOT_FOUND", `${at}/meshes/none`, {}],
        ["NOT_FOUND", `${at}/handle-sets/none`, { method: "DELETE" }],
        ["ALREADY_EXISTS", `${at}/meshes`, { body: { id: "m", mesh } }],
        ["INVALID_NAME", `${at}/meshes`, { body: { id: "no name", mesh } }, "id"],
        ["MESH_TOO_LARGE", `${at}/meshes`, { body: { mesh: plain(grid(12, 12)) } }],
        [
          "TOO_MANY_HANDLES",
          `${at}/handle-sets`,
          set([0, 1, 2, 3].map((vertex) => ({ id: `h${vertex}`, vertex }))),
        ],
        ["HANDLE_OUTSIDE", `${at}/handle-sets`, set([handle, { id: "b", position: [99, 0] }])],
        ["DUPLICATE_HANDLE", `${at}/handle-sets`, set([handle, { id: "a", vertex: 2 }])],
        [
          "INVALID_OPTION",
          `${at}/handle-sets`,
          set([handle, { id: "b", vertex: 3, weight: -1 }]),
          "handles[1].weight",
        ],
        ["INDEX_OUT_OF_RANGE", `${at}/handle-sets`, set([{ id: "b", vertex: 81 }])],
        ["UNKNOWN_HANDLE", `${at}/handle-sets/h`, { method: "PATCH", body: { remove: ["x"] } }],
        [
          "TARGET_COUNT",
          `${at}/handle-sets/h/deform`,
          { body: { targets: [{ id: "l", x: 0, y: 0 }] } },
        ],
        ["INVALID_OPTION", `${url}/v1/sessions`, { body: { ttlSeconds: 1e9 } }],
      ];
      for (const [reason, where, asked, field] of cases) {
        const told = await problem(where, asked, reason);
        if (field) assert.equal(told.field, field, JSON.stringify(told));
      }
      const hard = [0, 0].map((vertex, i) => ({ id: `h${i}`, vertex, hard: true }));
      await json(`${at}/handle-sets`, { body: { id: "hard", meshId: "m", handles: hard } }, 201);
      const targets = [0, 1].map((i) => ({ id: `h${i}`, x: i, y: 0 }));
      const told = await problem(
        `${at}/handle-sets/hard/deform`,
        { body: { targets } },
        "CONFLICTING_HANDLES",
      );
      assert.deepEqual([...told.elements!].sort(), [0, 1]);
      for (let i = 0; i < 2; i++) await json(`${url}/v1/sessions`, { body: {} }, 201);
      const quota = await problem(`${url}/v1/sessions`, { body: {} }, "LIMIT_EXCEEDED");
      assert.equal(quota.details?.["quota"], "max_sessions_per_owner");
      assert.ok(quota.retryAfterMs! > 0);
    },
    {},
    [
      "--store",
      "memory",
      "--max-vertices",
      "100",
      "--max-handles",
      "3",
      "--max-sessions-per-owner",
      "3",
    ],
  ),
);

test("requests that are none", { timeout }, () =>
  hold(
    { arapd: "unix:/nowhere", maxBodyBytes: 2000, maxFileBytes: 5000, maxFileVertices: 20 },
    async (url) => {
      const flatten = `${url}/v1/flatten`;
      const body = { mesh: { vertices: [0, 0, 0], triangles: [0, 0, 0] } };
      const raw = (text: string, type = "application/json"): Asked => ({
        body: text,
        headers: { "content-type": type },
      });
      const big = `v 0 0 0\n`.repeat(30);
      const cases: [ProblemReason, string, Asked, string?][] = [
        ["MALFORMED", flatten, raw("{")],
        ["MALFORMED", flatten, raw("")],
        ["MALFORMED", flatten, raw('{"__proto__": {}}')],
        ["MALFORMED", flatten, { body: {} }, "mesh"],
        ["MALFORMED", flatten, { body: { ...body, colour: "red" } }, "colour"],
        [
          "MALFORMED",
          flatten,
          { body: { mesh: { ...body.mesh, vertices: [0, "1"] } } },
          "mesh.vertices[1]",
        ],
        [
          "MALFORMED",
          flatten,
          raw('{"mesh": {"vertices": [0, 0, 1e999], "triangles": []}}'),
          "mesh.vertices[2]",
        ],
        [
          "MALFORMED",
          flatten,
          { body: { mesh: { ...body.mesh, triangles: [-1, 0, 0] } } },
          "mesh.triangles[0]",
        ],
        ["MALFORMED", flatten, { body: { ...body, method: "magic" } }, "method"],
        ["MALFORMED", flatten, { body: { ...body, "a/b~c": 1 } }, "a/b~c"],
        ["MALFORMED", `${url}/v1/sessions`, { method: "POST" }],
        [
          "MALFORMED",
          `${url}/v1/sessions/s/handle-sets`,
          { body: { id: "h", meshId: "m", handles: [{ id: "a" }] } },
          "handles[0]",
        ],
        [
          "MALFORMED",
          `${url}/v1/sessions/s/handle-sets`,
          { body: { id: "h", meshId: "m", handles: [{ id: "a", vertex: 0, position: [0, 0] }] } },
          "handles[0]",
        ],
        ["MALFORMED", flatten, raw("nothing", "multipart/form-data")],
        ["MALFORMED", flatten, raw("--x\r\nbroken", "multipart/form-data; boundary=x")],
        ["MALFORMED", flatten, { body: new FormData() }],
        ["MALFORMED", flatten, { body: form("a.obj", "v 0 0 0\n", { mesh: {} }) }, "mesh"],
        ["UNSUPPORTED_MEDIA_TYPE", flatten, raw("solid", "model/stl")],
        ["UNSUPPORTED_MEDIA_TYPE", flatten, raw("{}", "text/plain")],
        ["UNSUPPORTED_MEDIA_TYPE", `${url}/v1/surfaces`, { body: {} }],
        ["FILE", `${url}/v1/surfaces`, { body: form("a.obj", "v 0 0 x\n") }],
        ["FILE", `${url}/v1/surfaces`, { body: form("a.obj", "") }],
        ["TOO_LARGE", flatten, { body: { ...body, surfaceKey: "x".repeat(3000) } }],
        ["TOO_LARGE", `${url}/v1/surfaces`, { body: form("a.obj", " ".repeat(5001)) }],
        ["TOO_LARGE", `${url}/v1/surfaces`, { body: form("a.obj", big) }],
        ["NOT_ACCEPTABLE", flatten, { body, headers: { accept: "image/png" } }],
        ["NOT_ACCEPTABLE", flatten, { body, headers: { accept: "application/json;q=0" } }],
        [
          "NOT_ACCEPTABLE",
          flatten,
          {
            body: { ...body, drawings: [{ format: "svg", paper: "A4" }] },
            headers: { accept: "image/svg+xml" },
          },
        ],
        ["NO_SUCH_ROUTE", `${url}/v1/nothing`, {}],
        ["NO_SUCH_ROUTE", `${url}/v1/flatten`, { method: "PUT" }],
        ["NO_SUCH_ROUTE", `${url}/v1/sessions/s/stream`, {}],
        ["NOT_FOUND", `${url}/v1/jobs/none`, {}],
      ];
      for (const [reason, where, asked, field] of cases) {
        const told = await problem(where, asked, reason);
        if (field !== undefined) assert.equal(told.field, field, JSON.stringify(told));
      }
      const two = form("a.obj", "v 0 0 0\n");
      two.append("file", new Blob(["x"]), "b.obj");
      await problem(flatten, { body: two }, "MALFORMED");
      const other = form("a.obj", "v 0 0 0\n");
      other.append("colour", "red");
      await problem(flatten, { body: other }, "MALFORMED");
      const started = Date.now();
      // Nobody is there: the client library tries for a while, then it is told.
      const gone = await problem(`${url}/v1/info`, {}, "DRAINING");
      assert.equal(gone.retryAfterMs, 1000);
      assert.ok(Date.now() - started < 60_000);
      await problem(`${url}/readyz`, {}, "DRAINING");
    },
  ),
);

test("a stream tells what it cannot compute", { timeout }, () =>
  onStage(async ({ url }) => {
    const page = await drag(url, await puppet(url), { encoding: "int16" });
    page.say(move(1e300, 0));
    const { problem: told, sequence } = await page.text("error");
    assert.equal(told.reason, "NUMERICAL");
    assert.equal(sequence, 1);
    page.socket.close();
  }),
);
