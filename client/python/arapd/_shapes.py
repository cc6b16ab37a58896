"""Answers that are shapes, checked as those of _answers.py. This is what runs for every frame."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _checks as check
from . import model
from ._answers import MeshSize
from .faults import refuse

_NO_IDS = np.empty(0, np.uint32)
_NO_IDS.flags.writeable = False
_AT_ZERO = (0.0, 0.0)


class Question:
    """What shapes were asked to be, and of which mesh they are, as far as that is known."""

    def __init__(self, options: model.ShapeOptions, size: MeshSize | None):
        self.options = options
        self.size = size
        self.vertices: NDArray[Any] | None = None  # the positions are of these; None: of all
        self._count = size and size.vertices  # of positions
        self._unmeasured = 0  # shapes since the last that was measured

    def told(self, vertices: Sequence[int]) -> None:
        """The server said of which vertices the positions are. The first shape comes next."""
        options = self.options
        self._unmeasured = max(options.measure_every - 1, 0)
        limit = self.size and self.size.vertices
        if options.vertex_subset is not None and len(options.vertex_subset):
            if not np.array_equal(vertices, options.vertex_subset):
                refuse("other vertices than were asked for.")
        elif options.boundary_only:
            if not len(vertices):
                refuse("no vertices of the boundary.")
        elif len(vertices):
            refuse("some vertices where all were asked for.")
        if len(vertices):
            self.vertices = check.indices(vertices, limit, "vertex")
            if options.boundary_only and not (np.diff(self.vertices.astype(np.int64)) > 0).all():
                refuse("vertices of the boundary out of order.")
            self._count = len(vertices)

    def is_due(self) -> bool:
        """Whether the next shape has to be measured whatever else was asked."""
        return 0 < self.options.measure_every <= self._unmeasured + 1

    def answered(self, unmeasured: bool) -> None:
        self._unmeasured = self._unmeasured + 1 if unmeasured else 0

    def check_count(self, count: int) -> None:
        if not count:
            refuse("an empty shape.")
        if self._count is None:  # of a mesh that was never seen, shapes have at least one size
            self._count = count
        elif count != self._count:
            have = "the mesh has" if self.vertices is None else "asked was for"
            refuse(f"a shape of {count} vertices; {have} {self._count}.")


def _positions(message: Any, options: model.ShapeOptions
               ) -> tuple[NDArray[Any], NDArray[Any], tuple[float, float]]:
    """The positions, those that travelled, and the origin of these."""
    packed = options.encoding in ("float32_le", "int16_le")
    wanted = "positions64" if options.float64 else "packed_positions" if packed else "positions"
    for field in ("positions", "positions64", "packed_positions"):
        if field != wanted and getattr(message, field):
            refuse("a shape in another precision than was asked.")
    if options.encoding == "int16_le":
        data = message.packed_positions
        if len(data) % 4:
            refuse("half a position.")
        local = np.frombuffer(data, "<i2").reshape(-1, 2)
    elif packed:
        data = message.packed_positions
        if len(data) % 8:
            refuse("half a position.")
        local = check.finite_rows(np.frombuffer(data, "<f4").reshape(-1, 2),
                                  "the position of vertex")
    else:
        local = check.points(message, wanted, 2, "the position of vertex")
    relative = options.encoding == "int16_le" or (options.relative_to_origin
                                                  and not options.float64)
    if not message.origin and options.encoding != "int16_le":
        # Where it was asked for too, of a server that has never heard of origins.
        return local, local, _AT_ZERO
    origin = check.run(message, "origin", "an origin")
    if origin.size != (2 if relative else 0):
        refuse("a shape without the origin that it is relative to." if relative else
               "a shape relative to an origin for which it was not asked.")
    check.finite((*origin, message.scale), "an origin")
    scaled = local * message.scale if options.encoding == "int16_le" else local
    positions = scaled + origin
    positions.flags.writeable = False
    x, y = origin.tolist()
    return positions, local, (x, y)


def _pick(message: Any, size: MeshSize | None) -> model.Pick | None:
    if not message.hit:
        return None
    check.indices([message.triangle], size and size.triangles, "triangle")
    bary = check.run(message, "barycentric", "the weights of a pick")
    if bary.size != 3:
        refuse("a pick without its weights.")
    rest = (message.rest.x, message.rest.y)
    check.finite([*rest, *bary], "a pick")
    first, second, third = bary.tolist()
    return model.Pick(message.triangle, (first, second, third), rest)


def _flipped(message: Any, question: Question) -> NDArray[Any]:
    if not message.flipped_ids:
        return _NO_IDS
    if not question.options.flipped_ids:
        refuse("flipped triangles for which it was not asked.")
    triangles = question.size and question.size.triangles
    flipped = check.indices(message.flipped_ids, triangles, "triangle")
    if triangles is not None and flipped.size > triangles:
        refuse("more flipped triangles than there are triangles.")
    return flipped


def _check_measures(message: Any, question: Question, asked: bool) -> None:
    check.finite((message.worst_handle_error, message.energy, message.mean_stretch,
                  message.max_stretch), "the quality of a shape")
    due = asked or question.is_due()
    question.answered(message.unmeasured)
    if not message.unmeasured:
        return
    if due:
        refuse("a shape without the measures that were asked for.")
    if (message.flipped_count or message.flipped_ids or message.energy or message.mean_stretch
            or message.max_stretch):
        refuse("measures of a shape that it says it has not measured.")


def shape(message: Any, question: Question, picks: int | None, replaced: int | None = None,
          measured: bool = False) -> model.Shape:
    """`picks`: how many were asked for; None when that is not known any more. `replaced`: as it is
    counted on this side, which knows it better. `measured`: whether it has to be, also where the
    options ask for no measures."""
    positions, local, origin = _positions(message, question.options)
    scale = message.scale if question.options.encoding == "int16_le" else 1.0
    question.check_count(len(positions))
    _check_measures(message, question, measured)
    if message.worst_handle_id:
        check.name(message.worst_handle_id, None, "handle")
    count = len(message.picks)
    check.count(count, min(count, check.MOST_PICKS) if picks is None else picks, "picks")
    return model.Shape(
        positions, local, origin, scale, question.vertices, message.sequence,
        message.replaced if replaced is None else replaced, not message.unmeasured,
        message.flipped_count, _flipped(message, question), message.worst_handle_error,
        message.worst_handle_id, message.energy, message.mean_stretch, message.max_stretch,
        tuple(_pick(pick, question.size) for pick in message.picks) if count else (),
        message.handle_set_revision, message.queue_micros, message.solve_micros)
