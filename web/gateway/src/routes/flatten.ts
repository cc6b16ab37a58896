// Flattening: at once and as jobs; and files as JSON.
import type { FastifyInstance, FastifyReply, FastifyRequest } from "fastify";
import { Type } from "@sinclair/typebox";

import type { Context } from "../context.js";
import { calling, leaving } from "../context.js";
import { kindOf } from "../layout/accept.js";
import { answerOf } from "../layout/answer.js";
import type { Answer } from "../layout/answer.js";
import { drawingFor, names, questionOf, tagOf } from "../layout/question.js";
import type { Job } from "../jobs/job.js";
import { detailsOf, foreseen, Problem, unforeseen } from "../problems.js";
import { answers, parameters } from "../schemas/base.js";
import { FlattenBody, Job as JobSchema } from "../schemas/flatten.js";
import { SurfaceAnswer } from "../schemas/mesh.js";
import { toJson } from "../json.js";
import { inputOf, surfaceOf } from "../upload.js";

const file = {
  type: "string",
  contentMediaType: "application/octet-stream",
  description: "OBJ, PLY, STL or GLB.",
};
const form = (properties: object) => ({
  "multipart/form-data": {
    schema: { type: "object", required: ["file"], properties: { file, ...properties } },
  },
});
const layouts = {
  description: "The layout, as Accept says.",
  content: {
    "application/json": { schema: Type.Ref("Layout") },
    "image/svg+xml": { schema: Type.String() },
    "image/vnd.dxf": { schema: Type.String() },
    "application/pdf": { schema: Type.String({ contentMediaType: "application/pdf" }) },
    "model/obj": { schema: Type.String() },
  },
};
// What the OpenAPI document says of bodies that the handlers check themselves.
const flattenBody = {
  "application/json": { schema: FlattenBody },
  ...form({ request: { $ref: "#/components/schemas/FlattenOptions" } }),
};

function send(reply: FastifyReply, answer: Answer, tag: string): FastifyReply {
  const { mediaType, body, fileName, timing } = answer;
  void reply
    .header("etag", tag)
    .header("cache-control", "private, no-cache")
    .header("vary", "accept");
  void reply.header("server-timing", timing).type(mediaType);
  if (fileName) void reply.header("content-disposition", `inline; filename="${fileName}"`);
  return reply.send(body instanceof Buffer ? body : toJson(body));
}

