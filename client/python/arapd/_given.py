"""What calls take; see model.py. Arrays may be anything that numpy makes one of."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from typing import Any


@dataclasses.dataclass(frozen=True, slots=True)
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


@dataclasses.dataclass(frozen=True, slots=True)
class Target:
    """Where a handle should go. Where targets are asked for, (x, y) and a complex number do too."""

    x: float
    y: float
    angle: float = 0  # against the rest pose, for oriented handles
    scale: float = 1  # likewise, 0 to 1e6


Targets = Mapping[str, "Target | Sequence[float] | complex"]


@dataclasses.dataclass(frozen=True, slots=True)
class Energy:
    """How a mesh becomes an energy. None: as the server thinks best."""

    basis: str | None = None  # "edge", "edge_as_published", "face" or "vertex"
    weights: str | None = None  # "uniform" or "cotangent"
    rigidity: Any = None  # #F numbers above 0 and up to 1e6; None: 1 everywhere


@dataclasses.dataclass(frozen=True, slots=True)
class Repair:
    """What is mended of a mesh first; answers speak of the vertices and triangles that were sent."""

    weld: bool = False  # vertices within the tolerance become the lowest of them
    drop_duplicates: bool = False  # of triangles with the same corners the lowest is kept
    stitch: bool = False  # border edges are split at border vertices that lie on them
    tolerance: float | None = None  # a length; None: a millionth of the diagonal


@dataclasses.dataclass(frozen=True, slots=True)
class ShapeOptions:
    """How to deform, and how to answer."""

    mode: str | None = None  # "rigid" (None), "similarity" or "baseline"
    refine: int = 0  # iterations of the second step
    float64: bool = False  # positions in double precision, else in single
    flipped_ids: bool = False  # also answer which triangles are flipped, of shapes that are measured
    # Which shapes of a stream or track are measured: the first, and every n-th after one that was. 1: all;
    # 0: none. Measuring takes the server about a quarter of a frame.
    measure_every: int = 1
    # Single precision relative to an origin. Without it floats lose far from 0 what lies between two of
    # them, a quarter of a unit at 5,400,000; with it nothing. Shape.positions are the sums, in double
    # precision. Implied by "int16_le", without effect with float64.
    relative_to_origin: bool = False
    # How positions travel: "float32" (None), "float32_le", or "int16_le" in half the bytes, off by half
    # of a 65534th of the longer side of the shape at most. Not with float64.
    encoding: str | None = None
    boundary_only: bool = False  # positions of the vertices on the boundary alone
    vertex_subset: Any = None  # positions of these vertices alone, in this order


@dataclasses.dataclass(frozen=True, slots=True)
class Pin:
    """A vertex held at a place of the layout."""

    vertex: int
    u: float
    v: float
    weight: float = 0  # 0: exactly; else 1e-9 to 1e9 on the squared distance


@dataclasses.dataclass(frozen=True, slots=True)
class GrainLine:
    """The direction from one vertex to another of the same chart, from the u axis."""

    from_vertex: int
    to_vertex: int
    angle_degrees: float = 0


@dataclasses.dataclass(frozen=True, slots=True)
class DrawingOptions:
    """A layout as a file at true size. Lengths are millimetres."""

    format: str  # "svg", "dxf" or "pdf"
    millimetres_per_unit: float | None = None  # of the mesh: 10 for centimetres; None: 1
    allowance: float = 0  # round the pieces, for seams
    corners: str | None = None  # "mitre" (None), "square" or "round"
    notches: bool = False  # pair the two sides of every seam
    sheet_width: float = 0  # pack the pieces into a roll of this width; 0: as they were laid
    paper: str = ""  # pages of a PDF or SVG to join: "A4", "letter", "210x297"; "": in one piece
    overlap: float | None = None  # of pages with their neighbours; None: 10
    interior: bool = False  # show the edges inside too
    plain: bool = False  # nothing besides the lines
    margin: float | None = None  # what the printer does not reach; None: 10


@dataclasses.dataclass(frozen=True, slots=True)
class FlattenOptions:
    """How to flatten, and how to answer. None: what docs/protocol.md says of the method."""

    method: str | None = None  # "arap_face", "arap_edge", "lscm", "first_step" or "abf"
    energy: Energy = Energy()
    anchors: str | None = None  # "center_edge", "far_boundary" or "spectral"
    refine: int | None = None  # at most so many iterations
    refine_stop: float | None = None  # they end when two lower the energy by less than this part
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
    drawings: Sequence[DrawingOptions] = ()  # also answer the layout as these files, at most 16
    # Names of pieces in drawings: (first triangle, name) of each object of a file, in order.
    parts: Sequence[tuple[int, str]] = ()
