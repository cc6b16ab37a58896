"""The values that calls take and answer.

#V and #F are the vertices and triangles of a mesh, #U the positions of a layout, which has copies of
vertices along its cuts. Lengths are in the units of the mesh, angles in radians unless their name
says degrees. What a call takes as an array may be anything that numpy makes one of; arrays of
answers are numpy's, and read-only.
"""

from __future__ import annotations

import dataclasses
import datetime
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

_value = dataclasses.dataclass(frozen=True, slots=True, eq=False)
_plain = dataclasses.dataclass(frozen=True, slots=True)


# What calls take.


@_plain
class Handle:
    """A place of a mesh that the caller moves. Give one of vertex, position, and triangle with bary."""

    id: str  # unique in the set, 1 to 128 characters of [A-Za-z0-9._-]
    vertex: int | None = None
    position: tuple[float, float] | None = None  # at rest; the lowest triangle where they overlap
    triangle: int | None = None
    bary: tuple[float, float, float] | None = None  # each 0 to 1, their sum 1
    weight: float | None = None  # on the squared miss, 1e-6 to 1e12; None: 1e6
    hard: bool = False  # meet the target exactly
    oriented: bool = False  # hold the angle and the scale of the target too
    area_radius: float = 0  # hold every vertex within this rest distance; implies oriented
    snap: bool = False  # move a position outside the mesh onto its border, instead of refusing it
    depth: float = 0  # for the drawing order, higher is nearer
    depth_falloff: float = 0  # rest distance over which the depth fades to 0; 0: constant


@_plain
class Target:
    """Where a handle should go. Where targets are asked for, (x, y) and a complex number do too."""

    x: float
    y: float
    angle: float = 0  # against the rest pose, for oriented handles
    scale: float = 1  # likewise, 0 to 1e6


Targets = Mapping[str, "Target | Sequence[float] | complex"]


@_plain
class Energy:
    """How a mesh becomes an energy. None: as the server thinks best."""

    basis: str | None = None  # "edge", "edge_as_published", "face" or "vertex"
    weights: str | None = None  # "uniform" or "cotangent"
    rigidity: Any = None  # #F numbers above 0 and up to 1e6; None: 1 everywhere


@_plain
class Repair:
    """What is mended of a mesh first; answers speak of the vertices and triangles that were sent."""

    weld: bool = False  # vertices within the tolerance become the lowest of them
    drop_duplicates: bool = False  # of triangles with the same corners the lowest is kept
    stitch: bool = False  # border edges are split at border vertices that lie on them
    tolerance: float | None = None  # a length; None: a millionth of the diagonal


@_plain
class ShapeOptions:
    """How to deform, and how to answer."""

    mode: str | None = None  # "rigid" (None), "similarity" or "baseline"
    refine: int = 0  # iterations of the second step
    float64: bool = False  # positions in double precision, else in single
    flipped_ids: bool = False  # also answer which triangles are flipped
    # Single precision relative to an origin, which then loses nothing far from 0. Shape.positions are
    # the sums, in double precision.
    relative_to_origin: bool = False
    # How positions travel: "float32" (None), "float32_le", or "int16_le" in half the bytes, off by half
    # of a 65534th of the longer side of the shape at most. Not with float64.
    encoding: str | None = None
    boundary_only: bool = False  # positions of the vertices on the boundary alone
    vertex_subset: Any = None  # positions of these vertices alone, in this order


@_plain
class Pin:
    """A vertex held at a place of the layout."""

    vertex: int
    u: float
    v: float
    weight: float = 0  # 0: exactly; else 1e-9 to 1e9 on the squared distance


@_plain
class GrainLine:
    """The direction from one vertex to another of the same chart, from the u axis."""

    from_vertex: int
    to_vertex: int
    angle_degrees: float = 0


@_plain
class FlattenOptions:
    """How to flatten, and how to answer. None: what docs/protocol.md says of the method."""

    method: str | None = None  # "arap_face", "arap_edge", "lscm", "first_step" or "abf"
    energy: Energy = Energy()
    anchors: str | None = None  # "center_edge", "far_boundary" or "spectral"
    refine: int | None = None  # at most so many iterations
    refine_stop: float | None = None  # they end when one lowers the energy by less than this part
    injective: bool = False  # no flipped triangle, or NOT_INJECTIVE
    seams: Any = None  # k×2 vertices: edges to cut
    auto_cut: bool = False  # cut whatever is no disk
    split_non_manifold: bool = False
    tolerate_degenerate: bool = False
    repair: Repair = Repair()
    pins: Sequence[Pin] = ()
    grain_lines: Sequence[GrainLine] = ()
    surface_key: str = ""  # the server keeps the prepared surface under this name for a while
    first_step: bool = False  # also answer the result of the first step
    singular_values: bool = False  # also answer s1 and s2 of every triangle
    float64: bool = False  # uv in double precision, else in single


# What calls answer.


@_plain
class Warning:
    """Something that was repaired or ignored."""

    kind: str  # "unreferenced_vertices"
    count: int
    elements: tuple[int, ...]  # the first few
    message: str  # a sentence, as the server sent it


@_value
class Pick:
    """Where a point of a shape was at rest."""

    triangle: int
    bary: tuple[float, float, float]
    rest: tuple[float, float]


