// Sessions, their meshes and handle sets, and shapes one by one.
import { Type } from "@sinclair/typebox";
import type { Static, TObject } from "@sinclair/typebox";
import type { FastifyInstance, FastifyReply, FastifyRequest } from "fastify";

import type { CallOptions, Handle, Session, Shape } from "@arapd/client";

import type { Context } from "../context.js";
import { calling } from "../context.js";
import { answers, closed, optional, parameters } from "../schemas/base.js";
import {
  DeformBody,
  EditBody,
  HandleSetBody,
  HandleSetInfo,
  ShapeAnswer,
} from "../schemas/handles.js";
import { MeshBody, MeshInfo, OutlineAnswer, OutlineBody } from "../schemas/mesh.js";

const SessionBody = closed({
  ttlSeconds: optional(
    Type.Number({
      exclusiveMinimum: 0,
      maximum: 1e9,
      description: "Life without use. Default 3600.",
    }),
  ),
  labels: optional(Type.Record(Type.String(), Type.String())),
});
const SessionInfo = Type.Object({
  id: Type.String(),
  createTime: Type.String({ format: "date-time" }),
  expireTime: Type.String({ format: "date-time" }),
  ttl: Type.Number({ description: "In milliseconds." }),
  labels: Type.Record(Type.String(), Type.String()),
  meshIds: Type.Array(Type.String()),
  handleSetIds: Type.Array(Type.String()),
});

const timed = (
  reply: FastifyReply,
  { queueMicros, solveMicros }: { queueMicros: number; solveMicros: number },
): void => {
  void reply.header(
    "server-timing",
    `queue;dur=${queueMicros / 1000}, solve;dur=${solveMicros / 1000}`,
  );
};
/** A shape as JSON. */
export function answerOf(shape: Shape): object {
  const { positions, vertices, measured, flippedCount, flippedIds } = shape;
  const { energy, meanStretch, maxStretch } = shape;
  const { worstHandleError, worstHandleId, picks, handleSetRevision } = shape;
  return {
    positions,
    vertices,
    measured,
    ...(measured && { flippedCount, flippedIds, energy, meanStretch, maxStretch }),
    worstHandleError,
    worstHandleId,
    picks,
    handleSetRevision,
  };
}
type Path = { session: string; mesh: string; handleSet: string };
const pathOf = (request: FastifyRequest): Path => request.params as Path;

