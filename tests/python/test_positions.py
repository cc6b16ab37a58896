"""How positions come: relative to an origin, as bytes or integers, of some vertices."""

import asyncio

import numpy as np
import pytest

import arapd
import arapd.aio
from arapd import Handle, Reason, ShapeOptions
from support import grid

FAR = np.array([500_000.0, 5_400_000.0])
VERTICES, TRIANGLES = grid()
BOUNDARY = np.flatnonzero((VERTICES % 8 == 0).any(axis=1))
TARGETS = {"l": FAR, "r": FAR + (8, 3)}


@pytest.fixture
def puppet(session):
    """Far from 0, where 32-bit floats are half a unit apart."""
    session.register_mesh(VERTICES + FAR, TRIANGLES, "m")
    session.compile_handles("h", "m", [Handle("l", vertex=0), Handle("r", vertex=8)])
    return session


@pytest.mark.parametrize("options, tolerance, bytes_of_vertex", [
    (ShapeOptions(), 0.5, 8),
    (ShapeOptions(encoding="float32"), 0.5, 8),
    (ShapeOptions(encoding="float32_le"), 0.5, 8),
    (ShapeOptions(relative_to_origin=True), 1e-5, 8),
    (ShapeOptions(relative_to_origin=True, encoding="float32_le"), 1e-5, 8),
    (ShapeOptions(relative_to_origin=True, float64=True), 0, 16),
    (ShapeOptions(encoding="int16_le"), 16 / 65534, 4),
    (ShapeOptions(boundary_only=True, relative_to_origin=True), 1e-5, 8),
    (ShapeOptions(boundary_only=True, encoding="int16_le"), 16 / 65534, 4),
    (ShapeOptions(vertex_subset=[80, 0, 8], float64=True), 0, 16),
    (ShapeOptions(vertex_subset=np.array([7]), encoding="int16_le"), 1e-5, 4),
])
def test_shapes_tracks_and_streams(puppet, options, tolerance, bytes_of_vertex):
    exact = puppet.deform("h", TARGETS, ShapeOptions(float64=True)).positions
    which = np.arange(81)
    if options.boundary_only:
        which = BOUNDARY
    elif options.vertex_subset is not None:
        which = np.asarray(options.vertex_subset)
    deformed = puppet.deform("h", TARGETS, options)
    tracked = list(puppet.deform_track("h", ["l", "r"], [list(TARGETS.values())] * 2,
                                       options=options))
    with puppet.open_stream("h", arapd.StreamOptions(shape=options)) as stream:
        stream.send(TARGETS)
        streamed = stream.read()
    for shape in (deformed, *tracked, streamed):
        assert (shape.vertices is None) == (len(which) == 81)
        if shape.vertices is not None:
            np.testing.assert_array_equal(shape.vertices, which)
        np.testing.assert_allclose(shape.positions, exact[which], rtol=0, atol=tolerance)
        assert np.abs(shape.positions - exact[which]).max() <= shape.position_error * 1.001 + 1e-9
        assert shape.position_error <= tolerance
        assert shape.local.nbytes == bytes_of_vertex * len(which)
        has_origin = options.encoding == "int16_le" or (options.relative_to_origin
                                                        and not options.float64)
        assert (shape.origin != (0, 0)) == has_origin
        if has_origin:
            assert shape.positions.dtype == np.float64


def test_with_asyncio(server, puppet):
    async def run():
        async with arapd.aio.connect(server.address) as client:
            session = client.attach_session(puppet.id)
            options = ShapeOptions(relative_to_origin=True, boundary_only=True)
            async with session.open_stream("h", arapd.StreamOptions(shape=options)) as stream:
                await stream.send(TARGETS)
                return await stream.read()

    shape = asyncio.run(asyncio.wait_for(run(), 200))
    np.testing.assert_array_equal(shape.vertices, BOUNDARY)
    exact = puppet.deform("h", TARGETS, ShapeOptions(float64=True)).positions[BOUNDARY]
    np.testing.assert_allclose(shape.positions, exact, rtol=0, atol=1e-5)


@pytest.mark.parametrize("options, reason", [
    (ShapeOptions(vertex_subset=[81]), Reason.INDEX_OUT_OF_RANGE),
    (ShapeOptions(vertex_subset=[1, 1]), Reason.REPEATED_INDEX),
    (ShapeOptions(vertex_subset=[1], boundary_only=True), Reason.INVALID_OPTION),
    (ShapeOptions(encoding="int16_le", float64=True), Reason.INVALID_OPTION),
])
def test_what_does_not_go_together(puppet, options, reason):
    with pytest.raises(arapd.ArapError) as refused:
        puppet.deform("h", TARGETS, options)
    assert refused.value.reason is reason
    assert refused.value.field.startswith("options.")
