"""From a mesh to shapes and layouts, blocking."""

import datetime

import numpy as np
import pytest

import arapd
from arapd import Handle
from support import bent, grid


def test_a_mesh_becomes_shapes(session):
    vertices, triangles = grid()
    registration = session.register_mesh(vertices, triangles)
    mesh = registration.mesh
    assert (mesh.vertex_count, mesh.triangle_count, mesh.area) == (81, 128, 64)
    assert (mesh.basis, mesh.weights) == ("edge", "uniform")
    assert session.get_mesh(mesh.id).content_hash == mesh.content_hash
    compilation = session.compile_handles("h", mesh.id, [
        Handle("l", vertex=0), Handle("r", position=(8, 0)),
        Handle("t", triangle=127, bary=(1, 0, 0), hard=True)])
    assert [handle.id for handle in compilation.handle_set.handles] == ["l", "r", "t"]
    shape = session.deform("h", {"l": (0, 0), "r": 8 + 0j, "t": arapd.Target(7, 7)})
    assert shape.positions.shape == (81, 2)
    assert shape.positions.dtype == np.float32
    np.testing.assert_allclose(shape.positions, vertices, atol=1e-5)
    assert not shape.positions.flags.writeable
    assert shape.flipped_count == 0 and shape.worst_handle_error < 1e-5
    edited = session.edit_handles("h", remove=["t"], add=[Handle("u", vertex=80)]).handle_set
    assert [handle.id for handle in edited.handles] == ["l", "r", "u"]
    assert session.get_handle_set("h").revision == edited.revision > compilation.handle_set.revision
    session.delete_handle_set("h")
    session.delete_mesh(mesh.id)
    assert session.info().mesh_ids == ()


def test_double_precision_picks_and_flips(session):
    session.register_mesh(*grid(), "m")
    session.compile_handles("h", "m", [Handle("l", vertex=0), Handle("r", vertex=8)])
    options = arapd.ShapeOptions(float64=True, flipped_ids=True, refine=2)
    targets = {"l": (0, 0), "r": (8, 0)}
    shape = session.deform("h", targets, options, picks=[(4.25, 4.5), (99, 99)])
    assert shape.positions.dtype == np.float64
    assert shape.flipped_ids.size == shape.flipped_count
    hit, miss = shape.picks
    assert miss is None
    np.testing.assert_allclose(hit.rest, (4.25, 4.5), atol=1e-6)
    assert sum(hit.bary) == pytest.approx(1)


def test_depths_give_a_drawing_order(session):
    session.register_mesh(*grid(), "m")
    handle_set = session.compile_handles("h", "m", [
        Handle("l", vertex=0, depth=1, depth_falloff=2), Handle("r", vertex=8)]).handle_set
    assert handle_set.depth.shape == (81,)
    assert sorted(handle_set.draw_order) == list(range(128))


def test_energies_and_repairs(session):
    vertices, triangles = grid()
    doubled = np.concatenate([triangles, triangles[:1]])
    registration = session.register_mesh(
        vertices, doubled, "m", energy=arapd.Energy("face", "cotangent", np.ones(len(doubled))),
        repair=arapd.Repair(drop_duplicates=True))
    assert (registration.mesh.basis, registration.mesh.weights) == ("face", "cotangent")
    assert registration.mesh.repair == arapd.Repair(drop_duplicates=True)
    assert [warning.kind for warning in registration.mesh.warnings] == ["dropped_triangles"]


def test_a_track(session):
    session.register_mesh(*grid(), "m")
    session.compile_handles("h", "m", [Handle("l", vertex=0), Handle("r", vertex=8, oriented=True)])
    positions = np.tile([[8.0, 0], [0, 0]], (5, 1, 1))
    positions[:, 0, 1] = range(5)
    shapes = list(session.deform_track("h", ["r", "l"], positions, angles=np.zeros((5, 2)),
                                       scales=np.ones((5, 2))))
    assert [shape.sequence for shape in shapes] == list(range(5))
    for number, shape in enumerate(shapes):
        np.testing.assert_allclose(shape.positions[8], (8, number), atol=1e-2)


def test_a_track_may_be_left(session):
    session.register_mesh(*grid(), "m")
    session.compile_handles("h", "m", [Handle("l", vertex=0)])
    for shape in session.deform_track("h", ["l"], np.zeros((1000, 1, 2))):
        if shape.sequence == 3:
            break
    assert session.deform("h", {"l": (0, 0)}).positions.shape == (81, 2)


