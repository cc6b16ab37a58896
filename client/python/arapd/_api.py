"""What a client, a session and a stream can do, once for both ways of waiting.

The classes here make programs; `_run` of _sync.py carries one out and answers its result, that of
_asyncio.py answers an awaitable. Likewise `_iterate` answers an iterator of what a program emits.
All calls take the keywords of CallOptions: timeout, retry_within, traceparent.
"""

from __future__ import annotations

import datetime
import secrets
from collections.abc import Mapping, Sequence
from typing import Any

from . import _answers, _calls, _channel, _layouts, _programs, _requests, _wire, model
from ._calls import CallOptions, Method, Program
from ._requests import message

_CREATE = Method("DeformationService", "CreateSession", _calls.QUICK_LIMIT)
_LIST = Method("DeformationService", "ListSessions", _calls.QUICK_LIMIT)
_INFO = Method("ServerService", "GetServerInfo", _calls.QUICK_LIMIT)
_OUTLINE = Method("DeformationService", "MeshOutline", _calls.WORK_LIMIT)
_FLATTEN = Method("FlatteningService", "Flatten", _calls.WORK_LIMIT)


class ClientMethods:
    """A connection to one arapd. Calls may be made at the same time."""

    def _run(self, program: Program) -> Any:
        raise NotImplementedError

    def _session(self, session_id: str, owned: bool) -> Any:
        raise NotImplementedError

    def server_info(self, **call: Any) -> Any:
        """What the server is and what it allows: a ServerInfo."""
        def program():
            answer = yield from _calls.call(_INFO, message("GetServerInfoRequest")(),
                                            message("GetServerInfoResponse"), CallOptions(**call))
            return _answers.server_info(answer)
        return self._run(program())

    def create_session(self, session_id: str | None = None, *,
                       ttl: float | datetime.timedelta | None = None,
                       labels: Mapping[str, str] | None = None, **call: Any) -> Any:
        """Opens a Session; without an id, one of 128 random bits. `ttl`: life without use in seconds.
        Repeating it with the same id and arguments is harmless. As a context manager the session is
        deleted at the end of the block; without, it lives until it has not been used for its ttl."""
        request = message("CreateSessionRequest")()
        # The id is all that keeps others out.
        request.session_id = secrets.token_hex(16) if session_id is None else session_id
        if ttl is not None:
            _requests.set_duration(request.ttl, ttl.total_seconds()
                                   if isinstance(ttl, datetime.timedelta) else ttl)
        request.labels.update(labels or {})

        def program():
            answer = yield from _calls.call(_CREATE, request, message("CreateSessionResponse"),
                                            CallOptions(**call), request.session_id)
            _answers.session_info(answer.session, request.session_id)
            return self._session(request.session_id, True)
        return self._run(program())

    def attach_session(self, session_id: str) -> Any:
        """A Session that exists already; asks nothing. It stays at the end of a `with` block."""
        return self._session(session_id, False)

    def list_sessions(self, page_size: int = 0, page_token: str = "", **call: Any) -> Any:
        """A SessionPage of the caller's sessions, 1 to 1000 at a time (0: the server's choice)."""
        request = message("ListSessionsRequest")(page_size=page_size, page_token=page_token)

        def program():
            answer = yield from _calls.call(_LIST, request, message("ListSessionsResponse"),
                                            CallOptions(**call))
            return _answers.session_page(answer, page_size, page_token)
        return self._run(program())

    def mesh_outline(self, outlines: Sequence[Any], vertices: int = 0, **call: Any) -> Any:
        """Triangles inside outlines, each n×2: an OutlineMesh of about so many vertices (0: 1000)."""
        request = message("MeshOutlineRequest")(vertex_count=vertices)
        for outline in outlines:
            request.outlines.add().points = _wire.packed(
                _requests.point_array(outline, 2, "an outline"))

        def program():
            answer = yield from _calls.call(_OUTLINE, request, message("MeshOutlineResponse"),
                                            CallOptions(**call))
            return _answers.outline_mesh(answer)
        return self._run(program())

    def flatten(self, vertices: Any, triangles: Any,
                options: model.FlattenOptions = model.FlattenOptions(), **call: Any) -> Any:
        """Flattens a surface of #V×3 vertices and #F×3 triangles, true to size: a Flattening."""
        request = message("FlattenRequest")()
        _requests.set_flatten(request, vertices, triangles, options)
        request.max_response_bytes = _channel.MAX_MESSAGE_BYTES
        corners = _requests.triangle_array(triangles)
        vertex_count = len(vertices)

        def program():
            answer = yield from _calls.call(_FLATTEN, request, message("FlattenResponse"),
                                            CallOptions(**call))
            return _layouts.flattening(answer, corners, vertex_count, options)
        return self._run(program())


