// Problems (RFC 9457): one table of everything that can be wrong, and what becomes of an error.
import { ArapError } from "@arapd/client";
import type { Reason } from "@arapd/client";

/** Reasons that the gateway gives itself. */
export type OwnReason =
  | "MALFORMED"
  | "FILE"
  | "UNKNOWN_USER"
  | "FORBIDDEN_ORIGIN"
  | "NO_SUCH_ROUTE"
  | "NOT_ACCEPTABLE"
  | "UNCHANGED"
  | "TOO_LARGE"
  | "UNSUPPORTED_MEDIA_TYPE"
  | "JOB_NOT_DONE"
  | "TOO_LATE"
  | "RATE_LIMITED"
  | "GATEWAY_BUSY";
export type ProblemReason = Reason | OwnReason;

interface Kind {
  status: number;
  title: string;
}
const kind = (status: number, title: string): Kind => ({ status, title });

/** docs/web.md has the same table; a test compares them. */
export const kinds: Readonly<Record<ProblemReason, Kind>> = {
  MALFORMED: kind(400, "The request is not what the schema says."),
  FILE: kind(422, "The file cannot be read."),
  UNKNOWN_USER: kind(401, "Nobody says who is asking."),
  FORBIDDEN_ORIGIN: kind(403, "A page of another site may not ask this."),
  NO_SUCH_ROUTE: kind(404, "There is nothing at this path for this method."),
  NOT_ACCEPTABLE: kind(406, "None of the media types of Accept can be answered."),
  UNCHANGED: kind(412, "The answer is the one that the caller has."),
  TOO_LARGE: kind(413, "The request is larger than the gateway takes."),
  UNSUPPORTED_MEDIA_TYPE: kind(415, "The body is neither JSON nor a form."),
  JOB_NOT_DONE: kind(409, "The job has no result yet."),
  TOO_LATE: kind(408, "The first message did not come in time."),
  RATE_LIMITED: kind(429, "Too much is asked for at once."),
  GATEWAY_BUSY: kind(503, "The gateway has no room, or is going away."),

  EMPTY_MESH: kind(422, "The mesh has no vertices or no triangles."),
  ARRAY_LENGTH: kind(422, "An array has a length that breaks its rule."),
  NON_FINITE_COORDINATE: kind(422, "A coordinate is not finite or too large."),
  INDEX_OUT_OF_RANGE: kind(422, "An index names what is not there."),
  REPEATED_INDEX: kind(422, "A triangle names one vertex twice."),
  DEGENERATE_TRIANGLE: kind(422, "A triangle has relatively no area."),
  DUPLICATE_TRIANGLE: kind(422, "Two triangles have the same vertices."),
  NON_MANIFOLD_EDGE: kind(422, "An edge has more than two triangles."),
  NON_MANIFOLD_VERTEX: kind(422, "Parts of the surface touch in a single vertex."),
  NOT_ORIENTABLE: kind(422, "The triangles cannot be oriented alike."),
  NOT_A_DISK: kind(422, "A piece of the surface has to be cut before it can be laid flat."),
  UNKNOWN_EDGE: kind(422, "A seam is no edge of the mesh."),
  NOT_INJECTIVE: kind(422, "No layout without a flipped triangle was reached."),
  INVALID_OPTION: kind(422, "An option is out of its range."),
  HANDLE_OUTSIDE: kind(422, "A handle lies outside the mesh."),
  DUPLICATE_HANDLE: kind(422, "Two handles have one id."),
  CONFLICTING_HANDLES: kind(422, "Hard handles contradict each other."),
  NON_FINITE_TARGET: kind(422, "A target is not finite."),
  TARGET_COUNT: kind(422, "The number of targets is wrong."),
  INVALID_NAME: kind(422, "An id is empty, too long, or has forbidden characters."),
  NOT_FOUND: kind(404, "There is no such session, mesh, handle set or job."),
  UNKNOWN_HANDLE: kind(404, "No handle has this id."),
  ALREADY_EXISTS: kind(409, "The id is taken by something different."),
  PROTOCOL: kind(409, "A message came out of order."),
  CANCELLED: kind(409, "The work was cancelled."),
  MESH_TOO_LARGE: kind(413, "The mesh is larger than the server takes."),
  TOO_MANY_HANDLES: kind(413, "There are more handles than the server takes."),
  LIMIT_EXCEEDED: kind(429, "A quota is used up."),
  PERMISSION_DENIED: kind(403, "The caller may not do this."),
  STREAM_IDLE: kind(408, "Nothing was said on a stream for too long."),
  NUMERICAL: kind(500, "The answer would not have been finite."),
  INTERNAL: kind(500, "Something is wrong on the server's side."),
  DATA_LOSS: kind(500, "What was stored is missing or damaged."),
  UNIMPLEMENTED: kind(501, "The server does not have this yet."),
  UNAUTHENTICATED: kind(502, "The server does not know the gateway."),
  OVERLOADED: kind(503, "The server has too much to do."),
  OUT_OF_MEMORY: kind(503, "The server had no memory for the work."),
  DRAINING: kind(503, "The server is going away, or nobody is there."),
  STORE_UNAVAILABLE: kind(503, "The server's store does not answer."),
  DEADLINE_EXCEEDED: kind(504, "The work took too long."),
};

