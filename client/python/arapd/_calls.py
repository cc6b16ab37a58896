"""Calls as programs: generators that say what is to be sent and read, and are told what came of it.

Programs hold everything that is known about calls (headers, deadlines, what is made again, what an
answer has to be); _sync.py and _asyncio.py do what they say, each in its way:

    Unary(…)     make a call with one answer; told an Ended
    Start(…)     begin a call with many answers; told a handle of it
    Read(…)      the next answer; told its bytes, or None when the call is over (`handle.ended`)
    Pause(…)     wait
    Emit(…)      hand a value to the caller, who goes on with the program

A call that was lost (the server is gone, going away, or was never reached), or that the server
refused before it began, is made again for as long as `retry_within` says and the deadline allows,
after growing pauses of 50 ms to 2 s or as long as the server asks. edit_handles is, only when the
server says that it has not begun; deform_track never.
"""

from __future__ import annotations

import dataclasses
import math
import random
import re
import secrets
import time
from collections.abc import Callable, Generator
from typing import Any, TypeVar

import grpc
from google.protobuf.message import DecodeError

from . import _checks, faults
from .faults import ArapError, Reason

# How long a call may take that is not told, in seconds: one that looks something up or removes it,
# and one that computes.
QUICK_LIMIT = 30.0
WORK_LIMIT = 600.0
_FOR_EVER = 365 * 24 * 3600.0
_LONGEST_PAUSE = 2.0
_TRACEPARENT = re.compile(r"00-[0-9a-f]{32}-[0-9a-f]{16}-[0-9a-f]{2}")

T = TypeVar("T")
# Answers a T.
Program = Generator[Any, Any, T]


@dataclasses.dataclass(frozen=True, slots=True)
class CallOptions:
    """What may be said about any call, by keyword."""

    timeout: float | None = None  # seconds, with all attempts; None: as the method says
    retry_within: float = 5.0  # for how long after the first failure it is made again; 0: not
    traceparent: str = ""  # W3C's, of what the call is part of


@dataclasses.dataclass(frozen=True, slots=True)
class Ended:
    """How a call ended."""

    code: grpc.StatusCode
    message: str = ""
    details: bytes = b""
    answer: bytes | None = None  # of a unary call

    @property
    def ok(self) -> bool:
        return self.code is grpc.StatusCode.OK

    def error(self) -> ArapError:
        return faults.of_rpc(self.code, self.message, self.details)

    @property
    def lost(self) -> bool:
        """Whether a call that we did not cancel may do better elsewhere."""
        code = grpc.StatusCode
        if self.code in (code.UNAVAILABLE, code.CANCELLED):
            return True
        if self.code is code.UNKNOWN:
            return "No status received" in self.message or "Stream removed" in self.message
        return self.code is code.INTERNAL and "RST_STREAM" in self.message


def ended_by(error: grpc.RpcError) -> Ended:
    """How the call ended that an error of grpc or grpc.aio tells of."""
    details = b""
    for name, value in error.trailing_metadata() or ():
        if name == "grpc-status-details-bin":
            details = value
    return Ended(error.code(), error.details() or "", details)


@dataclasses.dataclass(frozen=True, slots=True)
class _Opening:
    path: str
    request: bytes
    timeout: float | None
    metadata: tuple[tuple[str, str], ...]


class Unary(_Opening):
    __slots__ = ()


class Start(_Opening):
    __slots__ = ()


@dataclasses.dataclass(frozen=True, slots=True)
class Read:
    handle: Any
    limit: float  # seconds, after which the call is cancelled and `handle.overdue` is true


@dataclasses.dataclass(frozen=True, slots=True)
class Pause:
    seconds: float


@dataclasses.dataclass(frozen=True, slots=True)
class Emit:
    value: Any


