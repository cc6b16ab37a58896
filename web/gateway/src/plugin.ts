// The gateway as a plugin of somebody else's Fastify application.
import type { FastifyPluginAsync } from "fastify";

import { createGateway } from "./gateway.js";
import type { GatewayOptions } from "./options.js";

/**
 * `await app.register(gateway, { prefix: "/arapd", arapd: "localhost:50051" })`. The application's
 * own onRequest hooks run first; everything else is the gateway's. Its sockets are taken from the
 * application's server; those for other paths are left alone.
 */
export const gateway: FastifyPluginAsync<GatewayOptions> = async (app, options) => {
  const inner = await createGateway({ logger: app.log, ...options, prefix: app.prefix });
  // The gateway reads its bodies itself.
  app.removeAllContentTypeParsers();
  app.addContentTypeParser("*", (_request, _payload, done) => done(null));
  app.all("/*", {
    onRequest: async (request, reply) => {
      reply.hijack();
      // A socket that a plugin of the application has routed here is taken over below.
      if (request.headers.upgrade === undefined) inner.handle(request.raw, reply.raw);
    },
    handler: async () => {},
  });
  app.server.on("upgrade", (request, socket, head) => {
    if (inner.owns(request)) inner.upgrade(request, socket, head);
    else if (app.server.listenerCount("upgrade") === 1)
      socket.end("HTTP/1.1 404 Not Found\r\nConnection: close\r\n\r\n");
  });
  app.addHook("preClose", () => inner.close());
};