export function flattenRoutes(app: FastifyInstance, context: Context): void {
  // Which version of arapd answers is part of what an answer is made of.
  const version = (request: FastifyRequest, reply: FastifyReply): Promise<string> =>
    calling(
      context,
      request,
      reply,
      async (client, call) => (await client.getServerInfo(call)).version,
    );

  app.post(
    "/v1/surfaces",
    {
      schema: {
        summary: "A file of a mesh as JSON; nothing is kept",
        tags: ["flattening"],
        response: answers({ 200: SurfaceAnswer }),
      },
      config: { openapiBody: form({}) },
    },
    async (request, reply) => {
      const { format, vertices, triangles, parts, warnings } = await surfaceOf(
        request,
        context,
        leaving(reply),
      );
      return { format, mesh: { vertices, triangles }, parts, warnings };
    },
  );

  app.post(
    "/v1/flatten",
    {
      schema: {
        summary: "A surface laid flat, at once",
        tags: ["flattening"],
        response: answers({ 200: layouts }),
      },
      config: { openapiBody: flattenBody },
    },
    async (request, reply) => {
      const kind = kindOf(request.headers.accept);
      const input = await inputOf(request, context, leaving(reply));
      const question = questionOf(kind, input);
      const tag = tagOf(question, await version(request, reply));
      void reply.header("etag", tag);
      if (names(request.headers["if-none-match"], tag)) {
        throw new Problem("UNCHANGED", "The layout is the one that the caller has.");
      }
      const flat = await calling(context, request, reply, (client, call) =>
        client.flatten(question.mesh, question.options, call),
      );
      return send(reply, answerOf(flat, question, input.warnings), tag);
    },
  );

  app.post(
    "/v1/jobs",
    {
      schema: {
        summary: "A surface to be laid flat, as a job",
        tags: ["flattening"],
        response: answers({ 202: JobSchema }),
      },
      config: { openapiBody: flattenBody },
    },
    async (request, reply) => {
      const input = await inputOf(request, context, leaving(reply));
      const job = await context.jobs.submit(
        request.caller,
        questionOf("json", input),
        input.warnings,
      );
      void reply.code(202).header("location", `${context.settings.prefix}/v1/jobs/${job.id}`);
      return job.state;
    },
  );

  const jobOf = (request: FastifyRequest): Job =>
    context.jobs.get(request.caller, (request.params as { job: string }).job);

  app.get(
    "/v1/jobs/:job",
    {
      schema: {
        summary: "How a job stands",
        tags: ["flattening"],
        params: parameters("job"),
        response: answers({ 200: JobSchema }),
      },
      config: { always: true },
    },
    async (request) => {
      const job = jobOf(request);
      job.touch();
      return job.state;
    },
  );

  app.delete(
    "/v1/jobs/:job",
    {
      schema: {
        summary: "Cancels a job, and forgets it",
        tags: ["flattening"],
        params: parameters("job"),
        response: answers({ 200: JobSchema }),
      },
      config: { always: true },
    },
    async (request) => {
      const job = jobOf(request);
      await context.jobs.cancel(job);
      return job.state;
    },
  );

  app.get(
    "/v1/jobs/:job/result",
    {
      schema: {
        summary: "The layout of a job that is done",
        tags: ["flattening"],
        params: parameters("job"),
        response: answers({ 200: layouts, 304: Type.Null({ description: "The caller has it." }) }),
      },
      config: { always: true },
    },
    async (request, reply) => {
      const kind = kindOf(request.headers.accept);
      const job = jobOf(request);
      const { drawings = [] } = job.question.options;
      const drawing = drawingFor(kind, drawings);
      if (kind !== "json" && kind !== "obj" && drawing < 0) {
        throw new Problem(
          "NOT_ACCEPTABLE",
          `The job has no drawing that is ${kind.toUpperCase()}.`,
        );
      }
      const question = { ...job.question, kind, drawing };
      const tag = tagOf(question, await version(request, reply));
      if (job.ended && job.failure === undefined && names(request.headers["if-none-match"], tag)) {
        return reply.code(304).header("etag", tag).send();
      }
      const flat = await job.result(leaving(reply));
      return send(reply, answerOf(flat, question, job.warnings), tag);
    },
  );

  app.get(
    "/v1/jobs/:job/events",
    {
      schema: {
        summary: "How a job stands, as server-sent events, until it has ended",
        tags: ["flattening"],
        params: parameters("job"),
        response: answers({
          200: {
            description: "Events `job`, then `end`.",
            content: { "text/event-stream": { schema: Type.String() } },
          },
        }),
      },
      config: { always: true },
    },
    (request, reply) => {
      const job = jobOf(request);
      streamEvents(reply, job, (failure) => {
        const problem = foreseen(failure) ?? unforeseen();
        context.metrics.problems.inc({ reason: problem.reason });
        return detailsOf(problem, context.settings.prefix, request.id);
      });
    },
  );
}

const heartbeatMs = 15_000;

// A reader that does not read misses changes, never the end.
function streamEvents(
  reply: FastifyReply,
  job: Job,
  problemOf: (failure: unknown) => object,
): void {
  reply.hijack();
  const { raw } = reply;
  for (const [name, value] of Object.entries(reply.getHeaders()))
    if (value !== undefined) raw.setHeader(name, value);
  raw.writeHead(200, {
    "content-type": "text/event-stream; charset=utf-8",
    "cache-control": "no-store",
    "x-accel-buffering": "no",
  });
  const say = (event: string, data: object): void => {
    raw.write(`event: ${event}\ndata: ${toJson(data)}\n\n`);
  };
  const beat = setInterval(() => {
    if (!raw.writableNeedDrain) raw.write(":\n\n");
  }, heartbeatMs).unref();
  const tell = (): void => {
    if (!job.ended && raw.writableNeedDrain) return;
    say("job", job.state);
    if (!job.ended) return;
    say("end", job.state.state === "failed" ? problemOf(job.failure) : {});
    raw.end();
  };
  const unwatch = job.watch(tell);
  raw.once("close", () => {
    clearInterval(beat);
    unwatch();
  });
  tell();
}