export function sessionRoutes(app: FastifyInstance, context: Context): void {
  const inSession = <T>(
    request: FastifyRequest,
    reply: FastifyReply,
    use: (session: Session, call: CallOptions) => Promise<T>,
  ): Promise<T> =>
    calling(context, request, reply, (client, call) =>
      use(client.attachSession(pathOf(request).session), call),
    );
  const tags = ["sessions"];

  app.post(
    "/v1/sessions",
    {
      schema: {
        summary: "A session",
        tags,
        body: SessionBody,
        response: answers({ 201: SessionInfo }),
      },
    },
    async (request, reply) => {
      const { ttlSeconds, labels } = request.body as Static<typeof SessionBody>;
      const options = {
        ...(ttlSeconds !== undefined && { ttl: ttlSeconds * 1000 }),
        ...(labels && { labels }),
      };
      const info = await calling(context, request, reply, async (client, call) =>
        (await client.createSession(options, call)).get(call),
      );
      void reply.code(201).header("location", `${context.settings.prefix}/v1/sessions/${info.id}`);
      return info;
    },
  );
  app.get(
    "/v1/sessions/:session",
    {
      schema: {
        summary: "How a session stands",
        tags,
        params: parameters("session"),
        response: answers({ 200: SessionInfo }),
      },
    },
    (request, reply) => inSession(request, reply, (session, call) => session.get(call)),
  );
  app.delete(
    "/v1/sessions/:session",
    {
      schema: {
        summary: "Ends a session",
        tags,
        params: parameters("session"),
        response: answers({ 204: Type.Null() }),
      },
    },
    async (request, reply) => {
      await inSession(request, reply, (session, call) => session.delete(call));
      return reply.code(204).send();
    },
  );

  app.post(
    "/v1/sessions/:session/meshes",
    {
      schema: {
        summary: "Registers a mesh of the plane",
        tags,
        params: parameters("session"),
        body: MeshBody,
        response: answers({ 201: MeshInfo }),
      },
      config: { fields: { meshId: "id" } },
    },
    async (request, reply) => {
      const { mesh, ...options } = request.body as Static<typeof MeshBody>;
      const registered = await inSession(request, reply, (session, call) =>
        session.registerMesh(mesh, options, call),
      );
      timed(reply, registered);
      return reply.code(201).send(registered.mesh);
    },
  );
  app.get(
    "/v1/sessions/:session/meshes/:mesh",
    {
      schema: {
        summary: "A mesh of a session",
        tags,
        params: parameters("session", "mesh"),
        response: answers({ 200: MeshInfo }),
      },
    },
    (request, reply) =>
      inSession(request, reply, (session, call) => session.getMesh(pathOf(request).mesh, call)),
  );
  app.delete(
    "/v1/sessions/:session/meshes/:mesh",
    {
      schema: {
        summary: "Forgets a mesh and the handle sets on it",
        tags,
        params: parameters("session", "mesh"),
        response: answers({ 204: Type.Null() }),
      },
    },
    async (request, reply) => {
      await inSession(request, reply, (session, call) =>
        session.deleteMesh(pathOf(request).mesh, call),
      );
      return reply.code(204).send();
    },
  );

  app.post(
    "/v1/sessions/:session/handle-sets",
    {
      schema: {
        summary: "Compiles handles on a mesh",
        tags,
        params: parameters("session"),
        body: HandleSetBody,
        response: answers({ 201: HandleSetInfo }),
      },
    },
    async (request, reply) => {
      const { id, meshId, handles } = request.body as Static<typeof HandleSetBody>;
      const compiled = await inSession(request, reply, (session, call) =>
        session.compileHandles(id, meshId, handles as Handle[], call),
      );
      timed(reply, compiled);
      return reply.code(201).send(compiled.handleSet);
    },
  );
  const setPath = "/v1/sessions/:session/handle-sets/:handleSet";
  const setParameters: TObject = parameters("session", "handleSet");
  app.get(
    setPath,
    {
      schema: {
        summary: "A handle set",
        tags,
        params: setParameters,
        response: answers({ 200: HandleSetInfo }),
      },
    },
    (request, reply) =>
      inSession(request, reply, (session, call) =>
        session.getHandleSet(pathOf(request).handleSet, call),
      ),
  );
  app.patch(
    setPath,
    {
      schema: {
        summary: "Removes and adds handles",
        tags,
        params: setParameters,
        body: EditBody,
        response: answers({ 200: HandleSetInfo }),
      },
    },
    async (request, reply) => {
      const { remove = [], add = [] } = request.body as Static<typeof EditBody>;
      const edited = await inSession(request, reply, (session, call) =>
        session.editHandles(pathOf(request).handleSet, remove, add as Handle[], call),
      );
      timed(reply, edited);
      return edited.handleSet;
    },
  );
  app.delete(
    setPath,
    {
      schema: {
        summary: "Forgets a handle set",
        tags,
        params: setParameters,
        response: answers({ 204: Type.Null() }),
      },
    },
    async (request, reply) => {
      await inSession(request, reply, (session, call) =>
        session.deleteHandleSet(pathOf(request).handleSet, call),
      );
      return reply.code(204).send();
    },
  );
  app.post(
    `${setPath}/deform`,
    {
      schema: {
        summary: "One shape, for a target of every handle",
        tags,
        params: setParameters,
        body: DeformBody,
        response: answers({ 200: ShapeAnswer }),
      },
    },
    async (request, reply) => {
      const { targets, ...options } = request.body as Static<typeof DeformBody>;
      const shape = await inSession(request, reply, (session, call) =>
        session.deform(
          pathOf(request).handleSet,
          targets,
          { ...options, relativeToOrigin: !options.float64 },
          call,
        ),
      );
      timed(reply, shape);
      return answerOf(shape);
    },
  );

  app.post(
    "/v1/outlines",
    {
      schema: {
        summary: "Outlines filled with triangles",
        tags,
        body: OutlineBody,
        response: answers({ 200: OutlineAnswer }),
      },
    },
    async (request, reply) => {
      const { outlines, ...options } = request.body as Static<typeof OutlineBody>;
      const filled = await calling(context, request, reply, (client, call) =>
        client.meshOutline(outlines, options, call),
      );
      timed(reply, filled);
      const { mesh, pieceCount, holeCount, smallestAngleDegrees, outlineError } = filled;
      return { mesh, pieceCount, holeCount, smallestAngleDegrees, outlineError };
    },
  );
}
