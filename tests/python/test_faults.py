"""Every fault is an ArapError with what the server says of it; nothing else is raised."""

import math
import pickle
import re

import grpc
import numpy as np
import pytest

import arapd
import arapd.aio
from arapd import ArapError, FlattenOptions, Handle, Reason
from support import ROOT, Server, bent, grid

Code = grpc.StatusCode
V, T = grid()
NAN = math.nan


def registering(vertices=V, triangles=T, **options):
    return lambda session: session.register_mesh(vertices, triangles, "m", **options)


def compiling(*handles):
    return lambda session: (registering()(session), session.compile_handles("h", "m", handles))


def deforming(targets, **options):
    def act(session):
        compiling(Handle("l", vertex=0), Handle("r", vertex=8))(session)
        session.deform("h", targets, arapd.ShapeOptions(**options))
    return act


def with_vertex(at, value):
    changed = V.copy()
    changed[at] = value
    return changed


def with_triangle(at, value):
    changed = T.copy()
    changed[at] = value
    return changed


def conflicting(session):
    compiling(Handle("a", vertex=0, hard=True), Handle("b", vertex=0, hard=True))(session)
    session.deform("h", {"a": (0, 0), "b": (1, 0)})


def registered_twice(session):
    registering()(session)
    registering(V * 2)(session)


# What is done in a session; the reason, the code, the field and the elements that come of it.
CASES = [
    (registering(V[:0], T[:0]), Reason.EMPTY_MESH, Code.INVALID_ARGUMENT, None, None),
    (registering(with_vertex(3, NAN)), Reason.NON_FINITE_COORDINATE, Code.INVALID_ARGUMENT, None, 3),
    (registering(V, with_triangle(5, (0, 1, 99))), Reason.INDEX_OUT_OF_RANGE, Code.INVALID_ARGUMENT,
     None, 5),
    (registering(V, with_triangle(5, (0, 1, 1))), Reason.REPEATED_INDEX, Code.INVALID_ARGUMENT, None,
     5),
    (registering(V, with_triangle(5, (0, 1, 2))), Reason.DEGENERATE_TRIANGLE, Code.INVALID_ARGUMENT,
     None, 5),
    (registering(V, with_triangle(5, T[4])), Reason.DUPLICATE_TRIANGLE, Code.INVALID_ARGUMENT, None,
     4),
    (registering(energy=arapd.Energy(rigidity=[1.0])), Reason.ARRAY_LENGTH, Code.INVALID_ARGUMENT,
     "energy.rigidity", None),
    (registering(energy=arapd.Energy(rigidity=np.zeros(len(T)))), Reason.INVALID_OPTION,
     Code.INVALID_ARGUMENT, None, None),
    (registered_twice, Reason.ALREADY_EXISTS, Code.ALREADY_EXISTS, None, None),
    (compiling(Handle("a", position=(99, 99))), Reason.HANDLE_OUTSIDE, Code.INVALID_ARGUMENT,
     "handles[0]", None),
    (compiling(Handle("a", vertex=0), Handle("a", vertex=1)), Reason.DUPLICATE_HANDLE,
     Code.INVALID_ARGUMENT, "handles[1]", None),
    (compiling(Handle("a", vertex=999)), Reason.INDEX_OUT_OF_RANGE, Code.INVALID_ARGUMENT,
     "handles[0]", None),
    (compiling(Handle("a b", vertex=0)), Reason.INVALID_NAME, Code.INVALID_ARGUMENT, "handles[0]",
     None),
    (compiling(Handle("a", vertex=0, weight=-1)), Reason.INVALID_OPTION, Code.INVALID_ARGUMENT,
     "handles[0].weight", None),
    (compiling(*(Handle(f"h{i}", vertex=0) for i in range(1001))), Reason.TOO_MANY_HANDLES,
     Code.RESOURCE_EXHAUSTED, None, None),
    (conflicting, Reason.CONFLICTING_HANDLES, Code.INVALID_ARGUMENT, None, None),
    (deforming({"l": (0, 0)}), Reason.TARGET_COUNT, Code.INVALID_ARGUMENT, None, None),
    (deforming({"l": (0, 0), "x": (0, 0)}), Reason.UNKNOWN_HANDLE, Code.NOT_FOUND, "targets[1]",
     None),
    (deforming({"l": (0, NAN), "r": (8, 0)}), Reason.NON_FINITE_TARGET, Code.INVALID_ARGUMENT,
     "targets[0]", None),
    (deforming({"l": (0, 0), "r": (8, 0)}, refine=9999), Reason.INVALID_OPTION,
     Code.INVALID_ARGUMENT, "options.refine", None),
    (deforming({"l": (0, 0), "r": (1e300, 0)}), Reason.NUMERICAL, Code.INTERNAL, None, None),
    (lambda session: session.get_mesh("none"), Reason.NOT_FOUND, Code.NOT_FOUND, None, None),
    (lambda session: session.open_stream("none"), Reason.NOT_FOUND, Code.NOT_FOUND, None, None),
    (lambda session: list(session.deform_track("none", ["a"], [[[0, 0]]])), Reason.NOT_FOUND,
     Code.NOT_FOUND, None, None),
    (lambda session: session.wait_job("none"), Reason.NOT_FOUND, Code.NOT_FOUND, None, None),
]


