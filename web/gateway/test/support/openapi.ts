// Whether answers are what the OpenAPI document says.
import assert from "node:assert/strict";

import { Ajv2020 } from "ajv/dist/2020.js";

import type { Json } from "./gateway.js";

export class Document {
  readonly #ajv = new Ajv2020({ strict: false, validateFormats: false });
  constructor(readonly json: Json) {
    this.#ajv.addSchema({ ...json, $id: "document" });
  }

  /** Checks a JSON answer of a route, as the document writes its path. */
  check(method: string, path: string, status: number | "default", answer: unknown): void {
    const operation = this.json.paths[path]?.[method.toLowerCase()];
    assert.ok(operation, `${method} ${path} is not in the document`);
    const { content } = operation.responses[String(status)];
    const media = status === "default" ? "application/problem+json" : "application/json";
    assert.ok(content[media], `${method} ${path} ${status} has no ${media}`);
    const pointer = [
      "paths",
      path,
      method.toLowerCase(),
      "responses",
      String(status),
      "content",
      media,
      "schema",
    ]
      .map((part) => encodeURIComponent(part.replaceAll("~", "~0").replaceAll("/", "~1")))
      .join("/");
    const validate = this.#ajv.getSchema(`document#/${pointer}`);
    assert.ok(validate, pointer);
    assert.ok(validate(answer), `${method} ${path}: ${this.#ajv.errorsText(validate.errors)}`);
  }
}
