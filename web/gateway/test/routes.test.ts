// Every route, compared with what the Node client gets from the same server, and with the OpenAPI
// document of the gateway.
import assert from "node:assert/strict";
import { test } from "node:test";

import { ask, form, json, onStage } from "./support/gateway.js";
import type { Json } from "./support/gateway.js";
import { Document } from "./support/openapi.js";
import { grid, plain, puppet } from "./support/puppet.js";

const timeout = 120_000;
const bowl = grid(6, 5, (x, y) => (x * x + y * y) / 40);
const body = { mesh: plain(bowl) };

test("what the server is", { timeout }, () =>
  onStage(async ({ url, client }) => {
    const document = new Document(await json(`${url}/openapi.json`));
    const info = await json(`${url}/v1/info`);
    document.check("GET", "/v1/info", 200, info);
    const { gateway, ...server } = info;
    assert.deepEqual(server, await client.getServerInfo());
    assert.equal(gateway.maxBodyBytes, 32 << 20);
    assert.deepEqual(await json(`${url}/healthz`), { status: "ok" });
    assert.deepEqual(await json(`${url}/readyz`), { status: "ok" });
  }),
);

test("a session with its meshes, handle sets and shapes", { timeout }, () =>
  onStage(async ({ url, client }) => {
    const document = new Document(await json(`${url}/openapi.json`));
    const asked = async (
      method: string,
      path: string,
      status: number,
      answered: string,
      sent?: object,
    ) => {
      const answer = await json(`${url}${path}`, { method, ...(sent && { body: sent }) }, status);
      document.check(method, answered, status, answer);
      return answer;
    };
    const session = await asked("POST", "/v1/sessions", 201, "/v1/sessions", {
      ttlSeconds: 60,
      labels: { of: "test" },
    });
    assert.match(session.id, /^[0-9a-f]{32}$/);
    assert.equal(session.ttl, 60_000);
    const at = `/v1/sessions/${session.id}`;
    const own = client.attachSession(session.id);

    const sheet = {
      id: "m",
      mesh: plain(grid(5, 5)),
      energy: { basis: "face" },
      repair: { weld: true },
    };
    const mesh = await asked("POST", `${at}/meshes`, 201, "/v1/sessions/{session}/meshes", sheet);
    const { warnings: _, ...info } = await own.getMesh("m");
    assert.deepEqual({ ...mesh, warnings: undefined }, { ...info, warnings: undefined });
    assert.deepEqual(
      await asked("GET", `${at}/meshes/m`, 200, "/v1/sessions/{session}/meshes/{mesh}"),
      mesh,
    );

    const handles = [
      { id: "a", vertex: 0, hard: true },
      { id: "b", triangle: 3, barycentric: [0.2, 0.3, 0.5] },
      {
        id: "c",
        position: [4.2, 4],
        outside: "snap",
        oriented: true,
        weight: 10,
        areaRadius: 0.5,
        depth: 1,
        depthFalloff: 2,
      },
    ];
    const setPath = "/v1/sessions/{session}/handle-sets/{handleSet}";
    const set = await asked(
      "POST",
      `${at}/handle-sets`,
      201,
      "/v1/sessions/{session}/handle-sets",
      { id: "h", meshId: "m", handles },
    );
    assert.deepEqual(
      set.handles.map((handle: Json) => handle.id),
      ["a", "b", "c"],
    );
    assert.equal(set.handles[2].snappedDistance > 0.19, true);
    assert.deepEqual(await asked("GET", `${at}/handle-sets/h`, 200, setPath), set);
    const edited = await asked("PATCH", `${at}/handle-sets/h`, 200, setPath, {
      remove: ["b"],
      add: [{ id: "d", vertex: 4 }],
    });
    assert.equal(edited.revision, set.revision + 1);

    const targets = [
      { id: "a", x: 0, y: 1 },
      { id: "c", x: 4, y: 3, angle: 0.2, scale: 1.1 },
      { id: "d", x: 5, y: 0 },
    ];
    for (const options of [
      {},
      { refine: 2, mode: "similarity", flippedIds: true, float64: true },
      { boundaryOnly: true },
    ] as const) {
      const shape = await asked("POST", `${at}/handle-sets/h/deform`, 200, `${setPath}/deform`, {
        targets,
        pickPoints: [0, 1, 99, 99],
        ...options,
      });
      const expected = await own.deform("h", targets, {
        ...options,
        relativeToOrigin: true,
        pickPoints: [0, 1, 99, 99],
      });
      const farthest = Math.max(
        ...shape.positions.map((x: number, i: number) => Math.abs(x - expected.positions[i]!)),
      );
      assert.ok(shape.positions.length === expected.positions.length && farthest < 1e-12);
      assert.deepEqual(shape.vertices, expected.vertices && Array.from(expected.vertices));
      assert.deepEqual(shape.picks, expected.picks);
      assert.equal(shape.picks[1], null);
      assert.equal(shape.energy, expected.energy);
    }

    const standing = await asked("GET", at, 200, "/v1/sessions/{session}");
    assert.deepEqual([standing.meshIds, standing.handleSetIds], [["m"], ["h"]]);
    for (const path of [`${at}/handle-sets/h`, `${at}/meshes/m`, at]) {
      assert.equal((await ask(`${url}${path}`, { method: "DELETE" })).status, 204);
      assert.equal((await ask(`${url}${path}`)).status, 404);
    }
  }),
);

