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
// As grpc-js hands it over: behind the five bytes of the frame's head.
const body = plain.responseSerialize({ shape });
const frame = Buffer.concat([Buffer.alloc(5), body]);
const message = frame.subarray(5);
const asked = { options: {}, mesh: { vertices, triangles: 9800 }, picks: 0 };

const ours = () =>
  shapeOf(deformation.StreamDeform.responseDeserialize(message).shape, asked).positions;
const theirs = () => Float32Array.from(plain.responseDeserialize(message).shape.positions);

for (const decode of [ours, theirs]) {
  if (Buffer.compare(Buffer.from(decode().buffer), Buffer.from(positions.buffer)) !== 0)
    throw new Error("other positions");
}

// The time of one call in microseconds: the median of rounds, and the least, which other work on
// the machine spoils least.
function measure(decode, count) {
  for (let i = 0; i < count; i++) decode();
  const times = [];
  for (let round = 0; round < 25; round++) {
    const begin = process.hrtime.bigint();
    for (let i = 0; i < count; i++) decode();
    times.push(Number(process.hrtime.bigint() - begin) / 1e3 / count);
  }
  times.sort((a, b) => a - b);
  return `${times[12].toFixed(1)} µs a frame, ${times[0].toFixed(1)} at best`;
}

console.log(
  `${vertices} vertices, ${body.length} bytes a frame; Node.js ${process.versions.node}, ${cpus()[0]?.model}`,
);
console.log(`@arapd/client, decoded and checked: ${measure(ours, 2000)}`);
console.log(`the same declared as repeated float: ${measure(theirs, 200)}`);
