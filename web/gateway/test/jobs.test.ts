// Jobs: watched to their end, fetched, cancelled, and cancelled by who leaves.
import assert from "node:assert/strict";
import { test } from "node:test";

import { eventsOf } from "./support/events.js";
import type { SentEvent } from "./support/events.js";
import { ask, form, json, onStage, problem } from "./support/gateway.js";
import type { Json } from "./support/gateway.js";
import { Document } from "./support/openapi.js";
import { grid, long, plain } from "./support/puppet.js";

const timeout = 120_000;
const bowl = { mesh: plain(grid(6, 6, (x, y) => (x * x + y * y) / 40)) };

async function watched(url: string): Promise<SentEvent[]> {
  const response = await ask(`${url}/events`);
  assert.equal(response.headers.get("content-type"), "text/event-stream; charset=utf-8");
  const events: SentEvent[] = [];
  for await (const event of eventsOf(response)) events.push(event);
  return events;
}

test("a job is what flattening at once is", { timeout }, () =>
  onStage(async ({ url }) => {
    const document = new Document(await json(`${url}/openapi.json`));
    const drawings = [{ format: "svg" }, { format: "pdf", plain: true }];
    const submitted = await ask(`${url}/v1/jobs`, { body: { ...bowl, drawings } });
    assert.equal(submitted.status, 202);
    const { id } = (await submitted.json()) as { id: string };
    const at = `${url}${submitted.headers.get("location")}`;
    assert.equal(at, `${url}/v1/jobs/${id}`);
    const events = await watched(at);
    const [last, end] = events.slice(-2);
    assert.deepEqual(
      [last!.event, last!.data.state, last!.data.id, end!.event],
      ["job", "done", id, "end"],
    );
    assert.deepEqual(end!.data, {});
    for (const { data } of events.slice(0, -1)) document.check("GET", "/v1/jobs/{job}", 200, data);
    assert.equal((await json(at)).state, "done");

    const once = await ask(`${url}/v1/flatten`, { body: { ...bowl, drawings } });
    const result = await ask(`${at}/result`);
    assert.equal(await result.text(), await once.text());
    const tag = result.headers.get("etag")!;
    assert.equal((await ask(`${at}/result`, { headers: { "if-none-match": tag } })).status, 304);
    const pdf = await ask(`${at}/result`, { headers: { accept: "application/pdf" } });
    const direct = await ask(`${url}/v1/flatten`, {
      body: { ...bowl, drawings },
      headers: { accept: "application/pdf" },
    });
    assert.deepEqual(await pdf.arrayBuffer(), await direct.arrayBuffer());
    assert.notEqual(pdf.headers.get("etag"), tag);
    assert.match(
      await (await ask(`${at}/result`, { headers: { accept: "model/obj" } })).text(),
      /^v 0 0 0\n/,
    );
    await problem(`${at}/result`, { headers: { accept: "image/vnd.dxf" } }, "NOT_ACCEPTABLE");

    // Asked after its end the events are the last one and the end.
    assert.deepEqual(
      (await watched(at)).map(({ event }) => event),
      ["job", "end"],
    );
    assert.equal((await json(at, { method: "DELETE" })).state, "done");
    await problem(at, {}, "NOT_FOUND");
  }),
);

test("an uploaded file as a job, and one that fails", { timeout }, () =>
  onStage(async ({ url }) => {
    const tetrahedron =
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\nfrob\n";
    const { id } = await json(
      `${url}/v1/jobs`,
      { body: form("a.obj", tetrahedron, { autoCut: true }) },
      202,
    );
    assert.equal((await watched(`${url}/v1/jobs/${id}`)).at(-2)!.data.state, "done");
    const layout = await json(`${url}/v1/jobs/${id}/result`);
    assert.equal(layout.fileWarnings[0].kind, "unknown_statements");
    assert.ok(layout.autoCutCount > 0);

    // What is wrong is told at once, or when it is found.
    const closed = await ask(`${url}/v1/jobs`, { body: form("a.obj", tetrahedron) });
    const told = (await closed.json()) as Json;
    if (closed.status === 202) {
      const events = await watched(`${url}/v1/jobs/${told.id}`);
      const end = events.at(-1)!;
      assert.deepEqual(
        [events.at(-2)!.data.state, end.event, end.data.reason],
        ["failed", "end", "NOT_A_DISK"],
      );
      assert.deepEqual(end.data.elements, [0]);
      await problem(`${url}/v1/jobs/${told.id}/result`, {}, "NOT_A_DISK");
    } else {
      assert.equal(told.reason, "NOT_A_DISK");
    }
    await problem(
      `${url}/v1/jobs`,
      { body: { ...bowl, drawings: [{ format: "svg", millimetresPerUnit: -1 }] } },
      "INVALID_OPTION",
    );
  }),
);