export interface ProblemFacts {
  field?: string;
  elements?: readonly number[];
  details?: Readonly<Record<string, string>>;
  retryAfterMs?: number | undefined;
}

/** What is thrown for something that is wrong with a request. */
export class Problem extends Error {
  override readonly name = "Problem";
  readonly status: number;

  constructor(
    readonly reason: ProblemReason,
    message: string,
    readonly facts: ProblemFacts = {},
  ) {
    super(message);
    this.status = kinds[reason].status;
  }
}

/** A problem as it is told. */
export interface ProblemDetails {
  type: string;
  title: string;
  status: number;
  detail: string;
  reason: ProblemReason;
  field?: string;
  elements?: readonly number[];
  details?: Readonly<Record<string, string>>;
  retryAfterMs?: number;
  requestId?: string;
}

export const slugOf = (reason: string): string => reason.toLowerCase().replaceAll("_", "-");

/** The problem as JSON says it; empty facts are left out. */
export function detailsOf(problem: Problem, prefix: string, requestId?: string): ProblemDetails {
  const { field = "", elements = [], details = {}, retryAfterMs } = problem.facts;
  return {
    type: `${prefix}/problems/${slugOf(problem.reason)}`,
    title: kinds[problem.reason].title,
    status: problem.status,
    detail: problem.message,
    reason: problem.reason,
    ...(field !== "" && { field }),
    ...(elements.length > 0 && { elements }),
    ...(Object.keys(details).length > 0 && { details }),
    ...(retryAfterMs !== undefined && { retryAfterMs: Math.ceil(retryAfterMs) }),
    ...(requestId !== undefined && { requestId }),
  };
}

// What the wire calls otherwise than the JSON of the gateway.
const renamed: Readonly<Record<string, string>> = {
  handleId: "id",
  handleSetId: "id",
  sessionId: "session",
  includeFirstStep: "firstStep",
  includeSingularValues: "singularValues",
  includeFlippedIds: "flippedIds",
};
const leftOut = new Set(["options", "trianglePoint"]);

/** "handles[3].triangle_point.triangle" is "handles[3].triangle". */
export function pathOf(field: string, own: Readonly<Record<string, string>> = {}): string {
  const parts = field
    .split(".")
    .map((part) => part.replace(/_([a-z0-9])/g, (_, c: string) => c.toUpperCase()));
  return parts
    .filter((part, i) => !leftOut.has(part) || i === parts.length - 1)
    .map((part) => {
      const [name = "", ...rest] = part.split(/(?=\[)/);
      return [own[name] ?? renamed[name] ?? name, ...rest].join("");
    })
    .join(".");
}

interface FastifyFault {
  code?: unknown;
  statusCode?: unknown;
  message: string;
}
// The framework's own errors: by their codes where one status has several meanings.
function ofFramework(error: FastifyFault): Problem | undefined {
  const status = typeof error.statusCode === "number" ? error.statusCode : 500;
  const code = String(error.code ?? "");
  if (code.startsWith("FST_") && status === 415) {
    return new Problem(
      "UNSUPPORTED_MEDIA_TYPE",
      "The body has to be application/json or multipart/form-data.",
    );
  }
  if (status === 413) return new Problem("TOO_LARGE", `${sentence(error.message)}`);
  if (status === 404) return new Problem("NO_SUCH_ROUTE", "There is nothing at this path.");
  if (status >= 400 && status < 500) return new Problem("MALFORMED", sentence(error.message));
  return undefined;
}
const sentence = (text: string): string => (/[.!?]$/.test(text) ? text : `${text}.`);

/**
 * The problem that an error is; undefined for what nobody foresaw, which is INTERNAL and belongs in
 * the log.
 */
export function foreseen(
  error: unknown,
  fields: Readonly<Record<string, string>> = {},
): Problem | undefined {
  if (error instanceof Problem) return error;
  if (error instanceof ArapError) {
    const { reason, elements, details, field } = error;
    const { status } = kinds[reason];
    const retryAfterMs = error.retryAfter ?? (status === 503 ? 1000 : undefined);
    // What arapd says of the gateway's own identity is none of the page's business.
    const detail = reason === "UNAUTHENTICATED" ? kinds[reason].title : error.message;
    return new Problem(reason, detail || kinds[reason].title, {
      field: pathOf(field, fields),
      elements,
      details,
      retryAfterMs,
    });
  }
  if (error instanceof Error) return ofFramework(error as FastifyFault);
  return undefined;
}

export const unforeseen = (): Problem =>
  new Problem("INTERNAL", "Something is wrong in the gateway; its log says more.");
