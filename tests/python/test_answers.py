"""What does not fit what was asked is an error, and never handed out."""

import struct

import numpy as np
import pytest

import arapd
from arapd import ArapError, FlattenOptions, Reason, ShapeOptions
from fake import handle_set, message, serving, shape
from support import bent

NAN = float("nan")
V, T = [(0, 0), (1, 0), (0, 1)], [(0, 1, 2)]


def floats(*values):
    return struct.pack(f"<{len(values)}f", *values)


def doubles(*values):
    return struct.pack(f"<{len(values)}d", *values)


def deform(address, answer, options=ShapeOptions(), **question):
    with arapd.connect(address) as client:
        session = client.attach_session("s")
        session.register_mesh(V, T, "m")
        session.compile_handles("h", "m", [])
        return session.deform("h", {}, options, **question)


def deforming(answer, vertices=()):
    """A server that registers and compiles well, and deforms to this."""
    info = message("MeshInfo")(mesh_id="m", vertex_count=3, triangle_count=1)
    return dict(
        RegisterMesh=lambda *_: message("RegisterMeshResponse")(mesh=info),
        CompileHandles=lambda *_: message("CompileHandlesResponse")(handle_set=handle_set()),
        Deform=lambda *_: message("DeformResponse")(shape=answer, vertices=vertices))


GOOD = shape()


@pytest.mark.parametrize("wrong, says, options", [
    (shape(2), "2 vertices; the mesh has 3", {}),
    (shape(0), "empty", {}),
    (shape(positions=floats(0, 1, 2)), "odd length", {}),
    (shape(positions=b"\0" * 7), "odd length", {}),
    (shape(positions=floats(0, 0, 0, NAN, 0, 0)), "vertex 1 that is not finite", {}),
    (shape(), "another precision", {"float64": True}),
    (shape(positions64=doubles(*range(6))), "another precision", {}),
    (shape(packed_positions=b"\0" * 24), "another precision", {}),
    (shape(energy=NAN), "not finite", {}),
    (shape(unmeasured=True), "without the measures", {}),
    (shape(unmeasured=True), "without the measures", {"measure_every": 7}),
    (shape(unmeasured=True, energy=1), "says it has not measured", {"measure_every": 0}),
    (shape(unmeasured=True, flipped_ids=[0]), "says it has not measured",
     {"measure_every": 0, "flipped_ids": True}),
    (shape(worst_handle_id="a b"), "no id", {}),
    (shape(flipped_ids=[0]), "not asked", {}),
    (shape(flipped_ids=[1]), "only 1", {"flipped_ids": True}),
    (shape(flipped_ids=[0, 0]), "more flipped", {"flipped_ids": True}),
    (shape(origin=doubles(1, 2)), "relative to an origin for which it was not", {}),
    (shape(positions=b"", packed_positions=b"\0" * 12), "without the origin",
     {"encoding": "int16_le"}),
    (shape(origin=doubles(1, NAN)), "not finite", {"relative_to_origin": True}),
    (shape(origin=doubles(1)), "without the origin", {"relative_to_origin": True}),
    (shape(), "another precision", {"encoding": "int16_le"}),
    (shape(positions=b"", packed_positions=b"\0" * 10, origin=doubles(0, 0)), "half a position",
     {"encoding": "int16_le"}),
    (shape(), "other vertices", {"vertex_subset": [2, 0]}),
    (shape(), "no vertices", {"boundary_only": True}),
])
def test_shapes(tmp_path, wrong, says, options):
    with serving(tmp_path, **deforming(wrong)) as address:
        with pytest.raises(ArapError, match=says) as refused:
            deform(address, wrong, ShapeOptions(**options))
        assert refused.value.reason is Reason.INTERNAL


def test_picks_are_counted(tmp_path):
    good = shape()
    good.picks.add(hit=True, triangle=0, barycentric=doubles(1, 0, 0))
    good.picks.add()
    with serving(tmp_path, **deforming(good)) as address:
        hit, miss = deform(address, good, picks=[(0, 0), (9, 9)]).picks
        assert hit.bary == (1, 0, 0) and miss is None
        with pytest.raises(ArapError, match="2 picks, not 1"):
            deform(address, good, picks=[(0, 0)])


