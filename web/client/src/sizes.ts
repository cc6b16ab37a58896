// The sizes of the meshes that a session has registered or got, and which handle set is on which:
// every shape must have as many vertices as its mesh.
import type { MeshSize } from "./checks.js";

export class KnownSizes {
  readonly #meshes = new Map<string, MeshSize>();
  readonly #sets = new Map<string, string>();

  know(meshId: string, size: MeshSize): void {
    this.#meshes.set(meshId, size);
  }
  forget(meshId: string): void {
    this.#meshes.delete(meshId);
    for (const [set, mesh] of this.#sets) if (mesh === meshId) this.#sets.delete(set);
  }
  knowSet(setId: string, meshId: string): void {
    this.#sets.set(setId, meshId);
  }
  forgetSet(setId: string): void {
    this.#sets.delete(setId);
  }
  readonly ofMesh = (meshId: string): MeshSize | undefined => this.#meshes.get(meshId);
  ofSet(setId: string): MeshSize | undefined {
    return this.#meshes.get(this.#sets.get(setId) ?? "");
  }
}
