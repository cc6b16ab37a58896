// The interface of the server as the package sees it (scripts/protos.mjs): its methods, and the
// messages that come as bytes inside of others.
import { fileURLToPath } from "node:url";

import { loadSync } from "@grpc/proto-loader";
import type { AnyDefinition, MessageTypeDefinition, MethodDefinition } from "@grpc/proto-loader";

import type { DeformationServiceDefinition } from "./gen/arap/v1/DeformationService.js";
import type { FlattenResponseAnswer } from "./gen/arap/v1/FlattenResponse.js";
import type { FlatteningServiceDefinition } from "./gen/arap/v1/FlatteningService.js";
import type { ServerServiceDefinition } from "./gen/arap/v1/ServerService.js";
import type { BadRequestAnswer } from "./gen/google/rpc/BadRequest.js";
import type { ErrorInfoAnswer } from "./gen/google/rpc/ErrorInfo.js";
import type { RetryInfoAnswer } from "./gen/google/rpc/RetryInfo.js";
import type { StatusAnswer } from "./gen/google/rpc/Status.js";
import type { DurationAnswer } from "./gen/google/protobuf/Duration.js";
import type { TimestampAnswer } from "./gen/google/protobuf/Timestamp.js";

const loaded: Record<string, AnyDefinition | undefined> = loadSync(
  [
    "arap/v1/deformation_service.proto",
    "arap/v1/flattening_service.proto",
    "arap/v1/server_service.proto",
    "arap/v1/errors.proto",
    "google/rpc/status.proto",
    "google/rpc/error_details.proto",
  ],
  {
    includeDirs: [fileURLToPath(new URL("./proto/", import.meta.url))],
    longs: Number,
    enums: String,
    defaults: true,
    oneofs: true,
  },
);

/** What a call needs to know of its method. */
export type Method<Request, Answer> = Pick<
  MethodDefinition<Request, unknown, unknown, Answer & object>,
  "path" | "requestSerialize" | "responseDeserialize"
>;

const named = <T>(name: string): T => loaded[name] as T;
export const deformation = named<DeformationServiceDefinition>("arap.v1.DeformationService");
export const flattening = named<FlatteningServiceDefinition>("arap.v1.FlatteningService");
export const server = named<ServerServiceDefinition>("arap.v1.ServerService");

function reader<T extends object>(name: string): (bytes: Uint8Array) => T {
  const type = named<MessageTypeDefinition<object, T>>(name);
  return (bytes) => type.deserialize(Buffer.from(bytes.buffer, bytes.byteOffset, bytes.length));
}
export const readStatus = reader<StatusAnswer>("google.rpc.Status");
export const readErrorInfo = reader<ErrorInfoAnswer>("google.rpc.ErrorInfo");
export const readBadRequest = reader<BadRequestAnswer>("google.rpc.BadRequest");
export const readRetryInfo = reader<RetryInfoAnswer>("google.rpc.RetryInfo");
export const readFlattenResponse = reader<FlattenResponseAnswer>("arap.v1.FlattenResponse");

/** Milliseconds of a duration; 0 for none. */
export const milliseconds = (time: DurationAnswer | null | undefined): number =>
  time ? time.seconds * 1e3 + time.nanos / 1e6 : 0;
/** Microseconds of a duration; 0 for none. */
export const microseconds = (time: DurationAnswer | null | undefined): number =>
  milliseconds(time) * 1e3;
export const dateOf = (time: TimestampAnswer | null | undefined): Date =>
  new Date(time ? time.seconds * 1e3 + Math.floor(time.nanos / 1e6) : Number.NaN);