/** The state of a job, or that it is gone. */
async function stateOf(url: string, id: string): Promise<string> {
  const response = await ask(`${url}/v1/jobs/${id}`);
  return response.ok ? ((await response.json()) as { state: string }).state : "gone";
}

test("a job is cancelled, and its result is told to be none", { timeout }, () =>
  onStage(async ({ url, client }) => {
    const { id } = await json(`${url}/v1/jobs`, { body: long }, 202);
    const at = `${url}/v1/jobs/${id}`;
    await problem(`${at}/result`, {}, "JOB_NOT_DONE");
    const response = await ask(`${at}/events`);
    const events = eventsOf(response);
    assert.equal((await events.next()).value!.event, "job");
    assert.equal((await json(at, { method: "DELETE" })).state, "cancelled");
    const rest: SentEvent[] = [];
    for await (const event of events) rest.push(event);
    assert.deepEqual([rest.at(-2)!.data.state, rest.at(-1)!.event], ["cancelled", "end"]);
    assert.equal(await stateOf(url, id), "gone");
    // Nothing of it is left on the server either.
    assert.equal((await client.listSessions()).sessions.length, 0);
  }),
);

test("who leaves, cancels; whoever watches, does not", { timeout }, () =>
  onStage(
    async ({ url, client }) => {
      const submit = async (): Promise<string> =>
        (await json(`${url}/v1/jobs`, { body: long }, 202)).id;
      const stop = new AbortController();
      const watch = async (id: string): Promise<AsyncGenerator<SentEvent> | undefined> => {
        const response = await ask(`${url}/v1/jobs/${id}/events`, { signal: stop.signal });
        const events = eventsOf(response);
        const { state } = (await events.next()).value!.data as { state: string };
        return state === "cancelled" ? undefined : events;
      };
      // On a slow machine patience may be over before anybody comes.
      let id = await submit();
      let events = await watch(id);
      while (!events) events = await watch((id = await submit()));
      // Another one that nobody watches is begun after that and cancelled: so long has passed.
      const other = await submit();
      while ((await client.listSessions()).sessions.length > 1);
      await problem(`${url}/v1/jobs/${other}/result`, {}, "CANCELLED");
      assert.match(await stateOf(url, id), /^(waiting|running)$/);
      stop.abort();
      await assert.rejects(async () => {
        for (;;) if ((await events.next()).done) return;
      });
      // Nobody asks any more, and the session goes with the job.
      while ((await client.listSessions()).sessions.length > 0);
      assert.equal(await stateOf(url, id), "cancelled");
    },
    { jobPatienceMs: 200, maxJobsPerUser: 200 },
  ),
);

test("who hangs up cancels the work of a request", { timeout }, () =>
  onStage(
    async ({ url }) => {
      const stop = new AbortController();
      const left = ask(`${url}/v1/flatten`, { body: long, signal: stop.signal });
      setTimeout(() => stop.abort(), 300);
      await assert.rejects(left);
      // The one worker is free: the next is done long before the first would have been.
      await json(`${url}/v1/flatten`, { body: bowl });
    },
    {},
    ["--store", "memory", "--job-workers", "1"],
  ),
);

test("jobs have limits, and those that ended make room", { timeout }, () =>
  onStage(
    async ({ url }) => {
      const submit = async (): Promise<string> =>
        (await json(`${url}/v1/jobs`, { body: bowl }, 202)).id;
      const first = await submit();
      await watched(`${url}/v1/jobs/${first}`);
      const second = await submit();
      await watched(`${url}/v1/jobs/${second}`);
      const third = await submit();
      await watched(`${url}/v1/jobs/${third}`);
      assert.equal(await stateOf(url, first), "gone");
      assert.equal(await stateOf(url, third), "done");
      const running = (await json(`${url}/v1/jobs`, { body: long }, 202)).id;
      const other = (await json(`${url}/v1/jobs`, { body: long }, 202)).id;
      const told = await problem(`${url}/v1/jobs`, { body: bowl }, "RATE_LIMITED");
      assert.ok(told.retryAfterMs! > 0);
      for (const id of [running, other]) await json(`${url}/v1/jobs/${id}`, { method: "DELETE" });
      await submit();
    },
    { maxJobsPerUser: 2 },
  ),
);

test("jobs have a limit of memory", { timeout }, () =>
  onStage(
    async ({ url }) => void (await problem(`${url}/v1/jobs`, { body: long }, "RATE_LIMITED")),
    { maxJobBytes: 1000 },
  ),
);
