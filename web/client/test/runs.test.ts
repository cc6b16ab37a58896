// Runs of numbers: what the package reads and writes is what proto3 packs.
import assert from "node:assert/strict";
import { join } from "node:path";
import { test } from "node:test";

import { loadSync } from "@grpc/proto-loader";
import type { MessageTypeDefinition, ServiceDefinition } from "@grpc/proto-loader";

import {
  firstNonFinite,
  float32Run,
  float64Run,
  packFloat64,
  packUint32,
  uint32Run,
} from "../dist/runs.js";
import { deformation } from "../dist/wire.js";

// The interface as it is declared, read by protobuf.js.
const declared = loadSync("arap/v1/deformation_service.proto", {
  includeDirs: [join(process.cwd(), "../../proto")],
});
const planarMesh = declared["arap.v1.PlanarMesh"] as MessageTypeDefinition<object, object>;
const streamDeform = (declared["arap.v1.DeformationService"] as ServiceDefinition)["StreamDeform"]!;

const indices = [0, 1, 127, 128, 16383, 16384, 2097151, 2097152, 268435455, 268435456, 4294967295];
const doubles = [0, -0, 1.5, -2e-300, 1e300, Math.PI];

/** The bytes behind the tag of a field of less than 128 bytes. */
const contents = (message: Buffer): Buffer => message.subarray(2);

test("whole numbers are packed as protobuf.js packs them, and read again", () => {
  const bytes = contents(planarMesh.serialize({ triangles: indices }));
  assert.deepEqual(Buffer.from(packUint32(indices)), bytes);
  assert.deepEqual(Array.from(uint32Run(bytes)), indices);
  assert.throws(() => uint32Run(bytes.subarray(0, bytes.length - 1)), RangeError);
  for (const bad of [-1, 0.5, 4294967296, Number.NaN])
    assert.throws(() => packUint32([0, bad]), /\[1\]/);
});

test("doubles are packed as protobuf.js packs them, and read again wherever they lie", () => {
  const bytes = contents(planarMesh.serialize({ vertices: doubles }));
  assert.deepEqual(Buffer.from(packFloat64(doubles)), bytes);
  for (let offset = 0; offset < 8; offset++) {
    const moved = Buffer.alloc(bytes.length + offset);
    bytes.copy(moved, offset);
    assert.deepEqual(Array.from(float64Run(moved.subarray(offset))), doubles);
  }
  assert.throws(() => float64Run(bytes.subarray(1)), RangeError);
});

test("a frame is a view of its message, whatever stands before it", () => {
  for (let ahead = 0; ahead < 5; ahead++) {
    const numbers = Float32Array.from({ length: 40 }, (_, i) => i / 8 - 2);
    const shape = {
      positions: Array.from(numbers),
      worstHandleId: "hand",
      sequence: 7,
      energy: 2.5,
    };
    const body = streamDeform.responseSerialize({ shape });
    const message = Buffer.concat([Buffer.alloc(ahead), body]).subarray(ahead);
    const answer = deformation.StreamDeform.responseDeserialize(message).shape!;
    const frame = float32Run(answer.positions);
    assert.equal(frame.buffer, message.buffer);
    assert.deepEqual(frame, numbers);
    assert.deepEqual([answer.worstHandleId, answer.sequence, answer.energy], ["hand", 7, 2.5]);
  }
});

test("a run on its boundary is a view, any other short one a copy", () => {
  const block = new Uint8Array(40);
  assert.equal(float32Run(block.subarray(4, 12)).buffer, block.buffer);
  const copy = float32Run(block.subarray(5, 13));
  assert.notEqual(copy.buffer, block.buffer);
  assert.equal(copy.length, 2);
});

test("what is sent is a copy", () => {
  const mine = Float64Array.of(1, 2);
  const bytes = packFloat64(mine);
  mine[0] = 7;
  assert.deepEqual(Array.from(float64Run(bytes)), [1, 2]);
});

test("the first number that is not finite is found at every place", () => {
  for (let length = 0; length < 11; length++) {
    assert.equal(firstNonFinite(new Float32Array(length).fill(-3e38)), -1);
    for (let at = 0; at < length; at++) {
      for (const bad of [Number.NaN, Infinity, -Infinity]) {
        const numbers = new Float32Array(length).fill(3e38);
        numbers[at] = bad;
        assert.equal(firstNonFinite(numbers), at);
      }
    }
  }
});
