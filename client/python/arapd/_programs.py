"""Calls whose answer comes in pieces: tracks, and what is told of jobs."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import grpc

from . import _calls, _layouts, _shapes, _wire, faults, model
from ._calls import CallOptions, Deadline, Emit, Ended, Headers, Method, Program, Read, Start

_TRACK = Method("DeformationService", "DeformTrack", math.inf, "never")
_WATCH = Method("FlatteningService", "WatchJob", math.inf)
_DOWNLOAD = Method("FlatteningService", "DownloadResult", math.inf)
_TrackAnswer = _wire.message("DeformTrackResponse")
_JobAnswer = _wire.message("WatchJobResponse")
_Piece = _wire.message("DownloadResultResponse")
_Layout = _wire.message("FlattenResponse")
_MOST_BYTES = 2**31 - 1  # more does not fit a message


def track(request: Any, frames: int, question: _shapes.Question, call: CallOptions) -> Program[Any]:
    """Emits the shapes of a track, each checked as it comes."""
    headers = Headers(request.session_id, call.traceparent)
    timeout = Deadline(call, _TRACK.limit).timeout()
    handle = yield Start(_TRACK.path, request.SerializeToString(), timeout, headers.metadata)
    done = False
    try:
        frame = 0
        while (data := (yield Read(handle, _calls.WORK_LIMIT))) is not None:
            answer = _calls.parse(_TrackAnswer, data)
            message = answer.shape
            if frame >= frames:
                faults.refuse(f"more frames than the {frames} of the track.")
            if message.sequence != frame:
                faults.refuse(f"frame {message.sequence} of the track where {frame} was due.")
            if frame == 0:
                question.told(answer.vertices)
            shape = _shapes.shape(message, question, 0)
            frame += 1
            yield Emit(shape)
        done = True
    finally:
        if not done:
            handle.cancel()
    if handle.overdue:
        raise faults.overdue(f"Frame {frame} of the track did not come within "
                             f"{_calls.WORK_LIMIT:g} s.")
    if not handle.ended.ok:
        error = handle.ended.error()
        error.details["request_id"] = headers.request_id
        raise error
    if frame != frames:
        raise faults.bad_answer(f"The server ended the track after {frame} of {frames} frames.")


def _pieces(method: Method, request: Callable[[], bytes], call: CallOptions, session_id: str,
            take: Callable[[bytes], Any], what: str) -> Program[Any]:
    """Reads an answer in pieces to its end, from `request()` anew where a call was lost. What `take`
    makes of a piece is emitted unless it is None."""
    heard = False

    def attempt(metadata: tuple[tuple[str, str], ...], timeout: float | None) -> Program[Ended]:
        nonlocal heard
        heard = False
        handle = yield Start(method.path, request(), timeout, metadata)
        done = False
        try:
            while (data := (yield Read(handle, _calls.QUICK_LIMIT))) is not None:
                heard = True
                value = take(data)
                if value is not None:
                    yield Emit(value)
            done = True
        finally:
            if not done:
                handle.cancel()
        if handle.overdue:
            return Ended(grpc.StatusCode.DEADLINE_EXCEEDED,
                         f"The server has told nothing of {what} for {_calls.QUICK_LIMIT:g} s.")
        ended: Ended = handle.ended
        return ended

    yield from _calls.attempts(method, call, session_id, attempt, lambda: heard)


def watch_job(request: Any, call: CallOptions) -> Program[Any]:
    """Emits how a job stands whenever that is told, and answers how it ended."""
    last: list[model.Job] = []

    def take(data: bytes) -> model.Job:
        last[:] = [_layouts.job(_calls.parse(_JobAnswer, data).job, request.job_id)]
        return last[0]

    yield from _pieces(_WATCH, request.SerializeToString, call, request.session_id, take, "the job")
    if not last or not last[0].ended:
        raise faults.bad_answer("The server stopped telling of a job that has not ended.")
    return last[0]


def job_result(request: Any, call: CallOptions) -> Program[Any]:
    """Answers the FlattenResponse of a job that is done, of any size."""
    data = bytearray()
    total: int | None = None

    def rest() -> bytes:
        request.offset = len(data)
        return _wire.serialized(request)

    def take(piece_data: bytes) -> None:
        nonlocal total
        piece = _calls.parse(_Piece, piece_data)
        if (piece.offset != len(data) or piece.total_bytes > _MOST_BYTES
                or total not in (None, piece.total_bytes)
                or len(piece.data) > piece.total_bytes - len(data)):
            faults.refuse("a result whose pieces do not fit.")
        total = piece.total_bytes
        data.extend(piece.data)

    yield from _pieces(_DOWNLOAD, rest, call, request.session_id, take, "the result")
    if total != len(data):
        faults.refuse(f"{len(data)} bytes of a result of {total or 0}.")
    return _calls.parse(_Layout, bytes(data))


def last_of(program: Program[Any]) -> Program[Any]:
    """A program that emits, for callers who want only its answer."""
    told = None
    try:
        while True:
            step = program.send(told)
            told = None if isinstance(step, Emit) else (yield step)
    except StopIteration as stop:
        return stop.value
