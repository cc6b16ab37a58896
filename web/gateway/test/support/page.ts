// A page's end of a socket.
import assert from "node:assert/strict";
import { once } from "node:events";

import { WebSocket } from "ws";

import type { ProblemDetails } from "@arapd/gateway";

import type { Json } from "./gateway.js";

/** A shape, read as docs/web.md lays it out. */
export interface Frame {
  sequence: number;
  encoding: "float32" | "int16";
  local: Float32Array | Int16Array;
  facts: Json;
  /** In units of the mesh. */
  positions: Float64Array;
}

export function frameOf(bytes: Buffer): Frame {
  const buffer = bytes.buffer.slice(
    bytes.byteOffset,
    bytes.byteOffset + bytes.length,
  ) as ArrayBuffer;
  const head = new DataView(buffer);
  assert.equal(head.getUint8(0), 1);
  assert.equal(head.getUint16(2, true), 0);
  const count = head.getUint32(8, true);
  const int16 = head.getUint8(1) === 1;
  const local = new (int16 ? Int16Array : Float32Array)(buffer, 16, 2 * count);
  const tail = new Uint8Array(buffer, buffer.byteLength - head.getUint32(12, true));
  assert.equal(16 + local.byteLength + tail.length, buffer.byteLength);
  const facts = JSON.parse(new TextDecoder().decode(tail)) as Json;
  const positions = Float64Array.from(
    local,
    (value, i) => value * facts.scale + facts.origin[i % 2],
  );
  return {
    sequence: head.getUint32(4, true),
    encoding: int16 ? "int16" : "float32",
    local,
    facts,
    positions,
  };
}

export type Heard =
  | { kind: "frame"; frame: Frame }
  | { kind: "text"; message: Json }
  | { kind: "closed"; code: number };

/** Reads in order what comes. */
export class Page {
  readonly socket: WebSocket;
  #heard: Heard[] = [];
  #waiting: (() => void) | undefined;

  private constructor(socket: WebSocket) {
    this.socket = socket;
    const hear = (heard: Heard): void => {
      this.#heard.push(heard);
      this.#waiting?.();
    };
    socket.on("message", (data, isBinary) =>
      hear(
        isBinary
          ? { kind: "frame", frame: frameOf(data as Buffer) }
          : { kind: "text", message: JSON.parse((data as Buffer).toString()) },
      ),
    );
    socket.on("close", (code) => hear({ kind: "closed", code }));
    socket.on("error", () => {});
  }

  static async connect(
    url: string,
    session: string,
    headers: Record<string, string> = {},
  ): Promise<Page> {
    const socket = new WebSocket(
      `${url.replace(/^http/, "ws")}/v1/sessions/${session}/stream`,
      "arapd.v1",
      { headers },
    );
    const page = new Page(socket);
    await once(socket, "open");
    return page;
  }

  /** The problem with which an upgrade is refused. */
  static async refused(
    url: string,
    path: string,
    headers: Record<string, string> = {},
  ): Promise<ProblemDetails> {
    const socket = new WebSocket(`${url.replace(/^http/, "ws")}${path}`, { headers });
    socket.on("error", () => {});
    const [, response] = (await once(socket, "unexpected-response")) as [
      unknown,
      AsyncIterable<Buffer>,
    ];
    let text = "";
    for await (const part of response) text += part.toString();
    return JSON.parse(text) as ProblemDetails;
  }

  say(message: object): void {
    this.socket.send(JSON.stringify(message));
  }

  async next(): Promise<Heard> {
    while (this.#heard.length === 0) {
      await new Promise<void>((resolve) => (this.#waiting = resolve));
      this.#waiting = undefined;
    }
    return this.#heard.shift()!;
  }

  /** The next thing, which has to be a text of this type. */
  async text(type: string): Promise<Json> {
    const heard = await this.next();
    assert.equal(heard.kind, "text", JSON.stringify(heard).slice(0, 500));
    const { message } = heard as { message: Json };
    assert.equal(message.type, type, JSON.stringify(message).slice(0, 500));
    return message;
  }
  async frame(): Promise<Frame> {
    const heard = await this.next();
    assert.equal(heard.kind, "frame", JSON.stringify(heard).slice(0, 500));
    return (heard as { frame: Frame }).frame;
  }
  async closed(): Promise<number> {
    const heard = await this.next();
    assert.equal(heard.kind, "closed", JSON.stringify(heard).slice(0, 500));
    return (heard as { code: number }).code;
  }
  /** The problem that ends it, with the code that goes with it. */
  async failed(): Promise<ProblemDetails> {
    const { problem } = (await this.text("problem")) as { problem: ProblemDetails };
    assert.equal(await this.closed(), 4000 + problem.status);
    return problem;
  }
}
