"""Answers about sessions, meshes and handles: checked against what was asked, as the values
that this package hands out."""

from __future__ import annotations

import datetime
from collections.abc import Iterable
from typing import Any, NamedTuple

from . import _checks as check
from . import _wire
from . import model
from .faults import refuse

_BASES = {number: name.removeprefix("BASIS_").lower()
          for name, number in _wire.enum_names("Basis").items() if number}
_WEIGHTS = {number: name.removeprefix("EDGE_WEIGHTS_").lower()
            for name, number in _wire.enum_names("EdgeWeights").items() if number}
_MOST_SESSIONS = 1000


class MeshSize(NamedTuple):
    vertices: int
    triangles: int | None  # None: not known


class KnownSizes:
    """How large the meshes of a session are, as far as this side has seen them."""

    def __init__(self) -> None:
        self._meshes: dict[str, MeshSize] = {}
        self._sets: dict[str, str] = {}

    def know(self, mesh_id: str, size: MeshSize) -> None:
        self._meshes[mesh_id] = size

    def forget(self, mesh_id: str) -> None:
        self._meshes.pop(mesh_id, None)

    def know_set(self, set_id: str, mesh_id: str) -> None:
        self._sets[set_id] = mesh_id

    def forget_set(self, set_id: str) -> None:
        self._sets.pop(set_id, None)

    def of_mesh(self, mesh_id: str | None) -> MeshSize | None:
        return None if mesh_id is None else self._meshes.get(mesh_id)

    def of_set(self, set_id: str) -> MeshSize | None:
        return self.of_mesh(self._sets.get(set_id))


def seconds(duration: Any) -> float:
    return float(duration.seconds + 1e-9 * duration.nanos)


def warnings(messages: Iterable[Any]) -> tuple[model.Warning, ...]:
    return tuple(model.Warning(m.kind, m.count, tuple(m.elements), m.message) for m in messages)


def mesh_info(message: Any, mesh_id: str | None, size: MeshSize | None) -> model.MeshInfo:
    """`size`: of the mesh that was sent."""
    check.name(message.mesh_id, mesh_id, "mesh")
    if size is not None:
        check.count(message.vertex_count, size.vertices, "vertices")
        if size.triangles is not None:
            check.count(message.triangle_count, size.triangles, "triangles")
    check.finite((message.area, message.diagonal), "a mesh")
    repair = message.repair
    return model.MeshInfo(
        message.mesh_id, message.content_hash, message.vertex_count, message.triangle_count,
        message.edge_count, message.component_count, message.boundary_loop_count, message.area,
        message.diagonal, warnings(message.warnings), message.bytes,
        _BASES.get(message.energy.basis, ""), _WEIGHTS.get(message.energy.weights, ""),
        model.Repair(repair.weld, repair.drop_duplicates, repair.stitch,
                     repair.tolerance if repair.HasField("tolerance") else None))


def handle_set(message: Any, set_id: str, mesh_id: str | None, sizes: KnownSizes,
               last: list[str], all_of_them: bool = False) -> model.HandleSet:
    """The set has this id, is on that mesh, and behind other handles has those of `last`."""
    check.name(message.handle_set_id, set_id, "handle set")
    check.name(message.mesh_id, mesh_id, "mesh")
    handles = []
    for handle in message.handles:
        check.name(handle.handle_id, None, "handle")
        rest = (handle.rest.x, handle.rest.y)
        check.finite((*rest, handle.snapped_distance), "a handle")
        handles.append(model.PlacedHandle(handle.handle_id, rest, handle.snapped_distance,
                                          handle.component))
    ids = [handle.id for handle in handles]
    if len(set(ids)) != len(ids):
        refuse("a handle twice.")
    if len(ids) < len(last) or (all_of_them and len(ids) != len(last)):
        refuse(f"a set of {len(ids)} handles; {len(last)} were sent.")
    for answered, asked in zip(ids[len(ids) - len(last):], last):
        check.name(answered, asked, "handle")
    depth = check.run(message, "depth", "depths")
    check.finite(depth.tolist(), "the depths")
    draw_order = check.indices(message.draw_order, None, "triangle")
    check.order(draw_order)
    size = sizes.of_mesh(message.mesh_id)
    if size is not None and depth.size:
        check.count(depth.size, size.vertices, "depths")
    if size is not None and size.triangles is not None and draw_order.size:
        check.count(draw_order.size, size.triangles, "triangles in drawing order")
    sizes.know_set(message.handle_set_id, message.mesh_id)
    return model.HandleSet(
        message.handle_set_id, message.mesh_id, tuple(handles), message.row_count, message.bytes,
        warnings(message.warnings), depth, draw_order, message.revision,
        message.resting_components, message.translating_components)


def _time(timestamp: Any) -> datetime.datetime:
    epoch = datetime.datetime(1970, 1, 1, tzinfo=datetime.timezone.utc)
    try:
        return epoch + datetime.timedelta(seconds=timestamp.seconds,
                                          microseconds=timestamp.nanos // 1000)
    except OverflowError:
        refuse("a time that no calendar has.")


def session_info(message: Any, session_id: str | None) -> model.SessionInfo:
    check.name(message.session_id, session_id, "session")
    for mesh_id in message.mesh_ids:
        check.name(mesh_id, None, "mesh")
    for set_id in message.handle_set_ids:
        check.name(set_id, None, "handle set")
    return model.SessionInfo(
        message.session_id, _time(message.create_time), _time(message.expire_time),
        datetime.timedelta(seconds=seconds(message.ttl)), dict(message.labels),
        tuple(message.mesh_ids), tuple(message.handle_set_ids))


def session_page(message: Any, page_size: int, page_token: str) -> model.SessionPage:
    most = page_size or _MOST_SESSIONS
    if len(message.sessions) > most:
        refuse(f"{len(message.sessions)} sessions; {most} were asked.")
    if message.next_page_token and message.next_page_token == page_token:
        refuse("a page of sessions that leads back to itself.")
    return model.SessionPage(tuple(session_info(m, None) for m in message.sessions),
                             message.next_page_token)


def server_info(message: Any) -> model.ServerInfo:
    limits = {}
    for field in message.limits.DESCRIPTOR.fields:
        value = getattr(message.limits, field.name)
        limits[field.name] = seconds(value) if field.message_type is not None else value
    return model.ServerInfo(message.version, limits, frozenset(message.capabilities),
                            message.workers)


def outline_mesh(message: Any) -> model.OutlineMesh:
    vertices = check.points(message.mesh, "vertices", 2, "vertex")
    triangles = check.groups(check.indices(message.mesh.triangles, len(vertices), "vertex"), 3,
                             "triangles")
    a, b, c = (vertices[triangles[:, corner]] for corner in range(3))
    twice = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    if not (twice > 0).all():
        refuse("a triangle that does not run counter-clockwise.")
    check.finite((message.smallest_angle_degrees, message.outline_error), "a mesh")
    return model.OutlineMesh(vertices, triangles, message.piece_count, message.hole_count,
                             message.smallest_angle_degrees, message.outline_error,
                             seconds(message.queue_time), seconds(message.solve_time))