def test_a_surface_is_laid_flat(client, session):
    vertices, triangles = bent()
    options = arapd.FlattenOptions(first_step=True, singular_values=True, float64=True)
    flat = client.flatten(vertices, triangles, options)
    assert flat.uv.shape == flat.first_step_uv.shape == (81, 2)
    assert flat.uv.dtype == np.float64
    np.testing.assert_array_equal(flat.corner_uv, triangles)
    np.testing.assert_array_equal(flat.uv_vertex, range(81))
    assert flat.distortion.arap_energy < 1e-4 and flat.distortion.scale == 1
    np.testing.assert_allclose(flat.singular_values, 1, atol=1e-2)
    assert len(flat.charts) == 1 and flat.charts[0].triangle_count == 128
    assert len(flat.charts[0].loops[0]) == 32
    assert flat.charts[0].refine_end == "converged"
    # The same as a job.
    assert session.submit_flatten("job", vertices, triangles, options).id == "job"
    states = [job.state for job in session.watch_job("job")]
    assert states[-1] == "done"
    assert session.wait_job("job").ended
    result = session.job_result("job", vertices, triangles, options)
    np.testing.assert_array_equal(result.uv, flat.uv)
    assert session.cancel_job("job").state == "done"


def test_seams_pins_and_grain_lines(client):
    vertices, triangles = bent()
    middle = [40, 41, 42, 43, 44]
    options = arapd.FlattenOptions(
        method="arap_face", anchors="far_boundary", seams=np.stack([middle[:-1], middle[1:]], 1),
        pins=[arapd.Pin(0, 5, 6, 0), arapd.Pin(80, 13, 14, 1e-3)], surface_key="bent", refine=3,
        refine_stop=0)
    flat = client.flatten(vertices, triangles, options)
    assert len(flat.uv) > len(vertices)
    np.testing.assert_allclose(flat.uv[0], (5, 6), atol=1e-5)
    assert flat.cut_edges.shape == (4, 2) and flat.auto_cut_count == 0
    assert client.flatten(vertices, triangles, options).surface_cached
    lines = arapd.FlattenOptions(grain_lines=[arapd.GrainLine(0, 8, 90)])
    along = client.flatten(vertices, triangles, lines).uv
    assert along[8][0] == pytest.approx(along[0][0], abs=1e-4)


def test_layouts_are_drawn(client):
    flat = client.flatten(*bent(), arapd.FlattenOptions(parts=[(0, "sleeve")], drawings=[
        arapd.DrawingOptions("dxf", millimetres_per_unit=10, allowance=10, corners="round"),
        arapd.DrawingOptions("svg", paper="A5", overlap=5, margin=8, millimetres_per_unit=30)]))
    dxf, pages = flat.drawings
    assert [file.page for file in dxf.files] == [""]
    assert b"SECTION" in dxf.files[0].data and b"CUT" in dxf.files[0].data
    assert pages.files[0].page == "cover" and len(pages.files) > 2
    assert all(b"<svg" in file.data for file in pages.files)


def test_outlines_become_a_mesh(client, session):
    square = np.array([(0, 0), (10, 0), (10, 10), (0, 10)], float)
    mesh = client.mesh_outline([square, square / 2 + 2.5], 200)
    assert (mesh.piece_count, mesh.hole_count) == (1, 1)
    assert mesh.smallest_angle_degrees >= 20
    assert mesh.outline_error == 0
    assert session.register_mesh(mesh.vertices, mesh.triangles).mesh.area == pytest.approx(75)
    grown = client.mesh_outline([square, square / 2 + 2.5], tolerance=0.1, expansion=3)
    assert (grown.piece_count, grown.hole_count) == (1, 0)
    assert 0 < grown.outline_error < 0.2
    area = session.register_mesh(grown.vertices, grown.triangles).mesh.area
    assert area == pytest.approx(100 + 4 * 10 * 3 + np.pi * 9, rel=0.02)


def test_sessions(client):
    session = client.create_session(ttl=datetime.timedelta(seconds=90), labels={"for": "a test"})
    info = session.info()
    assert info.ttl == datetime.timedelta(seconds=90)
    assert info.labels == {"for": "a test"}
    assert info.expire_time > info.create_time
    assert session.id in [known.id for known in client.list_sessions(1000).sessions]
    with client.attach_session(session.id) as attached:
        assert attached.info().id == session.id
    with session:
        pass
    with pytest.raises(arapd.ArapError) as gone:
        session.info()
    assert gone.value.reason is arapd.Reason.NOT_FOUND


def test_what_the_server_is(client):
    client.wait_ready(60)
    info = client.server_info()
    assert info.limits["max_vertices"] == 1_000_000
    assert info.limits["max_ttl"] == 24 * 3600
    assert "stream.latest" in info.capabilities
    assert info.workers > 0
