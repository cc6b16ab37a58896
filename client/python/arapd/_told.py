"""What calls answer; see model.py. Arrays are numpy's, and read-only."""

from __future__ import annotations

import dataclasses
import datetime
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._given import Repair
from .faults import ArapError

Floats = NDArray[np.floating[Any]]
Indices = NDArray[np.integer[Any]]


@dataclasses.dataclass(frozen=True, slots=True)
class Warning:
    """Something that was repaired or ignored."""

    kind: str  # "unreferenced_vertices"
    count: int
    elements: tuple[int, ...]  # the first few
    message: str  # a sentence, as the server sent it


@dataclasses.dataclass(frozen=True, slots=True, eq=False)
class Pick:
    """Where a point of a shape was at rest."""

    triangle: int
    bary: tuple[float, float, float]
    rest: tuple[float, float]


@dataclasses.dataclass(frozen=True, slots=True, eq=False)
class Shape:
    """A deformed mesh and how good it is."""

    # #V×2, or a row for each of `vertices`: float32, or float64 where that was asked, and with an
    # origin.
    positions: Floats
    local: NDArray[Any]  # as they travelled: relative to the origin, with "int16_le" integers
    origin: tuple[float, float]  # (0, 0) unless it was asked for
    scale: float  # units of the mesh per integer of "int16_le", else 1
    vertices: Indices | None  # which ones, with boundary_only and vertex_subset; None: all
    sequence: int  # of the update that it answers; in a track the number of the frame
    replaced: int  # updates that newer ones replaced since the answer before
    # Else flipped_count, flipped_ids, energy, mean_stretch and max_stretch say nothing: see
    # ShapeOptions.measure_every.
    measured: bool
    flipped_count: int
    flipped_ids: Indices  # when asked
    worst_handle_error: float
    worst_handle_id: str  # "" without handles
    energy: float
    mean_stretch: float
    max_stretch: float
    picks: tuple[Pick | None, ...]  # one per picked point; None where nothing lies
    handle_set_revision: int
    queue_micros: float  # waiting for a worker
    solve_micros: float  # computing

    @property
    def position_error(self) -> float:
        """How far a coordinate may be off by its way over the wire, in units of the mesh."""
        if self.local.dtype == np.float64:
            return 0.0
        if self.local.dtype == np.int16:
            return self.scale / 2
        return float(np.abs(self.local).max()) / 2**24


@dataclasses.dataclass(frozen=True, slots=True, eq=False)
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


@dataclasses.dataclass(frozen=True, slots=True, eq=False)
class Registration:
    mesh: MeshInfo
    shared: bool  # the factors were there already
    queue_seconds: float
    solve_seconds: float


@dataclasses.dataclass(frozen=True, slots=True, eq=False)
class OutlineMesh:
    """Triangles inside outlines."""

    vertices: Floats  # #V×2, float64
    triangles: Indices  # #F×3, uint32, counter-clockwise
    piece_count: int
    hole_count: int
    smallest_angle_degrees: float
    outline_error: float  # how far its border is at most from what was asked for
    queue_seconds: float
    solve_seconds: float


@dataclasses.dataclass(frozen=True, slots=True, eq=False)
class PlacedHandle:
    id: str
    rest: tuple[float, float]  # after any snapping
    snapped_distance: float
    component: int


@dataclasses.dataclass(frozen=True, slots=True, eq=False)
class HandleSet:
    """A handle set as the server holds it."""

    id: str
    mesh_id: str
    handles: tuple[PlacedHandle, ...]  # in the order of `positions` of an update
    row_count: int
    bytes: int
    warnings: tuple[Warning, ...]
    depth: Floats  # #V or 0
    draw_order: Indices  # triangles back to front, #F or 0
    revision: int  # grows by one with every edit
    resting_components: int
    translating_components: int


@dataclasses.dataclass(frozen=True, slots=True, eq=False)
class Compilation:
    handle_set: HandleSet
    queue_seconds: float
    solve_seconds: float


@dataclasses.dataclass(frozen=True, slots=True, eq=False)
class SessionInfo:
    id: str
    create_time: datetime.datetime  # UTC
    expire_time: datetime.datetime  # unless it is used before
    ttl: datetime.timedelta
    labels: Mapping[str, str]
    mesh_ids: tuple[str, ...]
    handle_set_ids: tuple[str, ...]


@dataclasses.dataclass(frozen=True, slots=True, eq=False)
class SessionPage:
    sessions: tuple[SessionInfo, ...]  # by id
    next_page_token: str  # "" at the end


@dataclasses.dataclass(frozen=True, slots=True, eq=False)
class ServerInfo:
    version: str
    limits: Mapping[str, float]  # by the names of arap.v1.Limits; times in seconds
    capabilities: frozenset[str]
    workers: int


@dataclasses.dataclass(frozen=True, slots=True)
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


@dataclasses.dataclass(frozen=True, slots=True, eq=False)
class Chart:
    """A connected piece of a layout. Indices are positions of the layout."""

    loops: tuple[Indices, ...]  # boundaries in order, the longest first
    anchors: Indices  # two or none
    triangle_count: int
    distortion: Distortion
    boundary_crossings: int
    refinements: int
    refine_end: str | None  # "converged" or "limit"; None where none were asked for


@dataclasses.dataclass(frozen=True, slots=True, eq=False)
class DrawingFile:
    page: str  # "cover" or a number where there is a file for each; else ""
    data: bytes


@dataclasses.dataclass(frozen=True, slots=True, eq=False)
class Drawing:
    files: tuple[DrawingFile, ...]
    warnings: tuple[Warning, ...]  # what is doubtful in it; elements are places in charts


@dataclasses.dataclass(frozen=True, slots=True, eq=False)
class Flattening:
    """A flat surface, true to size."""

    uv: Floats  # #U×2
    uv_vertex: Indices  # #U, the vertex that each came from; the first #V in order
    corner_uv: Indices  # #F×3, the position of every corner
    welded_vertex: Indices  # #V where vertices were welded: who stands for each; else 0
    triangle_chart: Indices  # #F
    charts: tuple[Chart, ...]
    cut_edges: Indices  # k×2 vertices, seams and then automatic cuts
    auto_cut_count: int
    left_out_triangles: Indices
    first_step_uv: Floats  # #U×2 when asked, else 0×2
    singular_values: Floats  # #F×2 when asked, else 0×2
    distortion: Distortion
    warnings: tuple[Warning, ...]
    drawings: tuple[Drawing, ...]  # in the order in which they were asked for
    boundary_overlaps: bool
    surface_cached: bool
    queue_seconds: float
    solve_seconds: float


@dataclasses.dataclass(frozen=True, slots=True, eq=False)
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


@dataclasses.dataclass(frozen=True, slots=True, eq=False)
class UpdateError:
    """A bad update or edit. The stream goes on."""

    sequence: int
    error: ArapError


@dataclasses.dataclass(frozen=True, slots=True)
class Pong:
    """The answer to a ping."""

    nonce: int


@dataclasses.dataclass(frozen=True, slots=True, eq=False)
class Resumed:
    """The stream was lost and goes on, perhaps on another server."""

    handle_set: HandleSet  # as the session holds it now, without the stream's own edits
    attempts: int  # to open it again


Event = Shape | UpdateError | Pong | Resumed
