// The cloth in space, and lines and dots on it that keep their width on the screen.
import {
  BufferGeometry,
  DoubleSide,
  Mesh,
  MeshBasicMaterial,
  MeshLambertMaterial,
  SphereGeometry,
} from "three";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";
import { LineSegments2 } from "three/addons/lines/LineSegments2.js";
import { LineSegmentsGeometry } from "three/addons/lines/LineSegmentsGeometry.js";

export class Lines extends LineSegments2 {
  readonly #ink: LineMaterial;

  constructor(color: string, linewidth: number, opacity = 1) {
    const ink = new LineMaterial({ color, linewidth, transparent: opacity < 1, opacity });
    super(new LineSegmentsGeometry(), ink);
    this.#ink = ink;
    this.visible = false;
    this.frustumCulled = false;
  }

  /** What is drawn. */
  ends: readonly number[] = [];
  get ink(): { colour: string; width: number; opacity: number } {
    const { color, linewidth, opacity } = this.#ink;
    return { colour: `#${color.getHexString()}`, width: linewidth, opacity };
  }

  set colour(color: string) {
    this.#ink.color.set(color.trim());
  }

  /** From x y z to x y z, and so on. */
  draw(ends: number[]): void {
    this.ends = ends;
    this.visible = ends.length > 0;
    if (ends.length === 0) return;
    this.geometry.dispose();
    this.geometry = new LineSegmentsGeometry().setPositions(ends);
  }
}

export function dot(color: string): Mesh {
  const one = new Mesh(
    new SphereGeometry(1, 16, 12),
    new MeshBasicMaterial({ color, depthTest: false }),
  );
  one.renderOrder = 2;
  one.visible = false;
  return one;
}

/** Coloured by corner, seen from both sides, a little behind the lines on it. */
export const cloth = (): Mesh =>
  new Mesh(
    new BufferGeometry(),
    new MeshLambertMaterial({
      vertexColors: true,
      side: DoubleSide,
      polygonOffset: true,
      polygonOffsetFactor: 1.5,
      polygonOffsetUnits: 2,
    }),
  );
