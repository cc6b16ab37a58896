// The gateway's routes (docs/web.md) as far as the studio needs them.
import type { Body, Motion, Pin } from "../model/puppet.js";

/** What is wrong, as the gateway says it. */
export class Problem extends Error {
  constructor(
    readonly status: number,
    readonly reason: string,
    detail: string,
    readonly retryAfterMs?: number,
  ) {
    super(detail);
  }
  /** Nobody answers, or not now: trying again may help. */
  get passes(): boolean {
    return this.status === 0 || this.status === 429 || this.status === 502 || this.status >= 503;
  }
}

interface ProblemBody {
  status?: number;
  reason?: string;
  detail?: string;
  retryAfterMs?: number;
}

export const problemOf = (body: ProblemBody, status = 0): Problem =>
  new Problem(
    body.status ?? status,
    body.reason ?? "UNKNOWN",
    body.detail ?? `status ${status}`,
    body.retryAfterMs,
  );

export interface HandleSet {
  id: string;
  drawOrder: number[];
  revision: number;
  restingComponents: number;
}

export interface OutlineMesh {
  mesh: { vertices: number[]; triangles: number[] };
  pieceCount: number;
  holeCount: number;
  smallestAngleDegrees: number;
}

/** Under which address the gateway is: where the page is. */
export const addressOf = (path: string): URL => new URL(path, document.baseURI);

/** The answer to a request; what it has to say if it is wrong is a Problem. The body is JSON or a form. */
export async function send(
  method: string,
  path: string,
  body?: unknown,
  more: RequestInit = {},
): Promise<Response> {
  const isForm = body instanceof FormData;
  let response: Response;
  try {
    response = await fetch(addressOf(path), {
      method,
      ...more,
      ...(body !== undefined && {
        headers: { ...(!isForm && { "content-type": "application/json" }), ...more.headers },
        body: isForm ? body : JSON.stringify(body),
      }),
    });
  } catch (error) {
    if (more.signal?.aborted) throw error;
    throw new Problem(0, "UNREACHABLE", "");
  }
  if (!response.ok) {
    const problem = (await response.json().catch(() => ({}))) as ProblemBody;
    throw problemOf(problem, response.status);
  }
  return response;
}

async function ask<T>(method: string, path: string, body?: unknown): Promise<T> {
  const response = await send(method, path, body);
  return (response.status === 204 ? undefined : await response.json()) as T;
}

export const meshOutlines = (
  outlines: readonly (readonly number[])[],
  vertices: number,
): Promise<OutlineMesh> => ask("POST", "v1/outlines", { outlines, vertices });

export const createSession = (): Promise<{ id: string }> =>
  ask("POST", "v1/sessions", { ttlSeconds: 3600, labels: { app: "studio" } });

/** Goes out also while the page is being closed; nobody hears the answer. */
export const endSession = (session: string): void =>
  void fetch(addressOf(`v1/sessions/${session}`), { method: "DELETE", keepalive: true }).catch(
    () => {},
  );

export const registerMesh = (
  session: string,
  body: Body,
  motion: Motion,
  starch: Float32Array | null,
): Promise<{ id: string }> =>
  ask("POST", `v1/sessions/${session}/meshes`, {
    mesh: { vertices: [...body.rest], triangles: [...body.triangles] },
    energy: {
      basis: motion.basis,
      weights: motion.weights,
      ...(starch && { rigidity: [...starch] }),
    },
  }).then((answer) => meshIn(answer));

// The answer is the mesh, or has it beside the times.
const meshIn = (answer: unknown): { id: string } => {
  const { mesh } = answer as { mesh?: { id: string } };
  return mesh ?? (answer as { id: string });
};
const setIn = (answer: unknown): HandleSet => {
  const { handleSet } = answer as { handleSet?: HandleSet };
  return handleSet ?? (answer as HandleSet);
};

export const compileHandles = async (
  session: string,
  id: string,
  meshId: string,
  pins: readonly Pin[],
): Promise<HandleSet> =>
  setIn(
    await ask("POST", `v1/sessions/${session}/handle-sets`, {
      id,
      meshId,
      handles: pins.map(handleOf),
    }),
  );

export const deleteHandleSet = (session: string, id: string): Promise<void> =>
  ask("DELETE", `v1/sessions/${session}/handle-sets/${id}`);

export const deleteMesh = (session: string, id: string): Promise<void> =>
  ask("DELETE", `v1/sessions/${session}/meshes/${id}`);

/** A pin as a handle of the server. */
export const handleOf = (pin: Pin): Record<string, unknown> => ({
  id: pin.id,
  triangle: pin.hold.triangle,
  barycentric: pin.hold.weights,
  ...(pin.firmness === "exact" && { hard: true }),
  ...(pin.firmness === "soft" && { weight: pin.weight }),
  ...(pin.turns && { oriented: true }),
  ...(pin.area > 0 && { areaRadius: pin.area }),
  ...(pin.depth !== 0 && { depth: pin.depth }),
});

export const targetOf = (pin: Pin): Record<string, unknown> => ({
  id: pin.id,
  x: pin.x,
  y: pin.y,
  // An area is held with its angle too.
  ...((pin.turns || pin.area > 0) && { angle: pin.angle, scale: pin.scale }),
});

export const shapeOptions = (motion: Motion): Record<string, unknown> => ({
  mode: motion.mode,
  ...(motion.refine > 0 && { refine: motion.refine }),
  flippedIds: true,
});
