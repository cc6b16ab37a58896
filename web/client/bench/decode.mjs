// What a frame costs on this side: decoding the message of a shape of 5,041 vertices to a checked
// Float32Array, beside decoding the same bytes as the interface declares them (`repeated float`),
// which is what other clients do.
//
// Usage: npm run bench
import { cpus } from "node:os";
import { fileURLToPath } from "node:url";

import { loadSync } from "@grpc/proto-loader";

import { shapeOf } from "../dist/shape.js";
import { deformation } from "../dist/wire.js";

const vertices = 5041;
const plain = loadSync("arap/v1/deformation_service.proto", {
  includeDirs: [fileURLToPath(new URL("../../../proto/", import.meta.url))],
  longs: Number,
  enums: String,
  defaults: true,
  oneofs: true,
})["arap.v1.DeformationService"].StreamDeform;

const positions = Float32Array.from({ length: 2 * vertices }, (_, i) => Math.sin(i) * 100);
const shape = {
  positions: Array.from(positions),
  sequence: 12345,
  worstHandleId: "hand",
  worstHandleError: 1e-7,
  energy: 0.25,
  meanStretch: 1.01,
  maxStretch: 1.2,
  queueMicros: 90,
  solveMicros: 700,
  handleSetRevision: 3,
};
const body = plain.responseSerialize({ shape });
const asked = { options: {}, mesh: { vertices, triangles: 9800 }, picks: 0, vertices: null };

const ours = (message) =>
  shapeOf(deformation.StreamDeform.responseDeserialize(message).shape, asked).positions;
const theirs = (message) => Float32Array.from(plain.responseDeserialize(message).shape.positions);

// Messages as grpc-js hands them over: each behind the five bytes of its head, and of its own.
function messages(count) {
  const frame = Buffer.concat([Buffer.alloc(5), body]);
  return Array.from({ length: count }, () => Buffer.from(frame).subarray(5));
}

for (const decode of [ours, theirs]) {
  const decoded = decode(messages(1)[0]);
  if (decoded.some((number, i) => number !== positions[i])) throw new Error("other positions");
}

// The time of one decoding in microseconds: the median of rounds, and the least, which other work
// on the machine spoils least.
function measure(decode, count) {
  const times = [];
  for (let round = 0; round < 30; round++) {
    const received = messages(count);
    const begin = process.hrtime.bigint();
    for (const message of received) decode(message);
    times.push(Number(process.hrtime.bigint() - begin) / 1e3 / count);
  }
  times.splice(0, 5); // the compiler's
  times.sort((a, b) => a - b);
  return `${times[12].toFixed(1)} µs a frame, ${times[0].toFixed(1)} at best`;
}

console.log(
  `${vertices} vertices, ${body.length} bytes a frame; Node.js ${process.versions.node}, ${cpus()[0]?.model}`,
);
console.log(`@arapd/client, decoded and checked: ${measure(ours, 500)}`);
console.log(`the same declared as repeated float: ${measure(theirs, 200)}`);
