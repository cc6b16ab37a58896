// ArapError: what is wrong with a request, with the connection or with an answer.
import { status as codes } from "@grpc/grpc-js";
import type { Metadata } from "@grpc/grpc-js";

import type { ErrorReasonAnswer } from "./gen/arap/v1/ErrorReason.js";
import type { StatusAnswer } from "./gen/google/rpc/Status.js";
import { milliseconds, readBadRequest, readErrorInfo, readRetryInfo, readStatus } from "./wire.js";

type Named<T> = T extends `ERROR_REASON_${infer Name}` ? Exclude<Name, "UNSPECIFIED"> : never;
/** One name per thing that can go wrong; docs/protocol.md of arapd says when each comes. */
export type Reason = Named<ErrorReasonAnswer>;
/** The canonical code of gRPC that goes with it. */
export type Code = keyof typeof codes;

/** The facts of an {@link ArapError}. */
export interface Facts {
  reason: Reason;
  message: string;
  code?: Code;
  field?: string;
  elements?: readonly number[];
  details?: Readonly<Record<string, string>>;
  retryAfter?: number | undefined;
  unknownReason?: string;
}

/**
 * The only kind of error that the package throws or rejects with.
 *
 * Without an answer of the server the transport failed, and the reason is DRAINING (nobody there,
 * or the server is going away: connect again), OVERLOADED, DEADLINE_EXCEEDED, CANCELLED,
 * UNIMPLEMENTED or INTERNAL. INTERNAL is also an answer that does not fit what was asked for; its
 * sentence says so.
 */
export class ArapError extends Error {
  override readonly name = "ArapError";
  /** What is wrong. */
  readonly reason: Reason;
  /** The canonical code, "INTERNAL" or "INVALID_ARGUMENT" for what was found on this side. */
  readonly code: Code;
  /** The request field at fault in proto spelling ("handles[3].weight"), or empty. */
  readonly field: string;
  /** The first offending vertices, triangles or handles, counted from 0. */
  readonly elements: readonly number[];
  /** The values that the message mentions, by name. */
  readonly details: Readonly<Record<string, string>>;
  /** In how many milliseconds trying again helps; undefined when the same request fails again. */
  readonly retryAfter: number | undefined;
  /** The reason of a newer server that this version has no name for. */
  readonly unknownReason: string | undefined;
  /** What the server's logs call the call (x-request-id); not of streams. */
  requestId: string | undefined;

  constructor(facts: Facts) {
    super(facts.message);
    this.reason = facts.reason;
    this.code = facts.code ?? "INVALID_ARGUMENT";
    this.field = facts.field ?? "";
    this.elements = facts.elements ?? [];
    this.details = facts.details ?? {};
    this.retryAfter = facts.retryAfter;
    this.unknownReason = facts.unknownReason;
  }
}

/** An option or argument that cannot be sent. */
export const badOption = (field: string, message: string): ArapError =>
  new ArapError({ reason: "INVALID_OPTION", message, field });
/** An answer that does not fit what was asked for. */
export const badAnswer = (message: string): ArapError =>
  new ArapError({ reason: "INTERNAL", code: "INTERNAL", message });
export const cancelled = (message: string): ArapError =>
  new ArapError({ reason: "CANCELLED", code: "CANCELLED", message });
export const overdue = (message: string): ArapError =>
  new ArapError({ reason: "DEADLINE_EXCEEDED", code: "DEADLINE_EXCEEDED", message });
/** A call out of order. */
export const outOfOrder = (message: string): ArapError =>
  new ArapError({ reason: "PROTOCOL", code: "FAILED_PRECONDITION", message });

/** The end of a call, as gRPC tells it. */
export interface CallStatus {
  code: number;
  details: string;
  metadata: Metadata;
}

const known: ReadonlySet<string> = new Set(Object.keys(reasonsOfTable()));

