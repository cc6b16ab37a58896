"""Requests of the wire from what calls take. Nothing is checked here but types and shapes of arrays:
the server checks, and names what is wrong."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _wire
from .model import (DrawingOptions, Energy, FlattenOptions, Handle, Repair, ShapeOptions, Target,
                    Targets)

message = _wire.message
_HandleTarget = message("HandleTarget")


def choice(enumeration: str, prefix: str, name: str | None, what: str) -> int:
    """The number of a value that is named in lower case without its prefix; None: unspecified."""
    names = _wire.enum_names(enumeration)
    if name is None:
        return 0
    number = names.get(f"{prefix}_{name.upper()}", 0)
    if number == 0:
        known = sorted(known.removeprefix(f"{prefix}_").lower()
                       for known, number in names.items() if number != 0)
        raise ValueError(f"{what} is {name!r}; it has to be one of {', '.join(known)}.")
    return number


def point_array(points: ArrayLike, columns: int, name: str, dtype: str = "<f8") -> NDArray[Any]:
    """`points` as an array of so many columns, or ValueError; complex numbers are two."""
    array = np.asarray(points)
    if columns == 2 and np.iscomplexobj(array):
        array = np.stack([array.real, array.imag], axis=-1)
    if array.size == 0:
        array = array.reshape(0, columns)
    if array.ndim != 2 or array.shape[1] != columns:
        raise ValueError(f"{name} has the shape {array.shape}; it has to be n×{columns}.")
    return np.ascontiguousarray(array, dtype)


def triangle_array(triangles: Any, name: str = "triangles") -> NDArray[Any]:
    return _indices(triangles, 3, name)


def _indices(values: Any, columns: int, name: str) -> NDArray[Any]:
    array = np.asarray(values)
    if array.size and not np.issubdtype(array.dtype, np.integer):
        raise TypeError(f"{name} holds {array.dtype}; it has to hold integers.")
    array = point_array(array, columns, name, "<i8")
    if array.size and (array.min() < 0 or array.max() > 0xFFFFFFFF):
        raise ValueError(f"{name} holds a number that is no index.")
    return array


def set_mesh(out: Any, vertices: Any, triangles: Any, dimensions: int) -> None:
    out.vertices = _wire.packed(point_array(vertices, dimensions, "vertices"))
    out.triangles.extend(triangle_array(triangles).ravel().tolist())


def set_energy(out: Any, energy: Energy) -> None:
    out.basis = choice("Basis", "BASIS", energy.basis, "basis")
    out.weights = choice("EdgeWeights", "EDGE_WEIGHTS", energy.weights, "weights")
    if energy.rigidity is not None:
        out.rigidity = _wire.packed(np.asarray(energy.rigidity, float).ravel())


def set_repair(owner: Any, repair: Repair) -> None:
    if repair == Repair():
        return
    owner.repair.weld = repair.weld
    owner.repair.drop_duplicates = repair.drop_duplicates
    owner.repair.stitch = repair.stitch
    if repair.tolerance is not None:
        owner.repair.tolerance = repair.tolerance


def set_handle(out: Any, handle: Handle) -> None:
    out.handle_id = handle.id
    given = [handle.vertex is not None, handle.position is not None, handle.triangle is not None]
    if sum(given) != 1 or (handle.triangle is None) != (handle.bary is None):
        raise ValueError(f"The handle {handle.id!r} needs one of vertex, position, and triangle "
                         "with bary.")
    if handle.vertex is not None:
        out.vertex = handle.vertex
    elif handle.position is not None:
        out.position.x, out.position.y = (float(value) for value in handle.position)
        out.position.SetInParent()
    else:
        out.triangle_point.triangle = handle.triangle
        out.triangle_point.barycentric = _wire.packed(handle.bary)
    if handle.weight is not None:
        out.weight = handle.weight
    out.hard = handle.hard
    out.oriented = handle.oriented
    out.area_radius = handle.area_radius
    out.outside = choice("OutsidePolicy", "OUTSIDE_POLICY", "snap" if handle.snap else None, "")
    out.depth = handle.depth
    out.depth_falloff = handle.depth_falloff


def target_of(given: Any) -> Target:
    if isinstance(given, Target):
        return given
    if isinstance(given, complex):
        return Target(given.real, given.imag)
    values = [float(value) for value in given]
    if not 2 <= len(values) <= 4:
        raise ValueError(f"A target has {len(values)} numbers; it has x, y, angle and scale, or "
                         "the first two or three of them.")
    return Target(*values)


def targets_of(targets: Targets) -> dict[str, Target]:
    return {handle: target_of(target) for handle, target in targets.items()}


def target_message(handle: str, target: Target) -> Any:
    out = _HandleTarget(handle_id=handle, x=target.x, y=target.y, angle_radians=target.angle)
    if target.scale != 1:
        out.scale = target.scale
    return out


def set_shape_options(out: Any, options: ShapeOptions) -> None:
    out.mode = choice("DeformMode", "DEFORM_MODE", options.mode, "mode")
    out.refine = options.refine
    out.float64 = options.float64
    out.include_flipped_ids = options.flipped_ids
    out.measure_every = options.measure_every
    out.relative_to_origin = options.relative_to_origin
    out.encoding = choice("PositionEncoding", "POSITION_ENCODING", options.encoding, "encoding")
    out.boundary_only = options.boundary_only
    if options.vertex_subset is not None:
        subset = _indices(np.reshape(options.vertex_subset, (-1, 1)), 1, "vertex_subset")
        out.vertex_subset.extend(subset.ravel().tolist())


def track_frames(handle_ids: Sequence[str], positions: Any, angles: Any,
                 scales: Any) -> list[dict[str, Any]]:
    """The fields of each TrackFrame."""
    positions = np.asarray(positions)
    if np.iscomplexobj(positions):
        positions = np.stack([positions.real, positions.imag], axis=-1)
    columns = len(handle_ids)
    if positions.ndim != 3 or positions.shape[1:] != (columns, 2):
        raise ValueError(f"positions has the shape {positions.shape}; it has to be "
                         f"frames×{columns}×2.")
    frames = [{"positions": _wire.packed(frame)} for frame in positions]
    for name, values in (("angles_radians", angles), ("scales", scales)):
        if values is None:
            continue
        values = np.asarray(values, float)
        if values.shape != (len(frames), columns):
            raise ValueError(f"{name} has the shape {values.shape}; it has to be "
                             f"{len(frames)}×{columns}.")
        for frame, row in zip(frames, values):
            frame[name] = _wire.packed(row)
    return frames


def set_flatten(out: Any, vertices: Any, triangles: Any, options: FlattenOptions) -> None:
    set_mesh(out.mesh, vertices, triangles, 3)
    set_energy(out.energy, options.energy)
    out.method = choice("FlattenMethod", "FLATTEN_METHOD", options.method, "method")
    out.anchors = choice("FlattenAnchors", "FLATTEN_ANCHORS", options.anchors, "anchors")
    if options.refine is not None:
        out.refine = options.refine
    if options.refine_stop is not None:
        out.refine_stop = options.refine_stop
    out.injective = options.injective
    if options.seams is not None:
        out.seam_edges.extend(_indices(options.seams, 2, "seams").ravel().tolist())
    out.auto_cut = options.auto_cut
    out.split_non_manifold = options.split_non_manifold
    out.tolerate_degenerate = options.tolerate_degenerate
    set_repair(out, options.repair)
    for pin in options.pins:
        out.pins.add(vertex=pin.vertex, u=pin.u, v=pin.v, weight=pin.weight)
    for line in options.grain_lines:
        out.grain_lines.add(from_vertex=line.from_vertex, to_vertex=line.to_vertex,
                            angle_degrees=line.angle_degrees)
    out.surface_key = options.surface_key
    out.include_first_step = options.first_step
    out.include_singular_values = options.singular_values
    out.float64 = options.float64
    for drawing in options.drawings:
        _set_drawing(out.drawings.add(), drawing)
    for first_triangle, name in options.parts:
        out.parts.add(first_triangle=first_triangle, name=name)


def _set_drawing(out: Any, drawing: DrawingOptions) -> None:
    out.format = choice("DrawingFormat", "DRAWING_FORMAT", drawing.format, "format")
    out.corners = choice("AllowanceCorners", "ALLOWANCE_CORNERS", drawing.corners, "corners")
    for name in ("millimetres_per_unit", "allowance", "notches", "sheet_width", "paper", "overlap",
                 "interior", "plain", "margin"):
        value = getattr(drawing, name)
        if value is not None:
            setattr(out, name, value)


def set_duration(out: Any, seconds: float) -> None:
    fraction, whole = math.modf(seconds)
    out.seconds = int(whole)
    out.nanos = int(fraction * 1e9)
    out.SetInParent()