_JOB_RESULT = message("DownloadResultRequest")
_WATCH_JOB = message("WatchJobRequest")
_SUBMIT = Method("FlatteningService", "SubmitFlatten", _calls.WORK_LIMIT)
_CANCEL = Method("FlatteningService", "CancelJob", _calls.QUICK_LIMIT)


class JobMethods:
    """Flattenings that go on by themselves, also when the server is started anew; they live as long
    as their session."""

    id: str

    def _run(self, program: Program) -> Any:
        raise NotImplementedError

    def _iterate(self, program: Program) -> Any:
        raise NotImplementedError

    def submit_flatten(self, job_id: str, vertices: Any, triangles: Any,
                       options: model.FlattenOptions = model.FlattenOptions(), **call: Any) -> Any:
        """Begins a flattening: a Job. The same arguments under the same name are the same job;
        ALREADY_EXISTS when the name has another request."""
        request = message("SubmitFlattenRequest")(session_id=self.id, job_id=job_id)
        _requests.set_flatten(request.flatten, vertices, triangles, options)

        def program():
            answer = yield from _calls.call(_SUBMIT, request, message("SubmitFlattenResponse"),
                                            CallOptions(**call), self.id)
            return _layouts.job(answer.job, job_id)
        return self._run(program())

    def watch_job(self, job_id: str, **call: Any) -> Any:
        """An iterator of how the job stands: at once, when something has changed and every second or
        so, until it has ended."""
        request = _WATCH_JOB(session_id=self.id, job_id=job_id)
        return self._iterate(_programs.watch_job(request, CallOptions(**call)))

    def wait_job(self, job_id: str, **call: Any) -> Any:
        """Waits until the job has ended: the Job."""
        request = _WATCH_JOB(session_id=self.id, job_id=job_id)
        return self._run(_programs.last_of(_programs.watch_job(request, CallOptions(**call))))

    def job_result(self, job_id: str, vertices: Any, triangles: Any,
                   options: model.FlattenOptions = model.FlattenOptions(), **call: Any) -> Any:
        """The Flattening of a job that is done, of any size; the arguments are those of
        submit_flatten. PROTOCOL while it is not done; the fault of one that failed."""
        request = _JOB_RESULT(session_id=self.id, job_id=job_id)
        corners = _requests.triangle_array(triangles)
        vertex_count = len(vertices)

        def program():
            answer = yield from _programs.job_result(request, CallOptions(**call))
            return _layouts.flattening(answer, corners, vertex_count, options)
        return self._run(program())

    def cancel_job(self, job_id: str, **call: Any) -> Any:
        """Ends a job that is not done; one that has ended stays as it is. The Job."""
        request = message("CancelJobRequest")(session_id=self.id, job_id=job_id)

        def program():
            answer = yield from _calls.call(_CANCEL, request, message("CancelJobResponse"),
                                            CallOptions(**call), self.id)
            job = _layouts.job(answer.job, job_id)
            if not job.ended:
                _layouts.refuse("that a job goes on which was cancelled.")
            return job
        return self._run(program())
