// What the page asks of the gateway: files as surfaces, and flattenings, which are jobs.
import { Problem, addressOf, problemOf, send } from "../net/api.js";
import type { Format, NamedPart, Surface } from "./surface.js";

export interface Warning {
  kind: string;
  count: number;
  elements: number[];
  message: string;
}

export interface Distortion {
  arapEnergy: number;
  areaRatio: number;
  meanStretchPercent: number;
  maxStretchPercent: number;
  meanCompressionPercent: number;
  maxCompressionPercent: number;
  meanAngleDegrees: number;
  maxAngleDegrees: number;
  flipped: number;
}

export interface DrawingFile {
  page: string;
  data: string;
}

/** As docs/web.md has it. */
export interface Answer {
  uv: number[];
  uvVertex: number[];
  cornerUv: number[];
  singularValues: number[];
  distortion: Distortion;
  warnings: Warning[];
  charts: { loops: number[][]; triangleCount: number; distortion: Distortion }[];
  triangleChart: number[];
  cutEdges: number[];
  autoCutCount: number;
  boundaryOverlaps: boolean;
  drawings: { format: string; mediaType: string; files: DrawingFile[]; warnings: Warning[] }[];
}

/** How a job stands. */
export interface Progress {
  state: string;
  phase: string;
  fraction: number;
  place: number;
}

export async function surfaceOfFile(file: File, signal: AbortSignal): Promise<Surface> {
  const form = new FormData();
  form.append("file", file);
  const response = await send("POST", "v1/surfaces", form, { signal });
  const { format, mesh, parts, warnings } = (await response.json()) as {
    format: Format;
    mesh: { vertices: number[]; triangles: number[] };
    parts: NamedPart[];
    warnings: Warning[];
  };
  return {
    name: file.name.replace(/\.[^.]*$/, ""),
    vertices: Float64Array.from(mesh.vertices),
    triangles: Uint32Array.from(mesh.triangles),
    parts,
    file,
    format,
    warnings: warnings.map(({ message }) => message),
  };
}

function bodyOf(surface: Surface, request: Record<string, unknown>): unknown {
  const { file, vertices, triangles, parts } = surface;
  if (!file)
    return { mesh: { vertices: [...vertices], triangles: [...triangles] }, parts, ...request };
  const form = new FormData();
  form.append("request", JSON.stringify(request));
  form.append("file", file);
  return form;
}

// Forgets the job; nobody hears the answer.
const drop = (id: string): void =>
  void fetch(addressOf(`v1/jobs/${id}`), { method: "DELETE", keepalive: true }).catch(() => {});

const mostSilences = 5;

// Until the job has ended; what has gone wrong rejects.
function ended(id: string, tell: (progress: Progress) => void, signal: AbortSignal): Promise<void> {
  return new Promise((resolve, reject) => {
    const source = new EventSource(addressOf(`v1/jobs/${id}/events`));
    let silences = 0;
    const end = (act: () => void): void => {
      source.close();
      signal.removeEventListener("abort", abort);
      act();
    };
    const abort = (): void => end(() => reject(signal.reason as Error));
    signal.addEventListener("abort", abort);
    source.addEventListener("job", ({ data }) => {
      silences = 0;
      tell(JSON.parse(data as string) as Progress);
    });
    source.addEventListener("end", ({ data }) => {
      const problem = JSON.parse(data as string) as { reason?: string };
      end(() => (problem.reason === undefined ? resolve() : reject(problemOf(problem))));
    });
    // It tries again by itself, unless the gateway says that there is no such job.
    source.addEventListener("error", () => {
      const over = source.readyState === EventSource.CLOSED || ++silences > mostSilences;
      if (over) end(() => reject(new Problem(0, "UNREACHABLE", "")));
    });
    if (signal.aborted) abort();
  });
}

/** Lays a surface flat as a job, which ends with the signal. The answer is in that media type. */
export async function flattened(
  surface: Surface,
  request: Record<string, unknown>,
  accept: string,
  tell: (progress: Progress) => void,
  signal: AbortSignal,
): Promise<Response> {
  const submitted = await send("POST", "v1/jobs", bodyOf(surface, request), { signal });
  const { id } = (await submitted.json()) as { id: string };
  try {
    signal.throwIfAborted();
    await ended(id, tell, signal);
    const response = await send("GET", `v1/jobs/${id}/result`, undefined, {
      signal,
      headers: { accept },
    });
    // All of it, before the job is forgotten.
    return new Response(await response.blob());
  } finally {
    drop(id);
  }
}