// The compiler sees to it that none is missing and none is too many.
function reasonsOfTable(): Record<Reason, true> {
  return {
    EMPTY_MESH: true,
    ARRAY_LENGTH: true,
    NON_FINITE_COORDINATE: true,
    INDEX_OUT_OF_RANGE: true,
    REPEATED_INDEX: true,
    DEGENERATE_TRIANGLE: true,
    DUPLICATE_TRIANGLE: true,
    NON_MANIFOLD_EDGE: true,
    NON_MANIFOLD_VERTEX: true,
    NOT_ORIENTABLE: true,
    NOT_A_DISK: true,
    UNKNOWN_EDGE: true,
    NOT_INJECTIVE: true,
    MESH_TOO_LARGE: true,
    INVALID_OPTION: true,
    HANDLE_OUTSIDE: true,
    DUPLICATE_HANDLE: true,
    UNKNOWN_HANDLE: true,
    CONFLICTING_HANDLES: true,
    NON_FINITE_TARGET: true,
    TARGET_COUNT: true,
    TOO_MANY_HANDLES: true,
    INVALID_NAME: true,
    NOT_FOUND: true,
    ALREADY_EXISTS: true,
    PROTOCOL: true,
    LIMIT_EXCEEDED: true,
    OUT_OF_MEMORY: true,
    OVERLOADED: true,
    DRAINING: true,
    CANCELLED: true,
    DEADLINE_EXCEEDED: true,
    STREAM_IDLE: true,
    UNAUTHENTICATED: true,
    PERMISSION_DENIED: true,
    STORE_UNAVAILABLE: true,
    DATA_LOSS: true,
    UNIMPLEMENTED: true,
    NUMERICAL: true,
    INTERNAL: true,
  };
}
/** All reasons. */
export const reasons: readonly Reason[] = Object.keys(reasonsOfTable()) as Reason[];

const codeName = (code: number): Code => (codes[code] as Code | undefined) ?? "UNKNOWN";

// Of a status without a reason: the transport failed, or a proxy answered.
function reasonOfCode(code: number): Reason {
  switch (code) {
    case codes.UNAVAILABLE:
      return "DRAINING";
    case codes.RESOURCE_EXHAUSTED:
      return "OVERLOADED";
    case codes.DEADLINE_EXCEEDED:
      return "DEADLINE_EXCEEDED";
    case codes.CANCELLED:
      return "CANCELLED";
    case codes.UNIMPLEMENTED:
      return "UNIMPLEMENTED";
    default:
      return "INTERNAL";
  }
}

const idsOf = (text: string | undefined): number[] => (text?.match(/\d+/g) ?? []).map(Number);

/** The error of a status that is not OK. */
export function errorOf(status: StatusAnswer): ArapError {
  let reason = reasonOfCode(status.code);
  let metadata: Record<string, string> = {};
  let unknownReason: string | undefined;
  let field = "";
  let retryAfter: number | undefined;
  for (const detail of status.details) {
    switch (detail.type_url) {
      case "type.googleapis.com/google.rpc.ErrorInfo": {
        const info = readErrorInfo(detail.value);
        if (known.has(info.reason)) reason = info.reason as Reason;
        else unknownReason = info.reason;
        metadata = info.metadata;
        break;
      }
      case "type.googleapis.com/google.rpc.BadRequest":
        field = readBadRequest(detail.value).fieldViolations[0]?.field ?? "";
        break;
      case "type.googleapis.com/google.rpc.RetryInfo":
        retryAfter = milliseconds(readRetryInfo(detail.value).retryDelay);
        break;
    }
  }
  const { elements, ...details } = metadata;
  const facts: Facts = {
    reason,
    message: status.message,
    code: codeName(status.code),
    field,
    retryAfter,
    details,
  };
  facts.elements = idsOf(elements);
  if (unknownReason !== undefined) facts.unknownReason = unknownReason;
  return new ArapError(facts);
}

/** The error of a call that has ended badly. */
export function errorOfCall(status: CallStatus): ArapError {
  const [bytes] = status.metadata.get("grpc-status-details-bin");
  let told: StatusAnswer | undefined;
  try {
    if (bytes instanceof Buffer) told = readStatus(bytes);
  } catch {
    // Details that do not parse are a broken proxy's; the code and the message still count.
  }
  return errorOf({
    code: status.code,
    message: told?.message || status.details,
    details: told?.details ?? [],
  });
}

/**
 * Whether a call that ended so, and that we did not cancel, was lost and may do better elsewhere:
 * its server is gone or going away, or a proxy says so in its own words.
 */
export function isLost(status: CallStatus): boolean {
  switch (status.code) {
    case codes.UNAVAILABLE:
    case codes.CANCELLED:
      return true;
    case codes.UNKNOWN:
      return /No status (information )?received|Stream removed/.test(status.details);
    case codes.INTERNAL:
      // The second is grpc-js's own, of a message that was written while the connection went down.
      return /RST_STREAM|^Write error: /.test(status.details);
    default:
      return false;
  }
}

/** Whether there was no room, and later may be. */
export const isFull = (error: ArapError): boolean => error.code === "RESOURCE_EXHAUSTED";
