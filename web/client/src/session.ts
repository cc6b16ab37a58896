// Session: a namespace of meshes, handle sets and jobs on the server, which expires when unused.
import { ask, change, lookUp, removal, unary, work } from "./calls.js";
import type { CallOptions } from "./calls.js";
import type { Channel } from "./channel.js";
import { checkId, present } from "./checks.js";
import { badAnswer } from "./errors.js";
import { flatSurfaceOf, flattenToWire } from "./flatten.js";
import type { FlatSurface, FlattenOptions } from "./flatten.js";
import type { SessionAnswer } from "./gen/arap/v1/Session.js";
import { compilationOf, handleSetOf, handlesToWire, targetsToWire } from "./handles.js";
import type { Compilation, Handle, HandleSetInfo, HandleTarget } from "./handles.js";
import { download, hasEnded, jobOf, watch } from "./jobs.js";
import type { FlattenJob } from "./jobs.js";
import { energyToWire, meshInfoOf, meshToWire, repairToWire } from "./mesh.js";
import type {
  EnergyOptions,
  MeshInfo,
  PlanarMesh,
  Registration,
  RepairOptions,
  SurfaceMesh,
} from "./mesh.js";
import { verticesOf } from "./positions.js";
import type { Numbers } from "./runs.js";
import { picksToWire, shapeOf, shapeOptionsToWire } from "./shape.js";
import type { Shape, ShapeOptions } from "./shape.js";
import { KnownSizes } from "./sizes.js";
import { DeformStream } from "./stream/deform_stream.js";
import type { StreamOptions } from "./stream/options.js";
import { deformTrack } from "./track.js";
import type { TrackFrame } from "./track.js";
import {
  dateOf,
  deformation,
  flattening,
  microseconds,
  milliseconds,
  readFlattenResponse,
} from "./wire.js";

export interface SessionInfo {
  id: string;
  createTime: Date;
  /** Unless it is used before. */
  expireTime: Date;
  /** Life without use, in milliseconds. */
  ttl: number;
  labels: Record<string, string>;
  meshIds: string[];
  handleSetIds: string[];
}

/** How to register a mesh. */
export interface RegisterOptions {
  /** Default: one made of the content hash. */
  id?: string;
  energy?: EnergyOptions;
  repair?: RepairOptions;
}

/** A session of that id, or of any when it is empty. */
export function sessionInfoOf(answer: SessionAnswer | null, id: string): SessionInfo {
  const session = present(answer, "the session");
  checkId(session.sessionId, id, "session");
  for (const mesh of session.meshIds) checkId(mesh, "", "mesh");
  for (const set of session.handleSetIds) checkId(set, "", "handle set");
  return {
    id: session.sessionId,
    createTime: dateOf(session.createTime),
    expireTime: dateOf(session.expireTime),
    ttl: milliseconds(session.ttl),
    labels: session.labels,
    meshIds: session.meshIds,
    handleSetIds: session.handleSetIds,
  };
}

/**
 * Names a session on the server; dropping it leaves the session there. Every call sends the id as
 * the header "x-session-id", by which a load balancer finds the replica. Shapes must have as many
 * vertices as their mesh where this object has registered or got the mesh; of others they may be of
 * any size.
 */
export class Session {
  readonly id: string;
  readonly #channel: Channel;
  readonly #sizes = new KnownSizes();

  /** Made by Client.createSession and Client.attachSession. */
  constructor(channel: Channel, id: string) {
    this.#channel = channel;
    this.id = id;
  }

