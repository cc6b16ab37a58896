#!/usr/bin/env python3
"""What it costs to make arrays of the bytes of a frame, in microseconds.

Usage: [PYTHONPATH=…] client/python/bench/decode_cost.py [VERTICES…]      (default: 5041)

Measured is all that happens between the bytes of a message and the Shape that a stream hands out:
parsing, checking and counting; beside it, the same message as generated code reads it, with a number
for each coordinate. The least of many runs counts, as other work of the machine only adds to it.
"""

import importlib.resources
import sys
import timeit

import numpy as np
from google.protobuf import descriptor_pb2, descriptor_pool, message_factory

import arapd
from arapd import _shapes, _wire
from arapd._answers import MeshSize

Response = _wire.message("StreamDeformResponse")


def plain_response():
    """The class that generated code has, with `repeated float`."""
    description = importlib.resources.files(arapd).joinpath("wire.binpb").read_bytes()
    pool = descriptor_pool.DescriptorPool()
    for file in descriptor_pb2.FileDescriptorSet.FromString(description).file:
        pool.AddSerializedFile(file.SerializeToString())
    descriptor = pool.FindMessageTypeByName("arap.v1.StreamDeformResponse")
    return message_factory.MessageFactory(pool).GetPrototype(descriptor)


def frame(vertices):
    """The bytes of an answer with so many vertices."""
    message = Response()
    points = np.random.default_rng(1).random((vertices, 2), np.float32)
    message.shape.positions = points.tobytes()
    message.shape.sequence = 12345
    message.shape.worst_handle_id = "head"
    message.shape.worst_handle_error = 1e-4
    message.shape.mean_stretch = message.shape.max_stretch = 1.1
    message.shape.queue_micros = message.shape.solve_micros = 321.5
    return message.SerializeToString()


def cost(work, number):
    work()
    return min(timeit.repeat(work, number=number, repeat=15)) / number * 1e6


def main():
    plain = plain_response()
    print("vertices    bytes     arapd  numbers one by one")
    for vertices in [int(argument) for argument in sys.argv[1:]] or [5041]:
        data = frame(vertices)
        question = _shapes.Question(arapd.ShapeOptions(), MeshSize(vertices, 2 * vertices))

        def ours():
            return _shapes.shape(Response.FromString(data).shape, question, 0)

        def theirs():
            return np.array(plain.FromString(data).shape.positions, np.float32).reshape(-1, 2)

        np.testing.assert_array_equal(ours().positions, theirs())
        print(f"{vertices:8} {len(data):8} {cost(ours, 500):9.1f} {cost(theirs, 20):9.1f}")


if __name__ == "__main__":
    main()