test("outlines filled with triangles", { timeout }, () =>
  onStage(async ({ url, client }) => {
    const document = new Document(await json(`${url}/openapi.json`));
    const outlines = [
      [0, 0, 20, 0, 20, 10, 0, 10],
      [5, 3, 5, 6, 9, 6, 9, 3],
    ];
    const filled = await json(`${url}/v1/outlines`, { body: { outlines, vertices: 200 } });
    document.check("POST", "/v1/outlines", 200, filled);
    const { mesh, holeCount } = await client.meshOutline(outlines, 200);
    assert.deepEqual(filled.mesh, plain(mesh));
    assert.equal(filled.holeCount, holeCount);
    assert.equal(filled.outlineError, 0);
    const options = { vertices: 200, tolerance: 0.1, expansion: 2 };
    const grown = await json(`${url}/v1/outlines`, { body: { outlines, ...options } });
    document.check("POST", "/v1/outlines", 200, grown);
    assert.deepEqual(grown.mesh, plain((await client.meshOutline(outlines, options)).mesh));
    assert.equal(grown.holeCount, 0);
  }),
);

test("a layout in every format", { timeout }, () =>
  onStage(async ({ url, client }) => {
    const document = new Document(await json(`${url}/openapi.json`));
    const expected = await client.flatten(bowl, {
      float64: true,
      singularValues: true,
      firstStep: true,
    });
    const layout = await json(`${url}/v1/flatten`, {
      body: {
        ...body,
        float64: true,
        singularValues: true,
        firstStep: true,
        drawings: [{ format: "svg", paper: "A4", millimetresPerUnit: 60 }],
      },
    });
    document.check("POST", "/v1/flatten", 200, layout);
    const whole = ["uv", "uvVertex", "cornerUv", "firstStepUv", "triangleChart"] as const;
    for (const name of whole) assert.deepEqual(layout[name], Array.from(expected[name]), name);
    assert.deepEqual(layout.singularValues.map(Math.fround), Array.from(expected.singularValues));
    assert.deepEqual(layout.distortion, expected.distortion);
    assert.deepEqual(
      layout.charts[0].loops,
      expected.charts[0]!.loops.map((loop) => Array.from(loop)),
    );
    assert.equal(layout.charts[0].refineEnd, expected.charts[0]!.refineEnd);
    const [{ format, mediaType, files }] = layout.drawings;
    assert.deepEqual([format, mediaType, files[0].page], ["svg", "image/svg+xml", "cover"]);
    assert.match(Buffer.from(files[1].data, "base64").toString(), /^<\?xml|^<svg/);
    assert.equal(layout.mesh, undefined);

    const drawings = [
      { format: "pdf", plain: true } as const,
      { format: "dxf", millimetresPerUnit: 10 } as const,
    ];
    const direct = await client.flatten(bowl, { drawings });
    const file = async (accept: string, sent: object = { ...body, drawings }) => {
      const response = await ask(`${url}/v1/flatten`, { body: sent, headers: { accept } });
      assert.equal(response.status, 200);
      assert.equal(response.headers.get("vary"), "accept");
      assert.match(
        response.headers.get("server-timing") ?? "",
        /^queue;dur=[\d.]+, solve;dur=[\d.]+$/,
      );
      return {
        type: response.headers.get("content-type"),
        bytes: Buffer.from(await response.arrayBuffer()),
      };
    };
    const pdf = await file("application/pdf");
    assert.equal(pdf.type, "application/pdf");
    assert.deepEqual(pdf.bytes, Buffer.from(direct.drawings[0]!.files[0]!.data));
    for (const accept of [
      "image/vnd.dxf",
      "application/dxf",
      "text/html, application/dxf;q=0.8, */*;q=0.1",
    ]) {
      const dxf = await file(accept);
      assert.equal(dxf.type, "image/vnd.dxf");
      assert.deepEqual(dxf.bytes, Buffer.from(direct.drawings[1]!.files[0]!.data));
    }
    const svg = await file("image/svg+xml");
    const withDefaults = await client.flatten(bowl, { drawings: [{ format: "svg" }] });
    assert.deepEqual(svg.bytes, Buffer.from(withDefaults.drawings[0]!.files[0]!.data));

    const obj = (
      await file("model/obj", { ...body, parts: [{ firstTriangle: 4, name: "bo\nwl" }] })
    ).bytes
      .toString()
      .split("\n");
    const lines = (keyword: string): string[] =>
      obj.filter((line) => line.startsWith(`${keyword} `));
    assert.equal(lines("v").length, 30);
    assert.equal(lines("vt").length, 30);
    assert.equal(lines("f").length, 40);
    assert.equal(obj[obj.indexOf("o bo_wl") - 1], lines("f")[3]);
    const flat = await client.flatten(bowl);
    assert.deepEqual(
      lines("vt")
        .map((line) => line.split(" ").slice(1).map(Number).map(Math.fround))
        .flat(),
      Array.from(flat.uv),
    );
  }),
);