def test_shapes_relative_to_an_origin(tmp_path):
    far = (5.4e6, -2.5)
    good = shape(positions=floats(0, 0, 0.25, 0, 0, 0.25), origin=doubles(*far))
    with serving(tmp_path, **deforming(good)) as address:
        told = deform(address, good, ShapeOptions(relative_to_origin=True))
        np.testing.assert_array_equal(told.positions, np.add(far, [(0, 0), (.25, 0), (0, .25)]))
        assert told.positions.dtype == np.float64
        assert told.origin == far and told.local.dtype == np.float32
        assert told.position_error == 0.25 / 2**24
    of_old = shape(positions=floats(0, 0, 4, 0, 0, 4))  # who has never heard of origins
    with serving(tmp_path, **deforming(of_old)) as address:
        told = deform(address, of_old, ShapeOptions(relative_to_origin=True))
        np.testing.assert_array_equal(told.positions, [(0, 0), (4, 0), (0, 4)])
        assert told.origin == (0, 0) and told.position_error == 4 / 2**24


def test_shapes_as_integers_and_as_bytes(tmp_path):
    good = shape(positions=b"", packed_positions=struct.pack("<6h", 0, 0, 4, 0, 0, -4), scale=0.25,
                 origin=doubles(1, 2))
    with serving(tmp_path, **deforming(good)) as address:
        told = deform(address, good, ShapeOptions(encoding="int16_le"))
        np.testing.assert_array_equal(told.positions, [(1, 2), (2, 2), (1, 1)])
        assert told.local.dtype == np.int16 and told.position_error == 0.125
    good = shape(positions=b"", packed_positions=floats(*range(6)))
    with serving(tmp_path, **deforming(good)) as address:
        told = deform(address, good, ShapeOptions(encoding="float32_le"))
        np.testing.assert_array_equal(told.positions.ravel(), range(6))


def test_shapes_of_some_vertices(tmp_path):
    good = shape(2)
    with serving(tmp_path, **deforming(good, [2, 0])) as address:
        told = deform(address, good, ShapeOptions(vertex_subset=[2, 0]))
        assert told.vertices.tolist() == [2, 0] and told.positions.shape == (2, 2)
        for options, says in ((ShapeOptions(), "some vertices"),
                              (ShapeOptions(boundary_only=True), "out of order"),
                              (ShapeOptions(vertex_subset=[0, 2]), "other vertices")):
            with pytest.raises(ArapError, match=says):
                deform(address, good, options)


@pytest.mark.parametrize("wrong, says", [
    (handle_set("a", "a"), "twice"),
    (handle_set("a", "b"), "2 handles; 1 were sent"),
    (handle_set("b"), 'handle "b", not "a"'),
    (handle_set("a", depth=floats(0, 0)), "2 depths, not 3"),
    (handle_set("a", draw_order=[1]), "every triangle once"),
])
def test_handle_sets(tmp_path, wrong, says):
    answers = deforming(GOOD)
    answers["CompileHandles"] = lambda *_: message("CompileHandlesResponse")(handle_set=wrong)
    with serving(tmp_path, **answers) as address, arapd.connect(address) as client:
        session = client.attach_session("s")
        session.register_mesh(V, T, "m")
        with pytest.raises(ArapError, match=says):
            session.compile_handles("h", "m", [arapd.Handle("a", vertex=0)])


def flattened(triangles, **fields):
    count = triangles.max() + 1
    made = message("FlattenResponse")(uv=b"\0" * 8 * count, uv_vertex=range(count),
                                      corner_uv=triangles.ravel(),
                                      triangle_chart=[0] * len(triangles))
    made.charts.add(triangle_count=len(triangles))
    for name, value in fields.items():
        made.ClearField(name)
        if isinstance(value, bytes):
            setattr(made, name, value)
        else:
            getattr(made, name).extend(value)
    return made


SURFACE = bent(3, 3)
CORNERS = SURFACE[1].ravel()