def check(error, reason, code, field, element):
    assert (error.reason, error.code) == (reason, code), error
    assert error.message.endswith(".") and str(error) == f"{reason.value}: {error.message}"
    assert error.details["request_id"]
    if field is not None:
        assert error.field.startswith(field)
    if element is not None:
        assert element in error.elements
    assert (error.retry_after is not None) == (code is Code.RESOURCE_EXHAUSTED)
    again = pickle.loads(pickle.dumps(error))
    assert vars(again) == vars(error)


@pytest.mark.parametrize("act, reason, code, field, element", CASES,
                         ids=[f"{case[1].value}-{number}" for number, case in enumerate(CASES)])
def test_what_the_server_refuses(session, act, reason, code, field, element):
    with pytest.raises(ArapError) as refused:
        act(session)
    check(refused.value, reason, code, field, element)


def closed_surface():
    corners = np.array([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return corners, [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]


@pytest.mark.parametrize("surface, options, reason", [
    (closed_surface(), FlattenOptions(), Reason.NOT_A_DISK),
    (bent(), FlattenOptions(seams=[(0, 44)]), Reason.UNKNOWN_EDGE),
    (bent(), FlattenOptions(energy=arapd.Energy("vertex")), Reason.INVALID_OPTION),
    (bent(), FlattenOptions(pins=[arapd.Pin(99, 0, 0)]), Reason.INDEX_OUT_OF_RANGE),
], ids=lambda value: getattr(value, "value", None))
def test_what_cannot_be_flattened(client, session, surface, options, reason):
    with pytest.raises(ArapError) as refused:
        client.flatten(*surface, options)
    assert refused.value.reason is reason
    with pytest.raises(ArapError) as refused:  # a job says the same, at once or as its result
        session.submit_flatten("job", *surface, options)
        assert session.wait_job("job").state == "failed"
        session.job_result("job", *surface, options)
    assert refused.value.reason is reason


def test_the_reasons_are_those_of_the_wire():
    text = (ROOT / "proto/arap/v1/errors.proto").read_text()
    named = set(re.findall(r"ERROR_REASON_([A-Z_]+) = [1-9]", text))
    assert named == {reason.value for reason in Reason}


def test_nobody_is_there(tmp_path):
    with arapd.connect(f"unix:{tmp_path}/nobody") as client:
        with pytest.raises(ArapError) as gone:
            client.server_info(retry_within=0.2)
        assert (gone.value.reason, gone.value.code) == (Reason.DRAINING, Code.UNAVAILABLE)
        with pytest.raises(ArapError) as late:
            client.wait_ready(0.1)
        assert late.value.reason is Reason.DEADLINE_EXCEEDED


def test_limits_and_time(tmp_path):
    with Server(tmp_path, "--max-sessions", "1", "--max-vertices", "50") as server:
        with arapd.connect(server.address) as client, client.create_session() as session:
            with pytest.raises(ArapError) as full:
                client.create_session(retry_within=0)
            assert full.value.reason is Reason.LIMIT_EXCEEDED
            assert full.value.details["quota"] and full.value.retry_after > 0
            with pytest.raises(ArapError) as large:
                session.register_mesh(V, T)
            assert large.value.reason is Reason.MESH_TOO_LARGE
            assert large.value.retry_after == 3600
            server.freeze()
            with pytest.raises(ArapError) as late:
                session.info(timeout=0.1)
            server.thaw()
            assert late.value.reason is Reason.DEADLINE_EXCEEDED


def test_calls_that_were_lost_are_made_again(tmp_path):
    with Server(tmp_path) as server, arapd.connect(server.address) as client:
        session = client.create_session()
        session.register_mesh(V, T, "m")
        server.kill()
        server.start()
        assert session.info(retry_within=60).mesh_ids == ("m",)
        session.delete(retry_within=60)


@pytest.mark.parametrize("wrong", [
    lambda session: session.register_mesh(np.zeros((3, 3)), T),
    lambda session: session.register_mesh(V, T[:, :2]),
    lambda session: session.register_mesh(V, T, energy=arapd.Energy("edges")),
    lambda session: session.register_mesh(V, -T),
    lambda session: session.compile_handles("h", "m", [Handle("a")]),
    lambda session: session.compile_handles("h", "m", [Handle("a", vertex=1, position=(0, 0))]),
    lambda session: session.deform("h", {"a": (1,)}),
    lambda session: session.deform_track("h", ["a"], np.zeros((3, 2, 2))),
    lambda session: session.open_stream("h", arapd.StreamOptions(delivery="some")),
])
def test_what_is_no_array_or_choice_is_not_sent(session, wrong):
    with pytest.raises(ValueError):
        wrong(session)
    with pytest.raises(TypeError):
        session.register_mesh(V, T.astype(float))


@pytest.mark.parametrize("options, field", [
    ({"token": "t"}, "token"), ({"token": "t t"}, "token"), ({"certificate": "c"}, "key"),
    ({"key": "k"}, "certificate"), ({"user": "a/b"}, "user"),
    ({"root_certificates": "/nowhere"}, "root_certificates"),
])
def test_options_of_a_connection(options, field):
    for connect in (arapd.connect, arapd.aio.connect):
        with pytest.raises(ArapError) as wrong:
            connect("example.org:50051", **options)
        assert (wrong.value.reason, wrong.value.field) == (Reason.INVALID_OPTION, field)
    assert "secret" not in repr(arapd.ConnectOptions(token="secret"))
