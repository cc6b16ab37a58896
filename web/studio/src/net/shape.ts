// A shape as it comes over the socket: "A shape" in docs/web.md.

export interface Shape {
  sequence: number;
  /** x y x y… of all vertices. */
  positions: Float64Array;
  facts: ShapeFacts;
}

export interface ShapeFacts {
  origin: [number, number];
  scale: number;
  /** How far a coordinate may be off. */
  positionError: number;
  replaced: number;
  skipped: number;
  flippedCount: number;
  flippedIds?: number[];
  worstHandleError: number;
  maxStretch: number;
  queueMicros: number;
  solveMicros: number;
}

/** Throws where the bytes are no shape. */
export function readShape(buffer: ArrayBuffer): Shape {
  const head = new DataView(buffer);
  if (buffer.byteLength < 16 || head.getUint8(0) !== 1) throw new Error("no shape of version 1");
  const count = head.getUint32(8, true);
  const textLength = head.getUint32(12, true);
  const quantised = head.getUint8(1) === 1;
  const width = quantised ? 2 : 4;
  if (buffer.byteLength !== 16 + 2 * count * width + textLength) {
    throw new Error("a shape of a wrong length");
  }
  const text = new Uint8Array(buffer, buffer.byteLength - textLength);
  const facts = JSON.parse(new TextDecoder().decode(text)) as ShapeFacts;
  const local = quantised
    ? new Int16Array(buffer, 16, 2 * count)
    : new Float32Array(buffer, 16, 2 * count);
  const positions = new Float64Array(2 * count);
  for (let i = 0; i < positions.length; ++i) {
    positions[i] = local[i] * facts.scale + facts.origin[i & 1];
  }
  return { sequence: head.getUint32(4, true), positions, facts };
}
