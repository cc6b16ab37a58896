// Tracks: all shapes of a motion, one after the other as they are computed.
import { Readable } from "node:stream";

import { Type } from "@sinclair/typebox";
import type { Static } from "@sinclair/typebox";
import type { FastifyInstance, FastifyReply } from "fastify";

import type { Shape, ShapeOptions } from "@arapd/client";

import { callOf, leaving } from "../context.js";
import type { Context } from "../context.js";
import { bodyOfTrack, isTrackFile } from "../files/track.js";
import { toJson } from "../json.js";
import { acceptedOf } from "../layout/accept.js";
import { Problem, detailsOf, foreseen, unforeseen } from "../problems.js";
import { answers, parameters } from "../schemas/base.js";
import { TrackBody, TrackFile } from "../schemas/handles.js";
import { frameOf, lastFrameOf } from "../stream/frame.js";
import { check } from "../validate.js";
import { answerOf } from "./sessions.js";

const mediaTypes = [
  ["application/x-ndjson", "lines"],
  ["application/octet-stream", "frames"],
] as const;
/** Who takes nothing for so long is cut off. */
const patienceMs = 60_000;
// What bytes of a track may wait for the network.
const mostWaiting = 256 << 10;

/** How shapes, and a problem after them, are written. */
interface Writer {
  shape(shape: Shape): Buffer;
  problem(sequence: number, problem: object): Buffer;
}
const line = (value: object): Buffer => Buffer.from(`${toJson(value)}\n`);
const writers: Record<"lines" | "frames", Writer> = {
  lines: {
    shape: (shape) => line({ frame: shape.sequence, ...answerOf(shape) }),
    problem: (frame, problem) => line({ frame, problem }),
  },
  frames: { shape: (shape) => frameOf(shape, 0, 0), problem: lastFrameOf },
};

export function trackRoutes(app: FastifyInstance, context: Context): void {
  app.post(
    "/v1/sessions/:session/handle-sets/:handleSet/track",
    {
      schema: {
        summary: "All shapes of a motion, in order",
        tags: ["sessions"],
        params: parameters("session", "handleSet"),
        body: { anyOf: [TrackBody, TrackFile] },
        response: answers({
          200: {
            description:
              "A JSON object per line, a shape with its `frame`; or frames as docs/web.md lays them out, one behind the other. " +
              "When a later one fails, the last one has a `problem`.",
            content: {
              "application/x-ndjson": { schema: Type.String() },
              "application/octet-stream": { schema: Type.String({ format: "binary" }) },
            },
          },
        }),
      },
      config: { fields: { handleIds: "handles", anglesRadians: "angles" } },
      // Which of both it is to be says more of what is wrong than that it is neither.
      validatorCompiler:
        ({ schema, httpPart }) =>
        (value: unknown) => {
          try {
            if (httpPart === "body") check(isTrackFile(value) ? TrackFile : TrackBody, value);
            else check(schema as object, value, `The ${httpPart}`);
            return { value };
          } catch (error) {
            return { error: error as Error };
          }
        },
    },
    async (request, reply) => {
      const { params, headers, body } = request;
      const { session, handleSet } = params as { session: string; handleSet: string };
      const asked = isTrackFile(body) ? bodyOfTrack(body) : (body as Static<typeof TrackBody>);
      const { handles, frames, encoding, ...options } = asked;
      const kind = acceptedOf(headers.accept, mediaTypes);
      if (kind === "frames" && options.float64) {
        const field = { field: "float64" };
        throw new Problem("MALFORMED", "Binary frames have no double precision.", field);
      }
      const shapeOptions: ShapeOptions = {
        ...options,
        ...(kind === "frames" && { encoding: encoding === "int16" ? "int16_le" : "float32_le" }),
        relativeToOrigin: !options.float64,
      };
      const lease = context.connections.lease(request.caller.owner);
      let shapes: AsyncGenerator<Shape>;
      let first: IteratorResult<Shape>;
      try {
        shapes = lease.client
          .attachSession(session)
          .deformTrack(handleSet, handles, frames, shapeOptions, callOf(request, leaving(reply)));
        first = await shapes.next();
      } catch (error) {
        lease.release();
        throw error;
      }
      const tell = (error: unknown): object => {
        const known = foreseen(error, request.routeOptions.config.fields);
        if (!known) request.log.error({ err: error }, "unforeseen");
        const problem = known ?? unforeseen();
        context.metrics.problems.inc({ reason: problem.reason });
        return detailsOf(problem, context.settings.prefix, request.id);
      };
      const chunks = written(shapes, first, writers[kind], reply, tell);
      const stream = Readable.from(chunks, { objectMode: false, highWaterMark: mostWaiting });
      stream.once("close", () => lease.release());
      const [type] = mediaTypes.find(([, one]) => one === kind)!;
      return reply.type(type).header("cache-control", "no-store").send(stream);
    },
  );
}

async function* written(
  shapes: AsyncGenerator<Shape>,
  first: IteratorResult<Shape>,
  writer: Writer,
  reply: FastifyReply,
  tell: (error: unknown) => object,
): AsyncGenerator<Buffer> {
  let next = 0;
  const giveUp = (): void => void reply.raw.destroy();
  try {
    for (let one = first; !one.done; one = await shapes.next()) {
      const stalled = setTimeout(giveUp, patienceMs);
      try {
        yield writer.shape(one.value);
      } finally {
        clearTimeout(stalled);
      }
      next++;
    }
  } catch (error) {
    if (!reply.raw.destroyed) yield writer.problem(next, tell(error));
  } finally {
    await shapes.return(undefined);
  }
}