@pytest.mark.parametrize("fields, options, says", [
    ({}, {"float64": True}, "another precision"),
    ({}, {"first_step": True}, "0 positions after the first step, not 9"),
    ({}, {"singular_values": True}, "0 pairs"),
    ({"uv": b"\0" * 64}, {}, "8 flat positions for 9"),
    ({"uv": floats(*[NAN] * 18)}, {}, "not finite"),
    ({"uv_vertex": [1, 0, *range(2, 9)]}, {}, "out of their places"),
    ({"corner_uv": CORNERS[::-1]}, {}, "is not its vertex"),
    ({"corner_uv": CORNERS[:-3]}, {}, "flat triangles"),
    ({"triangle_chart": [1] * 8}, {}, "only 1"),
    ({"cut_edges": [0, 99]}, {}, "only 9"),
    ({"welded_vertex": range(9)}, {}, "welded"),
    ({"left_out_triangles": [8]}, {}, "only 8"),
    ({}, {"drawings": [arapd.DrawingOptions("svg")]}, "0 drawings, not 1"),
    ({"drawings": [message("Drawing")()]}, {"drawings": [arapd.DrawingOptions("svg")]},
     "without its files"),
])
def test_layouts(tmp_path, fields, options, says):
    answer = flattened(SURFACE[1], **fields)
    with serving(tmp_path, Flatten=lambda *_: answer) as address, arapd.connect(address) as client:
        with pytest.raises(ArapError, match=says):
            client.flatten(*SURFACE, FlattenOptions(**options))


def test_tracks(tmp_path):
    def track(*sequences):
        return lambda *_: [message("DeformTrackResponse")(shape=shape(sequence=number))
                           for number in sequences]

    for sequences, says in (((0,), "after 1 of 2 frames"), ((0, 1, 2), "more frames"),
                            ((1, 0), "frame 1 of the track where 0 was due")):
        with serving(tmp_path, DeformTrack=track(*sequences)) as address:
            with arapd.connect(address) as client, pytest.raises(ArapError, match=says):
                list(client.attach_session("s").deform_track("h", ["a"], np.zeros((2, 1, 2))))


def test_tracks_are_measured_as_often_as_was_asked(tmp_path):
    def track(*unmeasured):
        return lambda *_: [message("DeformTrackResponse")(shape=shape(sequence=i, unmeasured=one))
                           for i, one in enumerate(unmeasured)]

    def told(unmeasured, every):
        with serving(tmp_path, DeformTrack=track(*unmeasured)) as address:
            with arapd.connect(address) as client:
                return [frame.measured for frame in client.attach_session("s").deform_track(
                    "h", ["a"], np.zeros((len(unmeasured), 1, 2)),
                    options=ShapeOptions(measure_every=every))]

    assert told((False, True, False, True), 2) == [True, False, True, False]
    assert told((True, True), 0) == [False, False]
    for unmeasured in ((True, False), (False, True, True)):
        with pytest.raises(ArapError, match="without the measures"):
            told(unmeasured, 2)


def test_bytes_that_are_no_message(tmp_path):
    with serving(tmp_path, GetServerInfo=lambda *_: b"\xff\xff") as address:
        with arapd.connect(address) as client, pytest.raises(ArapError, match="no message"):
            client.server_info()


def test_large_answers_arrive(tmp_path):
    """Larger than the 4 MiB at which grpc stops by itself."""
    answer = shape(4_000_000)
    with serving(tmp_path, Deform=lambda *_: message("DeformResponse")(shape=answer)) as address:
        with arapd.connect(address) as client:
            told = client.attach_session("s").deform("h", {})
            assert told.positions.nbytes == 32_000_000


def test_every_call_says_who_and_where(tmp_path):
    seen = {}

    def info(_, context):
        seen.update(context.invocation_metadata())
        return message("GetSessionResponse")(session=message("Session")(session_id="s"))

    trace = f"00-{'a' * 32}-{'b' * 16}-01"
    with serving(tmp_path, GetSession=info) as address:
        with arapd.connect(address, token="t", user="u") as client:
            client.attach_session("s").info(traceparent=trace)
    assert seen["x-session-id"] == "s"
    assert seen["authorization"] == "Bearer t" and seen["x-arapd-owner"] == "u"
    assert seen["traceparent"] == trace and len(seen["x-request-id"]) == 32
