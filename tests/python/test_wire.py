"""What the package takes as given of the wire."""

import grpc

import arapd
from arapd import _wire
from support import grid


def fields(data):
    """The (number, wire type, bytes or number) of a message, as protobuf lays it out."""
    at = 0

    def varint():
        nonlocal at
        value = shift = 0
        while True:
            byte = data[at]
            at += 1
            value |= (byte & 127) << shift
            shift += 7
            if byte < 128:
                return value

    out = []
    while at < len(data):
        key = varint()
        kind = key & 7
        length = {0: None, 1: 8, 2: None, 5: 4}[kind]
        if kind == 0:
            out.append((key >> 3, kind, varint()))
            continue
        if kind == 2:
            length = varint()
        out.append((key >> 3, kind, data[at:at + length]))
        at += length
    return out


def test_positions_come_as_one_packed_run(server, session):
    """docs/protocol.md: a client may declare them as bytes."""
    vertices, triangles = grid(71, 71)
    session.register_mesh(vertices, triangles, "m")
    session.compile_handles("h", "m", [arapd.Handle("l", vertex=0)])
    request = _wire.message("DeformRequest")(session_id=session.id, handle_set_id="h")
    request.targets.add(handle_id="l")
    with grpc.insecure_channel(server.address) as channel:
        deform = channel.unary_unary("/arap.v1.DeformationService/Deform")
        for float64, field, width in ((False, 1, 4), (True, 2, 8)):
            request.options.float64 = float64
            [(number, kind, shape)] = fields(deform(request.SerializeToString()))
            assert (number, kind) == (1, 2)
            runs = [value for number, kind, value in fields(shape) if number == field]
            assert [len(run) for run in runs] == [2 * width * len(vertices)]
            assert not [number for number, _, _ in fields(shape) if number == 3 - field]