test("the same request has the same bytes and a tag that saves the work", { timeout }, () =>
  onStage(async ({ url }) => {
    const once = await ask(`${url}/v1/flatten`, { body: { ...body, surfaceKey: "bowl" } });
    const tag = once.headers.get("etag") ?? "";
    assert.match(tag, /^"[\w-]{32}"$/);
    const again = await ask(`${url}/v1/flatten`, { body: { ...body, surfaceKey: "bowl" } });
    assert.equal(again.headers.get("etag"), tag);
    assert.match(again.headers.get("server-timing") ?? "", /surface-cached/);
    assert.equal(await again.text(), await once.text());
    const same = await ask(`${url}/v1/flatten`, {
      body,
      headers: { "if-none-match": `"x", ${tag}` },
    });
    assert.equal(same.status, 412);
    assert.equal(same.headers.get("etag"), tag);
    for (const other of [
      { body: { ...body, refine: 3 } },
      {
        body: {
          mesh: { ...body.mesh, vertices: body.mesh.vertices.map((x, i) => (i === 2 ? 0.5 : x)) },
        },
      },
      { body, headers: { accept: "model/obj" } },
    ]) {
      const response = await ask(`${url}/v1/flatten`, {
        ...other,
        headers: { ...other.headers, "if-none-match": tag },
      });
      assert.equal(response.status, 200);
      assert.notEqual(response.headers.get("etag"), tag);
    }
  }),
);

test("a file as JSON, and laid flat", { timeout }, () =>
  onStage(async ({ url, client }) => {
    const document = new Document(await json(`${url}/openapi.json`));
    const obj = "o sheet\nv 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 1\nf 1 2 3 4\n";
    const surface = await json(`${url}/v1/surfaces`, { body: form("a.obj", obj) });
    document.check("POST", "/v1/surfaces", 200, surface);
    assert.deepEqual(surface, {
      format: "obj",
      mesh: { vertices: [0, 0, 0, 2, 0, 0, 2, 1, 0, 0, 1, 1], triangles: [0, 1, 2, 0, 2, 3] },
      parts: [{ firstTriangle: 0, name: "sheet" }],
      warnings: [],
    });
    const layout = await json(`${url}/v1/flatten`, {
      body: form("a.obj", obj, { refine: 5, includeMesh: true }),
    });
    document.check("POST", "/v1/flatten", 200, layout);
    assert.deepEqual([layout.mesh, layout.parts], [surface.mesh, surface.parts]);
    assert.deepEqual(
      layout.cornerUv,
      Array.from((await client.flatten(surface.mesh, { refine: 5 })).cornerUv),
    );
    const doubted = await json(`${url}/v1/flatten`, { body: form("a.obj", `${obj}frob 1\n`) });
    assert.equal(doubted.fileWarnings[0].kind, "unknown_statements");
  }),
);

test("metrics of the gateway, without names of anybody", { timeout }, () =>
  onStage(async ({ url }) => {
    const session = await puppet(url);
    await ask(`${url}/v1/sessions/none`);
    const text = await (await ask(`${url}/metrics`)).text();
    for (const line of [
      'arapd_gateway_requests_total{route="/v1/sessions/:session",method="GET",status="404"} 1',
      'arapd_gateway_problems_total{reason="NOT_FOUND"} 1',
      'arapd_gateway_request_seconds_count{route="/v1/sessions"} 1',
      "arapd_gateway_sockets 0",
      "arapd_gateway_jobs 0",
      "arapd_gateway_connections 1",
      "arapd_gateway_shapes_total 0",
      "arapd_gateway_shapes_skipped_total 0",
      "arapd_gateway_resumed_total 0",
    ]) {
      assert.ok(text.split("\n").includes(line), `${line} is not in\n${text}`);
    }
    assert.ok(!text.includes(session));
  }),
);
