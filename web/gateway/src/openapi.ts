// The OpenAPI document, made of the schemas of the routes, and a page to try it.
import swagger from "@fastify/swagger";
import swaggerUi from "@fastify/swagger-ui";
import type { FastifyInstance } from "fastify";

import { Problem } from "./schemas/base.js";
import { FlattenOptions, Layout } from "./schemas/flatten.js";
import { messages } from "./schemas/handles.js";

declare module "fastify" {
  interface FastifyContextConfig {
    /** What the document says of a body that the handler itself checks. */
    openapiBody?: object;
  }
}

const description =
  "As-rigid-as-possible deformation and flattening for the web. What is wrong is told as " +
  "application/problem+json. Live deformation is a WebSocket at /v1/sessions/{session}/stream, whose messages " +
  "are the schemas that begin with Stream; shapes come in binary, as docs/web.md says.";

/** Before the routes. */
export async function addOpenApi(app: FastifyInstance, prefix: string): Promise<void> {
  await app.register(swagger, {
    openapi: {
      openapi: "3.1.0",
      info: {
        title: "arapd gateway",
        version: "0.1.0",
        description,
        license: { name: "MIT", identifier: "MIT" },
      },
      tags: [{ name: "flattening" }, { name: "sessions" }, { name: "facts" }],
    },
    refResolver: {
      buildLocalReference: (json, _base, _fragment, i) =>
        typeof json["$id"] === "string" ? json["$id"] : `def-${i}`,
    },
    transform: ({ schema, url, route }) => {
      const body = (route.config as { openapiBody?: object } | undefined)?.openapiBody;
      return { schema: body ? { ...schema, body: { content: body } } : schema, url };
    },
  });
  for (const schema of [Problem, Layout, FlattenOptions]) app.addSchema(schema);
  for (const [name, schema] of Object.entries(messages)) {
    app.addSchema({ ...schema, $id: `Stream${name[0]!.toUpperCase()}${name.slice(1)}` });
  }
  await app.register(swaggerUi, {
    routePrefix: `${prefix}/docs`,
    uiConfig: { deepLinking: true, validatorUrl: null },
  });
  app.get(
    `${prefix}/openapi.json`,
    { schema: { hide: true }, config: { always: true } },
    async () => app.swagger(),
  );
}