@dataclasses.dataclass(frozen=True, slots=True)
class Method:
    """How a method is called. `repeat`: "harmless"; "removal", after which what is gone is not found;
    "never", for it would be done twice."""

    service: str
    name: str
    limit: float
    repeat: str = "harmless"

    @property
    def path(self) -> str:
        return f"/arap.v1.{self.service}/{self.name}"


class Headers:
    """What all attempts of one call send: where to, and what logs and traces call it."""

    def __init__(self, session_id: str, traceparent: str = ""):
        self.request_id = secrets.token_hex(16)
        if not _TRACEPARENT.fullmatch(traceparent):
            traceparent = f"00-{secrets.token_hex(16)}-{secrets.token_hex(8)}-01"
        headers = [("x-request-id", self.request_id), ("traceparent", traceparent)]
        # A header cannot carry everything; the server refuses what is no name anyway.
        if _checks.is_name(session_id):
            headers.append(("x-session-id", session_id))
        self.metadata = tuple(headers)


class Backoff:
    """From 50 ms on twice as long each time, up to 2 s, and between half of that and all of it."""

    def __init__(self) -> None:
        self._next = 0.05

    def next(self) -> float:
        most, self._next = self._next, min(2 * self._next, _LONGEST_PAUSE)
        return random.uniform(most / 2, most)


class Deadline:
    """When a call has to be over; perhaps never."""

    def __init__(self, options: CallOptions, limit: float):
        self.seconds = limit if options.timeout is None else options.timeout
        self._end = time.monotonic() + self.seconds if self.seconds < _FOR_EVER else math.inf

    def left(self) -> float:
        return self._end - time.monotonic()

    def timeout(self) -> float | None:
        return None if self._end == math.inf else max(self.left(), 0.0)


def is_refused(error: ArapError) -> bool:
    """Whether the server itself says that it has not begun, and that trying again helps."""
    return error.retry_after is not None and error.reason in (Reason.OVERLOADED, Reason.DRAINING)


def attempts(method: Method, options: CallOptions, session_id: str,
             attempt: Callable[[tuple[tuple[str, str], ...], float | None], Program[Ended]],
             heard: Callable[[], bool] = lambda: False) -> Program[Ended | None]:
    """Makes a call, and again as the method allows. `attempt` makes it once and answers an Ended;
    `heard` says whether a piece of an answer came: then retry_within counts anew. Answers the Ended
    of a good attempt, or None where a removal is known to be done."""
    deadline = Deadline(options, method.limit)
    headers = Headers(session_id, options.traceparent)
    backoff = Backoff()
    give_up = None
    in_doubt = False  # an attempt may have been carried out
    while True:
        ended = yield from attempt(headers.metadata, deadline.timeout())
        if ended.ok:
            return ended
        error = ended.error()
        if in_doubt and method.repeat == "removal" and error.reason is Reason.NOT_FOUND:
            return None
        error.details["request_id"] = headers.request_id
        if not is_refused(error) and (method.repeat == "never" or not ended.lost):
            raise error
        in_doubt = in_doubt or not is_refused(error)
        pause = max(backoff.next(), error.retry_after or 0.0)
        now = time.monotonic()
        if give_up is None or heard():
            give_up = now + options.retry_within
        if pause >= give_up - now or pause >= deadline.left():
            raise error
        yield Pause(pause)


def parse(message_class: Any, data: bytes) -> Any:
    try:
        return message_class.FromString(data)
    except DecodeError:
        faults.refuse("bytes that are no message.")


def call(method: Method, request: Any, answer_class: Any, options: CallOptions,
         session_id: str = "") -> Program[Any]:
    """One unary call; answers its message, an empty one for a removal that is known to be done."""
    data = request.SerializeToString()

    def attempt(metadata: tuple[tuple[str, str], ...], timeout: float | None) -> Program[Ended]:
        ended: Ended = yield Unary(method.path, data, timeout, metadata)
        return ended

    ended = yield from attempts(method, options, session_id, attempt)
    if ended is None:
        return answer_class()
    assert ended.answer is not None
    return parse(answer_class, ended.answer)
