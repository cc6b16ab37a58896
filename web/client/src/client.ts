// Client: a connection to one arapd.
import { ask, lookUp, quickLimit, randomHex, work } from "./calls.js";
import type { CallOptions } from "./calls.js";
import { Channel, maxMessageBytes } from "./channel.js";
import type { ConnectOptions } from "./channel.js";
import { index, numberRun } from "./checks.js";
import { badAnswer, overdue } from "./errors.js";
import { flatSurfaceOf, flattenToWire } from "./flatten.js";
import type { FlatSurface, FlattenOptions } from "./flatten.js";
import type { LimitsAnswer } from "./gen/arap/v1/Limits.js";
import type { DurationAnswer } from "./gen/google/protobuf/Duration.js";
import { outlineMeshOf } from "./mesh.js";
import type { OutlineMesh, OutlineOptions, SurfaceMesh } from "./mesh.js";
import type { Numbers } from "./runs.js";
import { Session, sessionInfoOf } from "./session.js";
import type { SessionInfo } from "./session.js";
import { deformation, flattening, milliseconds, server } from "./wire.js";

/** The limits in force; a request beyond one is refused. Times are in milliseconds. */
export type Limits = { readonly [Name in keyof LimitsAnswer]: number };

/** What the server is and what it allows. */
export interface ServerInfo {
  version: string;
  limits: Limits;
  /** Names such as "basis.edge". */
  capabilities: string[];
  /** Worker threads. */
  workers: number;
}

export interface SessionOptions {
  /** Default: 128 random bits in hexadecimal. */
  id?: string;
  /** Life without use, in milliseconds. Default 1 h. */
  ttl?: number;
  /** At most 16. */
  labels?: Record<string, string>;
}

export interface SessionPage {
  /** By id. */
  sessions: SessionInfo[];
  /** Empty at the end. */
  nextPageToken: string;
}

/**
 * A connection to one arapd.
 *
 * ```ts
 * const client = Client.connect("localhost:50051");
 * const session = await client.createSession();
 * ```
 */
export class Client {
  readonly #channel: Channel;

  /**
   * `address` is host:port or unix:PATH. Connects in the background; fails only with
   * INVALID_OPTION, for options that do not go together, a file that cannot be read, or a token
   * that would travel in plaintext to another machine.
   */
  static connect(address: string, options: ConnectOptions = {}): Client {
    return new Client(Channel.open(address, options));
  }

  private constructor(channel: Channel) {
    this.#channel = channel;
  }

  /** Waits until the connection stands. DEADLINE_EXCEEDED after `timeout` milliseconds. */
  waitReady(timeout = quickLimit): Promise<void> {
    return new Promise((resolve, reject) => {
      this.#channel.grpc.waitForReady(Date.now() + timeout, (error) => {
        if (error) reject(overdue("No connection to the server in time."));
        else resolve();
      });
    });
  }

  /**
   * Ends the connection, and with it every call and stream; those and later ones fail with
   * CANCELLED.
   */
  close(): void {
    this.#channel.closeAll();
  }

  async getServerInfo(call: CallOptions = {}): Promise<ServerInfo> {
    const answer = await ask(this.#channel, server.GetServerInfo, {}, lookUp, call);
    const told: Partial<LimitsAnswer> = answer.limits ?? {};
    const limits = Object.entries(told).map(
      ([name, limit]: [string, number | DurationAnswer | null]) => [
        name,
        typeof limit === "number" ? limit : milliseconds(limit),
      ],
    );
    const { version, capabilities, workers } = answer;
    return { version, capabilities, workers, limits: Object.fromEntries(limits) as Limits };
  }

  /** Opens a session on the server. Repeating it with the same id and arguments is harmless. */
  async createSession(options: SessionOptions = {}, call: CallOptions = {}): Promise<Session> {
    // The id is all that keeps others out.
    const id = options.id ?? randomHex(16);
    const request = {
      sessionId: id,
      labels: options.labels ?? {},
      ...(options.ttl !== undefined && {
        ttl: {
          seconds: Math.floor(options.ttl / 1000),
          nanos: Math.round((options.ttl % 1000) * 1e6),
        },
      }),
    };
    const answer = await ask(this.#channel, deformation.CreateSession, request, lookUp, call, id);
    sessionInfoOf(answer.session, id);
    return new Session(this.#channel, id);
  }

  /** A session that exists already; asks nothing. */
  attachSession(id: string): Session {
    return new Session(this.#channel, id);
  }

  /** The caller's sessions, `pageSize` (1 to 1000; 0: the server's choice) at a time. */
  async listSessions(pageSize = 0, pageToken = "", call: CallOptions = {}): Promise<SessionPage> {
    const request = { pageSize: index(pageSize, "page_size"), pageToken };
    const answer = await ask(this.#channel, deformation.ListSessions, request, lookUp, call);
    const most = pageSize === 0 ? 1000 : pageSize;
    if (answer.sessions.length > most) {
      throw badAnswer(
        `The server answered ${answer.sessions.length} sessions; ${most} were asked.`,
      );
    }
    if (answer.nextPageToken !== "" && answer.nextPageToken === pageToken) {
      throw badAnswer("The server answered a page of sessions that leads back to itself.");
    }
    return {
      sessions: answer.sessions.map((session) => sessionInfoOf(session, "")),
      nextPageToken: answer.nextPageToken,
    };
  }

  /**
   * Triangles inside outlines (each x y x y…, at least 3 points): a mesh to register, with about so
   * many vertices (0: 1000). The outlines may be simplified or grow before.
   */
  async meshOutline(
    outlines: readonly Numbers[],
    options: number | OutlineOptions = 0,
    call: CallOptions = {},
  ): Promise<OutlineMesh> {
    const asked = typeof options === "number" ? { vertices: options } : options;
    const request = {
      outlines: outlines.map((points, i) => ({
        points: numberRun(points, `outlines[${i}].points`),
      })),
      vertexCount: index(asked.vertices ?? 0, "vertex_count"),
      tolerance: asked.tolerance ?? 0,
      expansion: asked.expansion ?? 0,
    };
    return outlineMeshOf(await ask(this.#channel, deformation.MeshOutline, request, work, call));
  }

  /** Flattens a surface, true to size. Needs no session. */
  async flatten(
    mesh: SurfaceMesh,
    options: FlattenOptions = {},
    call: CallOptions = {},
  ): Promise<FlatSurface> {
    const request = { ...flattenToWire(mesh, options), maxResponseBytes: maxMessageBytes };
    return flatSurfaceOf(
      await ask(this.#channel, flattening.Flatten, request, work, call),
      mesh,
      options,
    );
  }
}
