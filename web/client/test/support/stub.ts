// A server that says what a test tells it to, made of the interface as it is declared.
import { join } from "node:path";

import { Metadata, Server, ServerCredentials, loadPackageDefinition, status } from "@grpc/grpc-js";
import type {
  ServerDuplexStream,
  ServerWritableStream,
  ServiceDefinition,
  UntypedHandleCall,
  sendUnaryData,
  ServerUnaryCall,
} from "@grpc/grpc-js";
import { loadSync } from "@grpc/proto-loader";
import type { MessageTypeDefinition } from "@grpc/proto-loader";

import { Client } from "@arapd/client";

const definitions = loadSync(
  [
    "arap/v1/deformation_service.proto",
    "arap/v1/flattening_service.proto",
    "google/rpc/status.proto",
    "google/rpc/error_details.proto",
  ],
  {
    includeDirs: [join(process.cwd(), "../../proto")],
    longs: Number,
    enums: String,
    defaults: true,
    oneofs: true,
  },
);
loadPackageDefinition(definitions);

// What a test says and hears is as loose as the wire.
// eslint-disable-next-line @typescript-eslint/no-explicit-any
export type Message = any;
export type Stream = ServerDuplexStream<Message, Message>;
export type Unary = (
  call: ServerUnaryCall<Message, Message>,
  answer: sendUnaryData<Message>,
) => void;
export type Pieces = (call: ServerWritableStream<Message, Message>) => void;

const bytes = (name: string, message: object): Buffer =>
  (definitions[name] as MessageTypeDefinition<object, object>).serialize(message);
export const flattenResponse = (message: object): Buffer =>
  bytes("arap.v1.FlattenResponse", message);

/** An error as arapd sends it. */
export function fault(code: number, message: string, reason?: string, retryMs?: number) {
  const metadata = new Metadata();
  const any = (name: string, value: object) => ({
    type_url: `type.googleapis.com/${name}`,
    value: bytes(name, value),
  });
  const details = [
    ...(reason ? [any("google.rpc.ErrorInfo", { reason, domain: "arapd" })] : []),
    ...(retryMs
      ? [
          any("google.rpc.RetryInfo", {
            retryDelay: { seconds: Math.floor(retryMs / 1000), nanos: (retryMs % 1000) * 1e6 },
          }),
        ]
      : []),
  ];
  if (details.length > 0)
    metadata.set("grpc-status-details-bin", bytes("google.rpc.Status", { code, message, details }));
  return { code, details: message, metadata };
}
export const gone = () => fault(status.UNAVAILABLE, "The server is going away.");

/**
 * Answers sessions, meshes and handle sets as asked; `handlers` take the place of that, by the
 * names of the calls.
 */
export async function pretend<T>(
  handlers: Record<string, UntypedHandleCall>,
  use: (client: Client, address: string) => Promise<T>,
): Promise<T> {
  const server = new Server();
  const usual: Record<string, Unary> = {
    CreateSession: (call, answer) =>
      answer(null, { session: { sessionId: call.request.sessionId } }),
    RegisterMesh: ({ request }, answer) => {
      const { vertices, triangles } = request.mesh;
      const mesh = {
        meshId: request.meshId,
        vertexCount: vertices.length / 2,
        triangleCount: triangles.length / 3,
      };
      answer(null, { mesh });
    },
    CompileHandles: ({ request }, answer) => answer(null, { handleSet: setOf(request) }),
  };
  for (const name of ["arap.v1.DeformationService", "arap.v1.FlatteningService"]) {
    const service = definitions[name] as ServiceDefinition;
    const known = Object.entries({ ...usual, ...handlers }).filter(([method]) => method in service);
    server.addService(service, Object.fromEntries(known));
  }
  const port = await new Promise<number>((resolve, reject) =>
    server.bindAsync("127.0.0.1:0", ServerCredentials.createInsecure(), (error, bound) =>
      error ? reject(error) : resolve(bound),
    ),
  );
  const address = `127.0.0.1:${port}`;
  const client = Client.connect(address);
  try {
    return await use(client, address);
  } finally {
    client.close();
    server.forceShutdown();
  }
}

const setOf = (request: Message) => ({
  handleSetId: request.handleSetId,
  meshId: request.meshId,
  revision: 1,
  handles: request.handles.map((handle: Message) => ({
    handleId: handle.handleId,
    rest: { x: 0, y: 0 },
  })),
});

/** The set of `handles` that a stream opens with. */
export const opened = (...handles: string[]) => ({
  opened: {
    handleSet: setOf({
      handleSetId: "h",
      meshId: "m",
      handles: handles.map((handleId) => ({ handleId })),
    }),
  },
});

/** A shape of the square of four vertices. */
export const shape = (sequence: number, more: object = {}) => ({
  shape: {
    sequence,
    positions: [0, 0, 1, 0, 1, 1, 0, 1],
    meanStretch: 1,
    maxStretch: 1,
    handleSetRevision: 1,
    ...more,
  },
});
export const square = { vertices: [0, 0, 1, 0, 1, 1, 0, 1], triangles: [0, 1, 2, 0, 2, 3] };
