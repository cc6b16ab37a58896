"""Answers about flattenings and their jobs, checked as those of _answers.py."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _checks as check
from . import _wire
from . import model
from ._answers import seconds, warnings
from .faults import refuse

_STATES = {number: name.removeprefix("JOB_STATE_").lower()
           for name, number in _wire.enum_names("JobState").items() if number}
_REFINE_ENDS = {number: name.removeprefix("REFINE_END_").lower()
                for name, number in _wire.enum_names("RefineEnd").items() if number}
_DISTORTION = [field.name for field in dataclasses.fields(model.Distortion)]


def _distortion(message: Any, triangles: int) -> model.Distortion:
    values = {name: getattr(message, name) for name in _DISTORTION}
    check.finite(values.values(), "a distortion")
    check.indices([message.worst_triangle], max(triangles, 1), "triangle")
    return model.Distortion(**values)


def _chart(message: Any, positions: int, triangles: int) -> model.Chart:
    if message.triangle_count > triangles:
        refuse(f"a chart of {message.triangle_count} triangles; the mesh has {triangles}.")
    return model.Chart(
        tuple(check.indices(loop.uv_indices, positions, "the flat position")
              for loop in message.loops),
        check.indices(message.anchors, positions, "the flat position"), message.triangle_count,
        _distortion(message.distortion, triangles), message.boundary_crossings,
        message.refinements, _REFINE_ENDS.get(message.refine_end))


def _drawing(message: Any) -> model.Drawing:
    if not message.files or not all(file.data for file in message.files):
        refuse("a drawing without its files.")
    return model.Drawing(tuple(model.DrawingFile(file.page, file.data) for file in message.files),
                         warnings(message.warnings))


def _check_corners(corners: NDArray[Any], triangles: NDArray[Any], source: NDArray[Any],
                   welded: NDArray[Any]) -> None:
    """Each corner is a copy of the vertex that it has in the mesh, or of who stands for that."""
    wanted = welded[triangles] if welded.size else triangles
    wrong = np.argwhere(source[corners] != wanted)
    if len(wrong):
        refuse(f"a layout in which corner {wrong[0][1]} of triangle {wrong[0][0]} is not its "
               "vertex.")


def flattening(message: Any, triangles: NDArray[Any], vertex_count: int,
               options: model.FlattenOptions) -> model.Flattening:
    """A layout of that mesh with all that was asked for."""
    wanted, other = ("uv64", "uv") if options.float64 else ("uv", "uv64")
    if getattr(message, other):
        refuse("a layout in another precision than was asked.")
    uv = check.points(message, wanted, 2, "the flat position")
    if len(uv) < vertex_count:
        refuse(f"{len(uv)} flat positions for {vertex_count} vertices.")
    source = check.indices(message.uv_vertex, vertex_count, "vertex")
    check.count(source.size, len(uv), "vertices of flat positions")
    if not np.array_equal(source[:vertex_count], np.arange(vertex_count)):
        refuse("flat positions out of their places.")
    welded = check.indices(message.welded_vertex, vertex_count, "vertex")
    expected = vertex_count if options.repair.weld and welded.size else 0
    check.count(welded.size, expected, "welded vertices")
    corners = check.groups(check.indices(message.corner_uv, len(uv), "the flat position"), 3,
                           "corners")
    check.count(len(corners), len(triangles), "flat triangles")
    _check_corners(corners, triangles, source, welded)
    first_step = check.points(message, "first_step_uv", 2, "the first step's position")
    check.count(len(first_step), len(uv) if options.first_step else 0,
                "positions after the first step")
    singular = check.points(message, "singular_values", 2, "the singular values of triangle")
    check.count(len(singular), len(triangles) if options.singular_values else 0,
                "pairs of singular values")
    charts = tuple(_chart(chart, len(uv), len(triangles)) for chart in message.charts)
    triangle_chart = check.indices(message.triangle_chart, len(charts), "chart")
    check.count(triangle_chart.size, len(triangles), "triangles with a chart")
    cuts = check.groups(check.indices(message.cut_edges, vertex_count, "vertex"), 2, "cuts")
    if message.auto_cut_count > len(cuts):
        refuse(f"{message.auto_cut_count} automatic cuts of {len(cuts)}.")
    check.count(len(message.drawings), len(options.drawings), "drawings")
    return model.Flattening(
        uv, source, corners, welded, triangle_chart, charts, cuts, message.auto_cut_count,
        check.indices(message.left_out_triangles, len(triangles), "triangle"), first_step, singular,
        _distortion(message.distortion, len(triangles)), warnings(message.warnings),
        tuple(_drawing(drawing) for drawing in message.drawings), message.boundary_overlaps, message.surface_cached, seconds(message.queue_time),
        seconds(message.solve_time))


def job(message: Any, job_id: str) -> model.Job:
    check.name(message.job_id, job_id, "job")
    state = _STATES.get(message.state)
    if state is None:
        refuse("a job in no state that is known.")
    if not 0 <= message.fraction <= 1:
        refuse(f"that {message.fraction} of a job is done.")
    return model.Job(job_id, state, message.phase, message.fraction, message.place,
                     seconds(message.expected_end), message.result_bytes)
