"""What a client and a session can do, once for both ways of waiting (_ways.py).

Methods here make programs, which _sync.py carries out at once and aio.py when they are awaited.
All calls take the keywords of CallOptions: timeout, retry_within, traceparent.
"""

from __future__ import annotations

import datetime
import secrets
from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeVar

from . import _answers, _calls, _channel, _layouts, _programs, _requests, _ways, _wire, faults, model
from ._calls import CallOptions, Method, Program
from ._requests import message

S = TypeVar("S")

_CREATE = Method("DeformationService", "CreateSession", _calls.QUICK_LIMIT)
_LIST = Method("DeformationService", "ListSessions", _calls.QUICK_LIMIT)
_INFO = Method("ServerService", "GetServerInfo", _calls.QUICK_LIMIT)
_OUTLINE = Method("DeformationService", "MeshOutline", _calls.WORK_LIMIT)
_FLATTEN = Method("FlatteningService", "Flatten", _calls.WORK_LIMIT)


class ClientMethods:
    """A connection to one arapd. Calls may be made at the same time."""

    @_ways.call
    def server_info(self, /, **call: Any) -> Program[model.ServerInfo]:
        """What the server is and what it allows: a ServerInfo."""
        def program() -> Program[model.ServerInfo]:
            answer = yield from _calls.call(_INFO, message("GetServerInfoRequest")(),
                                            message("GetServerInfoResponse"), CallOptions(**call))
            return _answers.server_info(answer)
        return program()

    @staticmethod
    def _creation(make: Callable[[str], S], session_id: str | None,
                  ttl: float | datetime.timedelta | None, labels: Mapping[str, str] | None,
                  call: dict[str, Any]) -> Program[S]:
        """Answers the session that `make` makes of the id."""
        request = message("CreateSessionRequest")()
        # The id is all that keeps others out.
        request.session_id = secrets.token_hex(16) if session_id is None else session_id
        if ttl is not None:
            _requests.set_duration(request.ttl, ttl.total_seconds()
                                   if isinstance(ttl, datetime.timedelta) else ttl)
        request.labels.update(labels or {})

        def program() -> Program[S]:
            answer = yield from _calls.call(_CREATE, request, message("CreateSessionResponse"),
                                            CallOptions(**call), request.session_id)
            _answers.session_info(answer.session, request.session_id)
            return make(request.session_id)
        return program()

    @_ways.call
    def list_sessions(self, /, page_size: int = 0, page_token: str = "",
                      **call: Any) -> Program[model.SessionPage]:
        """A SessionPage of the caller's sessions, 1 to 1000 at a time (0: the server's choice)."""
        request = message("ListSessionsRequest")(page_size=page_size, page_token=page_token)

        def program() -> Program[model.SessionPage]:
            answer = yield from _calls.call(_LIST, request, message("ListSessionsResponse"),
                                            CallOptions(**call))
            return _answers.session_page(answer, page_size, page_token)
        return program()

    @_ways.call
    def mesh_outline(self, /, outlines: Sequence[Any], vertices: int = 0, *,
                     tolerance: float = 0, expansion: float = 0,
                     **call: Any) -> Program[model.OutlineMesh]:
        """Triangles inside outlines, each n×2: an OutlineMesh of about so many vertices (0: 1000).

        The outlines are simplified by at most `tolerance` and grow outwards by `expansion` before.
        """
        request = message("MeshOutlineRequest")(vertex_count=vertices, tolerance=tolerance,
                                                expansion=expansion)
        for outline in outlines:
            request.outlines.add().points = _wire.packed(
                _requests.point_array(outline, 2, "an outline"))

        def program() -> Program[model.OutlineMesh]:
            answer = yield from _calls.call(_OUTLINE, request, message("MeshOutlineResponse"),
                                            CallOptions(**call))
            return _answers.outline_mesh(answer)
        return program()

    @_ways.call
    def flatten(self, /, vertices: Any, triangles: Any,
                options: model.FlattenOptions = model.FlattenOptions(),
                **call: Any) -> Program[model.Flattening]:
        """Flattens a surface of #V×3 vertices and #F×3 triangles, true to size: a Flattening."""
        request = message("FlattenRequest")()
        _requests.set_flatten(request, vertices, triangles, options)
        request.max_response_bytes = _channel.MAX_MESSAGE_BYTES
        corners = _requests.triangle_array(triangles)
        vertex_count = len(vertices)

        def program() -> Program[model.Flattening]:
            answer = yield from _calls.call(_FLATTEN, request, message("FlattenResponse"),
                                            CallOptions(**call))
            return _layouts.flattening(answer, corners, vertex_count, options)
        return program()