  /** Does not extend the session's life. */
  async get(call: CallOptions = {}): Promise<SessionInfo> {
    const request = { sessionId: this.id };
    const answer = await ask(this.#channel, deformation.GetSession, request, lookUp, call, this.id);
    return sessionInfoOf(answer.session, this.id);
  }

  /** Ends the session; its open streams end with NOT_FOUND. */
  async delete(call: CallOptions = {}): Promise<void> {
    const request = { sessionId: this.id };
    await unary(this.#channel, deformation.DeleteSession, request, removal, call, this.id);
  }

  /** Mends, validates and factors a mesh. */
  async registerMesh(
    mesh: PlanarMesh,
    options: RegisterOptions = {},
    call: CallOptions = {},
  ): Promise<Registration> {
    const { id = "", energy = {}, repair } = options;
    const request = {
      sessionId: this.id,
      meshId: id,
      mesh: meshToWire(mesh),
      energy: energyToWire(energy),
      ...(repair && { repair: repairToWire(repair) }),
    };
    const answer = await ask(this.#channel, deformation.RegisterMesh, request, work, call, this.id);
    const info = meshInfoOf(answer.mesh, id, mesh);
    this.#sizes.know(info.id, { vertices: info.vertexCount, triangles: info.triangleCount });
    const { shared, queueTime, solveTime } = answer;
    return {
      mesh: info,
      shared,
      queueMicros: microseconds(queueTime),
      solveMicros: microseconds(solveTime),
    };
  }

  async getMesh(meshId: string, call: CallOptions = {}): Promise<MeshInfo> {
    const request = { sessionId: this.id, meshId };
    const answer = await ask(this.#channel, deformation.GetMesh, request, lookUp, call, this.id);
    const info = meshInfoOf(answer.mesh, meshId);
    this.#sizes.know(info.id, { vertices: info.vertexCount, triangles: info.triangleCount });
    return info;
  }

  /** Forgets a mesh and the handle sets on it. */
  async deleteMesh(meshId: string, call: CallOptions = {}): Promise<void> {
    const request = { sessionId: this.id, meshId };
    await unary(this.#channel, deformation.DeleteMesh, request, removal, call, this.id);
    this.#sizes.forget(meshId);
  }

  async compileHandles(
    handleSetId: string,
    meshId: string,
    handles: readonly Handle[],
    call: CallOptions = {},
  ): Promise<Compilation> {
    const request = { sessionId: this.id, handleSetId, meshId, handles: handlesToWire(handles) };
    const answer = await ask(
      this.#channel,
      deformation.CompileHandles,
      request,
      work,
      call,
      this.id,
    );
    const asked = { id: handleSetId, meshId, last: handles, all: true };
    return this.#know(compilationOf(answer, asked, this.#sizes.ofMesh));
  }

  /** Removes first, then adds. Nothing changes when it fails. */
  async editHandles(
    handleSetId: string,
    remove: readonly string[],
    add: readonly Handle[],
    call: CallOptions = {},
  ): Promise<Compilation> {
    const request = {
      sessionId: this.id,
      handleSetId,
      remove: [...remove],
      add: handlesToWire(add, "add"),
    };
    const answer = await ask(
      this.#channel,
      deformation.EditHandles,
      request,
      change,
      call,
      this.id,
    );
    return this.#know(compilationOf(answer, { id: handleSetId, last: add }, this.#sizes.ofMesh));
  }

  async getHandleSet(handleSetId: string, call: CallOptions = {}): Promise<HandleSetInfo> {
    const request = { sessionId: this.id, handleSetId };
    const answer = await ask(
      this.#channel,
      deformation.GetHandleSet,
      request,
      lookUp,
      call,
      this.id,
    );
    const info = handleSetOf(answer.handleSet, { id: handleSetId }, this.#sizes.ofMesh);
    this.#sizes.knowSet(info.id, info.meshId);
    return info;
  }

  async deleteHandleSet(handleSetId: string, call: CallOptions = {}): Promise<void> {
    const request = { sessionId: this.id, handleSetId };
    await unary(this.#channel, deformation.DeleteHandleSet, request, removal, call, this.id);
    this.#sizes.forgetSet(handleSetId);
  }

  /**
   * One target for every handle of the set, in any order. `pickPoints` are deformed points x y x
   * y…, at most 1024, to map back to rest.
   */
  async deform(
    handleSetId: string,
    targets: readonly HandleTarget[],
    options: ShapeOptions & { pickPoints?: Numbers } = {},
    call: CallOptions = {},
  ): Promise<Shape> {
    const { pickPoints = [] } = options;
    const request = {
      sessionId: this.id,
      handleSetId,
      targets: targetsToWire(targets),
      options: shapeOptionsToWire(options),
      pickPoints: picksToWire(pickPoints, "pick_points"),
    };
    const answer = await ask(this.#channel, deformation.Deform, request, work, call, this.id);
    const mesh = this.#sizes.ofSet(handleSetId);
    const vertices = verticesOf(answer.vertices, options, mesh);
    const measured = options.measureEvery !== 0;
    const picks = pickPoints.length / 2;
    return shapeOf(answer.shape, { options, mesh, vertices, picks, measured });
  }

  /**
   * A whole track, frames in order: `for await (const shape of session.deformTrack(…))`.
   * `handleIds` names every handle of the set once, and every frame has a target for each. Leaving
   * the loop cancels the rest. A frame that takes longer than 10 minutes is DEADLINE_EXCEEDED; a
   * server that ends early is INTERNAL.
   */
  deformTrack(
    handleSetId: string,
    handleIds: readonly string[],
    frames: readonly TrackFrame[],
    options: ShapeOptions = {},
    call: CallOptions = {},
  ): AsyncGenerator<Shape> {
    const track = { sessionId: this.id, handleSetId, handleIds, frames, options };
    return deformTrack(this.#channel, track, this.#sizes.ofSet(handleSetId), call);
  }

  /**
   * Begins a flattening that goes on by itself, also when the server is started anew. Submitting it
   * again with the same arguments is harmless. ALREADY_EXISTS when the name has another request.
   */
  async submitFlatten(
    jobId: string,
    mesh: SurfaceMesh,
    options: FlattenOptions = {},
    call: CallOptions = {},
  ): Promise<FlattenJob> {
    const request = { sessionId: this.id, jobId, flatten: flattenToWire(mesh, options) };
    const answer = await ask(this.#channel, flattening.SubmitFlatten, request, work, call, this.id);
    return jobOf(answer.job, jobId);
  }

  /**
   * Waits until the job has ended; `onChange` hears of it when something has changed and every
   * second or so.
   */
  watchJob(
    jobId: string,
    onChange?: (job: FlattenJob) => void,
    call: CallOptions = {},
  ): Promise<FlattenJob> {
    return watch(this.#channel, this.id, jobId, call, onChange);
  }

  /** The result of a job that is done, of any size; `mesh` and `options` are what was submitted. */
  async getResult(
    jobId: string,
    mesh: SurfaceMesh,
    options: FlattenOptions = {},
    call: CallOptions = {},
  ): Promise<FlatSurface> {
    const bytes = await download(this.#channel, this.id, jobId, call);
    let answer;
    try {
      answer = readFlattenResponse(bytes);
    } catch {
      throw badAnswer("The server answered a result that is none of a flattening.");
    }
    return flatSurfaceOf(answer, mesh, options);
  }

  /** Ends a job that is not done; one that has ended stays as it is. */
  async cancelJob(jobId: string, call: CallOptions = {}): Promise<FlattenJob> {
    const request = { sessionId: this.id, jobId };
    const answer = await ask(this.#channel, flattening.CancelJob, request, lookUp, call, this.id);
    const job = jobOf(answer.job, jobId);
    if (!hasEnded(job))
      throw badAnswer("The server answered that a job goes on which was cancelled.");
    return job;
  }

  /**
   * Opens a live stream and waits until the server has opened it. `call.timeout` is that of the
   * whole stream.
   */
  openStream(
    handleSetId: string,
    options: StreamOptions = {},
    call: CallOptions = {},
  ): Promise<DeformStream> {
    return DeformStream.open(this.#channel, this.#sizes, this.id, handleSetId, options, call);
  }

  #know(compilation: Compilation): Compilation {
    this.#sizes.knowSet(compilation.handleSet.id, compilation.handleSet.meshId);
    return compilation;
  }
}
