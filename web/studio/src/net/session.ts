// The session of this page, and what it has registered there.
import type { Body, Motion, Pin } from "../model/puppet.js";
import {
  compileHandles,
  createSession,
  deleteHandleSet,
  deleteMesh,
  endSession,
  registerMesh,
} from "./api.js";

/** What a registered mesh is made of. */
export interface Stuff {
  body: Body;
  starch: Float32Array | null;
  motion: Motion;
}

const sameStuff = (a: Stuff, b: Stuff): boolean =>
  a.body === b.body &&
  a.starch === b.starch &&
  a.motion.basis === b.motion.basis &&
  a.motion.weights === b.motion.weights;

interface Registered {
  stuff: Stuff;
  mesh: string;
}

/** How many meshes are kept there: going back to one of them is quick. */
const mostMeshes = 8;

export class Session {
  #id: Promise<string> | undefined;
  #named: string | undefined;
  #registered: Registered[] = [];
  #sets = 0;
  readonly #page = Math.random().toString(36).slice(2, 8);

  id(): Promise<string> {
    this.#id ??= createSession().then(({ id }) => (this.#named = id));
    this.#id.catch(() => this.forget());
    return this.#id;
  }

  /** The page is closed. One that comes back from the browser's memory begins anew. */
  leave(): void {
    if (this.#named !== undefined) endSession(this.#named);
    this.forget();
  }

  /** It is gone, or its server is: the next call begins anew. */
  forget(): void {
    this.#named = undefined;
    this.#id = undefined;
    this.#registered = [];
  }

  async mesh(stuff: Stuff): Promise<string> {
    const session = await this.id();
    const known = this.#registered.find((one) => sameStuff(one.stuff, stuff));
    if (known) {
      this.#registered = [known, ...this.#registered.filter((one) => one !== known)];
      return known.mesh;
    }
    const { id } = await registerMesh(session, stuff.body, stuff.motion, stuff.starch);
    this.#registered.unshift({ stuff, mesh: id });
    for (const old of this.#registered.splice(mostMeshes)) {
      if (this.#registered.some((one) => one.mesh === old.mesh)) continue;
      deleteMesh(session, old.mesh).catch(() => {});
    }
    return id;
  }

  /** A new handle set on that mesh. */
  async handleSet(mesh: string, pins: readonly Pin[]) {
    const session = await this.id();
    return compileHandles(session, `set-${this.#page}-${++this.#sets}`, mesh, pins);
  }

  async dropHandleSet(id: string): Promise<void> {
    if (this.#id) await deleteHandleSet(await this.#id, id).catch(() => {});
  }
}
