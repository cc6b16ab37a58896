// The OpenAPI document and the page to try it.
import assert from "node:assert/strict";
import { test } from "node:test";

import { Validator } from "@seriousme/openapi-schema-validator";

import { ask, hold, json } from "./support/gateway.js";

const timeout = 60_000;

test("the document is valid, and has every route", { timeout }, () =>
  hold({ arapd: "unix:/nowhere" }, async (url, gateway) => {
    const document = await json(`${url}/openapi.json`);
    assert.deepEqual(document, JSON.parse(JSON.stringify(gateway.openapi())));
    assert.equal(document.openapi, "3.1.0");
    const { valid, errors } = await new Validator().validate(structuredClone(document));
    assert.ok(valid, JSON.stringify(errors, null, 1));
    const routes = Object.entries(document.paths as Record<string, object>).flatMap(
      ([path, methods]) => Object.keys(methods).map((method) => `${method.toUpperCase()} ${path}`),
    );
    assert.deepEqual(routes.sort(), [
      "DELETE /v1/jobs/{job}",
      "DELETE /v1/sessions/{session}",
      "DELETE /v1/sessions/{session}/handle-sets/{handleSet}",
      "DELETE /v1/sessions/{session}/meshes/{mesh}",
      "GET /problems/{name}",
      "GET /v1/info",
      "GET /v1/jobs/{job}",
      "GET /v1/jobs/{job}/events",
      "GET /v1/jobs/{job}/result",
      "GET /v1/load",
      "GET /v1/sessions/{session}",
      "GET /v1/sessions/{session}/handle-sets/{handleSet}",
      "GET /v1/sessions/{session}/meshes/{mesh}",
      "PATCH /v1/sessions/{session}/handle-sets/{handleSet}",
      "POST /v1/flatten",
      "POST /v1/jobs",
      "POST /v1/outlines",
      "POST /v1/sessions",
      "POST /v1/sessions/{session}/handle-sets",
      "POST /v1/sessions/{session}/handle-sets/{handleSet}/deform",
      "POST /v1/sessions/{session}/handle-sets/{handleSet}/track",
      "POST /v1/sessions/{session}/meshes",
      "POST /v1/surfaces",
    ]);
    for (const methods of Object.values(
      document.paths as Record<
        string,
        Record<string, { responses: Record<string, object>; summary: string }>
      >,
    )) {
      for (const { responses, summary } of Object.values(methods)) {
        assert.ok(responses["default"], summary);
        assert.ok(summary.length > 3);
      }
    }
    const bodies = document.paths["/v1/flatten"].post.requestBody.content;
    assert.deepEqual(Object.keys(bodies).sort(), ["application/json", "multipart/form-data"]);
    for (const name of [
      "Problem",
      "Layout",
      "FlattenOptions",
      "StreamOpen",
      "StreamUpdate",
      "StreamEdit",
      "StreamPing",
      "StreamSeen",
      "StreamClose",
    ]) {
      assert.ok(document.components.schemas[name], name);
    }
  }),
);

test("the page to try it asks nobody else for anything", { timeout }, () =>
  hold({ arapd: "unix:/nowhere", prefix: "/a" }, async (url) => {
    const page = await ask(`${url}/a/docs/`);
    assert.equal(page.status, 200);
    const text = await page.text();
    const used = [...text.matchAll(/(?:src|href)="([^"]+)"/g)].map(([, path]) => path!);
    assert.ok(used.length >= 3);
    for (const path of used) {
      const at = new URL(path, `${url}/a/docs/`);
      assert.equal(at.origin, url, path);
      assert.equal((await ask(at.href)).status, 200, path);
    }
    // No script stands in the page itself, so the policy lets none.
    assert.doesNotMatch(text, /<script(?![^>]*\bsrc=)[^>]*>\s*\S/);
    assert.match(page.headers.get("content-security-policy") ?? "", /default-src 'self'/);
    assert.doesNotMatch(page.headers.get("content-security-policy") ?? "", /script-src|https?:/);
    assert.equal((await json(`${url}/a/docs/json`)).openapi, "3.1.0");
  }),
);
