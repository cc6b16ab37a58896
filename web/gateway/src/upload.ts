// Bodies that hold a surface: JSON with a mesh, or a form with a file.
import type { FastifyRequest } from "fastify";

import type { Context } from "./context.js";
import type { FileWarning, Surface } from "./files/surface.js";
import { Problem } from "./problems.js";
import { FlattenBody, FlattenOptions } from "./schemas/flatten.js";
import { check } from "./validate.js";

/** What is to be flattened, and how. */
export interface FlattenInput {
  mesh: { vertices: Float64Array | number[]; triangles: Uint32Array | number[] };
  options: FlattenOptions;
  /** Of an uploaded file. */
  warnings: FileWarning[];
}

interface Form {
  bytes: Buffer;
  name: string;
  request: string | undefined;
}

const malformed = (message: string): Problem => new Problem("MALFORMED", message);

// The parts of a form: one file, and perhaps the text `request`.
async function formOf(request: FastifyRequest, { settings }: Context): Promise<Form> {
  let file: { bytes: Buffer; name: string } | undefined;
  let text: string | undefined;
  try {
    for await (const part of request.parts()) {
      if (part.type === "file") {
        if (part.fieldname !== "file" || file)
          throw malformed("A form has one file, in the part `file`.");
        file = { bytes: await part.toBuffer(), name: part.filename ?? "" };
      } else {
        if (part.fieldname !== "request" || text !== undefined || typeof part.value !== "string") {
          throw malformed("Beside the file a form has at most the part `request`.");
        }
        text = part.value;
      }
    }
  } catch (error) {
    if (error instanceof Problem) throw error;
    const { code = "", message } = error as Error & { code?: string };
    if (code === "FST_REQ_FILE_TOO_LARGE") {
      throw new Problem(
        "TOO_LARGE",
        `The file has more than ${settings.maxFileBytes} bytes, as many as the gateway takes.`,
      );
    }
    throw malformed(`The form cannot be read: ${message.replace(/\.$/, "")}.`);
  }
  if (!file) throw malformed("The form has no part `file`.");
  return { ...file, request: text };
}

function requestOf(text: string): FlattenOptions {
  let value: unknown;
  try {
    value = JSON.parse(text);
  } catch (error) {
    throw malformed(`The part request is no JSON: ${(error as Error).message}.`);
  }
  check(FlattenOptions, value, "The part request");
  return value as FlattenOptions;
}

/** The surface of a form with nothing but a file. */
export async function surfaceOf(
  request: FastifyRequest,
  context: Context,
  signal: AbortSignal,
): Promise<Surface> {
  if (!request.isMultipart())
    throw new Problem("UNSUPPORTED_MEDIA_TYPE", "The body has to be multipart/form-data.");
  const { bytes, name } = await formOf(request, context);
  return context.files.read(bytes, name, signal);
}

/** What a request to flatten asks for. */
export async function inputOf(
  request: FastifyRequest,
  context: Context,
  signal: AbortSignal,
): Promise<FlattenInput> {
  if (!request.isMultipart()) {
    const body = request.body as FlattenBody | undefined;
    check(FlattenBody, body);
    const { mesh, ...options } = body!;
    return { mesh, options, warnings: [] };
  }
  const form = await formOf(request, context);
  const options = form.request === undefined ? {} : requestOf(form.request);
  const { vertices, triangles, parts, warnings } = await context.files.read(
    form.bytes,
    form.name,
    signal,
  );
  return { mesh: { vertices, triangles }, options: { parts, ...options }, warnings };
}