@_value
class Shape:
    """A deformed mesh and how good it is."""

    # #V×2, or a row for each of `vertices`: float32, or float64 where that was asked, and with an
    # origin.
    positions: np.ndarray
    local: np.ndarray  # as they travelled: relative to the origin, with "int16_le" integers
    origin: tuple[float, float]  # (0, 0) unless it was asked for
    vertices: np.ndarray | None  # which ones, with boundary_only and vertex_subset; None: all
    sequence: int  # of the update that it answers; in a track the number of the frame
    replaced: int  # updates that newer ones replaced since the answer before
    flipped_count: int
    flipped_ids: np.ndarray  # when asked
    worst_handle_error: float
    worst_handle_id: str  # "" without handles
    energy: float
    mean_stretch: float
    max_stretch: float
    picks: tuple[Pick | None, ...]  # one per picked point; None where nothing lies
    handle_set_revision: int
    queue_micros: float  # waiting for a worker
    solve_micros: float  # computing


@_value
class MeshInfo:
    """A mesh as a session holds it."""

    id: str
    content_hash: str  # equal meshes share their factors
    vertex_count: int
    triangle_count: int
    edge_count: int
    component_count: int
    boundary_loop_count: int
    area: float
    diagonal: float
    warnings: tuple[Warning, ...]
    bytes: int
    basis: str  # in force
    weights: str
    repair: Repair


@_value
class Registration:
    mesh: MeshInfo
    shared: bool  # the factors were there already
    queue_seconds: float
    solve_seconds: float


@_value
class OutlineMesh:
    """Triangles inside outlines."""

    vertices: np.ndarray  # #V×2, float64
    triangles: np.ndarray  # #F×3, uint32, counter-clockwise
    piece_count: int
    hole_count: int
    smallest_angle_degrees: float
    queue_seconds: float
    solve_seconds: float


@_value
class PlacedHandle:
    id: str
    rest: tuple[float, float]  # after any snapping
    snapped_distance: float
    component: int


@_value
class HandleSet:
    """A handle set as the server holds it."""

    id: str
    mesh_id: str
    handles: tuple[PlacedHandle, ...]  # in the order of `positions` of an update
    row_count: int
    bytes: int
    warnings: tuple[Warning, ...]
    depth: np.ndarray  # #V or 0
    draw_order: np.ndarray  # triangles back to front, #F or 0
    revision: int  # grows by one with every edit
    resting_components: int
    translating_components: int


@_value
class Compilation:
    handle_set: HandleSet
    queue_seconds: float
    solve_seconds: float


@_value
class SessionInfo:
    id: str
    create_time: datetime.datetime  # UTC
    expire_time: datetime.datetime  # unless it is used before
    ttl: datetime.timedelta
    labels: Mapping[str, str]
    mesh_ids: tuple[str, ...]
    handle_set_ids: tuple[str, ...]


@_value
class SessionPage:
    sessions: tuple[SessionInfo, ...]  # by id
    next_page_token: str  # "" at the end


@_value
class ServerInfo:
    version: str
    limits: Mapping[str, float]  # by the names of arap.v1.Limits; times in seconds
    capabilities: frozenset[str]
    workers: int


@_plain
class Distortion:
    """How far a mapping is from an isometry."""

    arap_energy: float
    symmetric_dirichlet: float
    area_ratio: float
    mean_stretch_percent: float
    max_stretch_percent: float
    mean_compression_percent: float
    max_compression_percent: float
    mean_angle_degrees: float
    max_angle_degrees: float
    flipped: int
    scale: float
    worst_triangle: int


@_value
class Chart:
    """A connected piece of a layout. Indices are positions of the layout."""

    loops: tuple[np.ndarray, ...]  # boundaries in order, the longest first
    anchors: np.ndarray  # two or none
    triangle_count: int
    distortion: Distortion
    boundary_crossings: int
    refinements: int


@_value
class Flattening:
    """A flat surface, true to size."""

    uv: np.ndarray  # #U×2
    uv_vertex: np.ndarray  # #U, the vertex that each came from; the first #V in order
    corner_uv: np.ndarray  # #F×3, the position of every corner
    welded_vertex: np.ndarray  # #V where vertices were welded: who stands for each; else 0
    triangle_chart: np.ndarray  # #F
    charts: tuple[Chart, ...]
    cut_edges: np.ndarray  # k×2 vertices, seams and then automatic cuts
    auto_cut_count: int
    left_out_triangles: np.ndarray
    first_step_uv: np.ndarray  # #U×2 when asked, else 0×2
    singular_values: np.ndarray  # #F×2 when asked, else 0×2
    distortion: Distortion
    warnings: tuple[Warning, ...]
    boundary_overlaps: bool
    surface_cached: bool
    queue_seconds: float
    solve_seconds: float


@_value
class Job:
    """How a flattening stands that goes on by itself."""

    id: str
    state: str  # "waiting", "running", "done", "failed" or "cancelled"
    phase: str
    fraction: float
    place: int
    expected_seconds: float  # until it ends
    result_bytes: int

    @property
    def ended(self) -> bool:
        return self.state not in ("waiting", "running")


# Events of a stream beside Shape.


@_value
class UpdateError:
    """A bad update or edit. The stream goes on."""

    sequence: int
    error: Any  # ArapError


@_plain
class Pong:
    """The answer to a ping."""

    nonce: int


@_value
class Resumed:
    """The stream was lost and goes on, perhaps on another server."""

    handle_set: HandleSet  # as the session holds it now, without the stream's own edits
    attempts: int  # to open it again


def point_array(points: ArrayLike, columns: int, name: str, dtype: str = "<f8") -> np.ndarray:
    """`points` as an array of so many columns, or ValueError; complex numbers are two."""
    array = np.asarray(points)
    if columns == 2 and np.iscomplexobj(array):
        array = np.stack([array.real, array.imag], axis=-1)
    if array.size == 0:
        array = array.reshape(0, columns)
    if array.ndim != 2 or array.shape[1] != columns:
        raise ValueError(f"{name} has the shape {array.shape}; it has to be n×{columns}.")
    return np.ascontiguousarray(array, dtype)