_JOB_RESULT = message("DownloadResultRequest")
_WATCH_JOB = message("WatchJobRequest")
_SUBMIT = Method("FlatteningService", "SubmitFlatten", _calls.WORK_LIMIT)
_CANCEL = Method("FlatteningService", "CancelJob", _calls.QUICK_LIMIT)


class JobMethods:
    """Flattenings that go on by themselves, also when the server is started anew; they live as long
    as their session."""

    id: str

    @_ways.call
    def submit_flatten(self, /, job_id: str, vertices: Any, triangles: Any,
                       options: model.FlattenOptions = model.FlattenOptions(),
                       **call: Any) -> Program[model.Job]:
        """Begins a flattening: a Job. The same arguments under the same name are the same job;
        ALREADY_EXISTS when the name has another request."""
        request = message("SubmitFlattenRequest")(session_id=self.id, job_id=job_id)
        _requests.set_flatten(request.flatten, vertices, triangles, options)

        def program() -> Program[model.Job]:
            answer = yield from _calls.call(_SUBMIT, request, message("SubmitFlattenResponse"),
                                            CallOptions(**call), self.id)
            return _layouts.job(answer.job, job_id)
        return program()

    @_ways.each(model.Job)
    def watch_job(self, /, job_id: str, **call: Any) -> Program[model.Job]:
        """An iterator of how the job stands: at once, when something has changed and every second or
        so, until it has ended."""
        request = _WATCH_JOB(session_id=self.id, job_id=job_id)
        return _programs.watch_job(request, CallOptions(**call))

    @_ways.call
    def wait_job(self, /, job_id: str, **call: Any) -> Program[model.Job]:
        """Waits until the job has ended: the Job."""
        request = _WATCH_JOB(session_id=self.id, job_id=job_id)
        return _programs.last_of(_programs.watch_job(request, CallOptions(**call)))

    @_ways.call
    def job_result(self, /, job_id: str, vertices: Any, triangles: Any,
                   options: model.FlattenOptions = model.FlattenOptions(),
                   **call: Any) -> Program[model.Flattening]:
        """The Flattening of a job that is done, of any size; the arguments are those of
        submit_flatten. PROTOCOL while it is not done; the fault of one that failed."""
        request = _JOB_RESULT(session_id=self.id, job_id=job_id)
        corners = _requests.triangle_array(triangles)
        vertex_count = len(vertices)

        def program() -> Program[model.Flattening]:
            answer = yield from _programs.job_result(request, CallOptions(**call))
            return _layouts.flattening(answer, corners, vertex_count, options)
        return program()

    @_ways.call
    def cancel_job(self, /, job_id: str, **call: Any) -> Program[model.Job]:
        """Ends a job that is not done; one that has ended stays as it is. The Job."""
        request = message("CancelJobRequest")(session_id=self.id, job_id=job_id)

        def program() -> Program[model.Job]:
            answer = yield from _calls.call(_CANCEL, request, message("CancelJobResponse"),
                                            CallOptions(**call), self.id)
            job = _layouts.job(answer.job, job_id)
            if not job.ended:
                faults.refuse("that a job goes on which was cancelled.")
            return job
        return program()
