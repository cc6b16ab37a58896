"""What goes wrong: ArapError, which every call of this package raises and nothing else.

    reason       one of Reason: what the server calls it, or for a transport that failed DRAINING
                 (nobody there, or the server is going away), OVERLOADED, DEADLINE_EXCEEDED,
                 CANCELLED, UNIMPLEMENTED or INTERNAL
    code         the canonical grpc.StatusCode
    message      the sentence of the server
    field        the request field at fault in proto spelling ("handles[3].weight"), or ""
    elements     the first offending vertices, triangles or handles
    retry_after  seconds to wait before trying again; None when that does not help
    details      the other values of the message by name; "request_id" is what the server's logs call
                 the call

Arguments of a wrong shape or type (an array that is not n×2, a method that does not exist) are
ValueError or TypeError, raised before anything is sent.
"""

from __future__ import annotations

import enum
import re
from typing import Any, NoReturn

import grpc
from google.protobuf.message import DecodeError

from . import _wire

_CODES = {code.value[0]: code for code in grpc.StatusCode}
_Status = _wire.message("google.rpc.Status")
_ErrorInfo = _wire.message("google.rpc.ErrorInfo")
_BadRequest = _wire.message("google.rpc.BadRequest")
_RetryInfo = _wire.message("google.rpc.RetryInfo")

class Reason(str, enum.Enum):
    """The reasons of errors.proto, and for each its own name: Reason.NOT_FOUND == "NOT_FOUND"."""

    EMPTY_MESH = "EMPTY_MESH"
    ARRAY_LENGTH = "ARRAY_LENGTH"
    NON_FINITE_COORDINATE = "NON_FINITE_COORDINATE"
    INDEX_OUT_OF_RANGE = "INDEX_OUT_OF_RANGE"
    REPEATED_INDEX = "REPEATED_INDEX"
    DEGENERATE_TRIANGLE = "DEGENERATE_TRIANGLE"
    DUPLICATE_TRIANGLE = "DUPLICATE_TRIANGLE"
    NON_MANIFOLD_EDGE = "NON_MANIFOLD_EDGE"
    NOT_ORIENTABLE = "NOT_ORIENTABLE"
    NOT_A_DISK = "NOT_A_DISK"
    MESH_TOO_LARGE = "MESH_TOO_LARGE"
    INVALID_OPTION = "INVALID_OPTION"
    HANDLE_OUTSIDE = "HANDLE_OUTSIDE"
    DUPLICATE_HANDLE = "DUPLICATE_HANDLE"
    UNKNOWN_HANDLE = "UNKNOWN_HANDLE"
    CONFLICTING_HANDLES = "CONFLICTING_HANDLES"
    NON_FINITE_TARGET = "NON_FINITE_TARGET"
    TARGET_COUNT = "TARGET_COUNT"
    TOO_MANY_HANDLES = "TOO_MANY_HANDLES"
    INVALID_NAME = "INVALID_NAME"
    NOT_FOUND = "NOT_FOUND"
    ALREADY_EXISTS = "ALREADY_EXISTS"
    PROTOCOL = "PROTOCOL"
    LIMIT_EXCEEDED = "LIMIT_EXCEEDED"
    OVERLOADED = "OVERLOADED"
    DRAINING = "DRAINING"
    CANCELLED = "CANCELLED"
    DEADLINE_EXCEEDED = "DEADLINE_EXCEEDED"
    UNIMPLEMENTED = "UNIMPLEMENTED"
    NUMERICAL = "NUMERICAL"
    INTERNAL = "INTERNAL"
    NON_MANIFOLD_VERTEX = "NON_MANIFOLD_VERTEX"
    UNKNOWN_EDGE = "UNKNOWN_EDGE"
    NOT_INJECTIVE = "NOT_INJECTIVE"
    STREAM_IDLE = "STREAM_IDLE"
    UNAUTHENTICATED = "UNAUTHENTICATED"
    PERMISSION_DENIED = "PERMISSION_DENIED"
    STORE_UNAVAILABLE = "STORE_UNAVAILABLE"
    DATA_LOSS = "DATA_LOSS"
    OUT_OF_MEMORY = "OUT_OF_MEMORY"


_REASON_OF_CODE = {
    grpc.StatusCode.UNAVAILABLE: Reason.DRAINING,
    grpc.StatusCode.RESOURCE_EXHAUSTED: Reason.OVERLOADED,
    grpc.StatusCode.DEADLINE_EXCEEDED: Reason.DEADLINE_EXCEEDED,
    grpc.StatusCode.CANCELLED: Reason.CANCELLED,
    grpc.StatusCode.UNIMPLEMENTED: Reason.UNIMPLEMENTED,
}


class ArapError(Exception):
    """See the head of this file."""

    def __init__(self, reason: Reason, message: str, code: grpc.StatusCode, *, field: str = "",
                 elements: tuple[int, ...] = (), retry_after: float | None = None,
                 details: dict[str, str] | None = None):
        super().__init__(message)
        self.reason = reason
        self.message = message
        self.code = code
        self.field = field
        self.elements = elements
        self.retry_after = retry_after
        self.details = details or {}

    def __str__(self) -> str:
        return f"{self.reason.value}: {self.message}"

    def __reduce__(self) -> tuple[Any, ...]:
        return _made, (self.reason.value, self.message, self.code, self.field, self.elements,
                       self.retry_after, self.details)


def _made(reason: str, message: str, code: grpc.StatusCode, field: str, elements: tuple[int, ...],
          retry_after: float | None, details: dict[str, str]) -> ArapError:
    return ArapError(Reason(reason), message, code, field=field, elements=elements,
                     retry_after=retry_after, details=details)


def of_status(status: Any) -> ArapError:
    """The error that a google.rpc.Status tells of."""
    code = _CODES.get(status.code, grpc.StatusCode.UNKNOWN)
    error = ArapError(_REASON_OF_CODE.get(code, Reason.INTERNAL), status.message, code)
    info, bad_request, retry = _ErrorInfo(), _BadRequest(), _RetryInfo()
    for detail in status.details:
        try:
            if detail.Unpack(info):
                _read(info, error)
            elif detail.Unpack(bad_request) and bad_request.field_violations:
                error.field = bad_request.field_violations[0].field
            elif detail.Unpack(retry):
                error.retry_after = retry.retry_delay.ToNanoseconds() * 1e-9
        except DecodeError:
            continue  # of a broken proxy; the code and the message still count
    return error


def _read(info: Any, error: ArapError) -> None:
    try:
        error.reason = Reason(info.reason)
    except ValueError:  # of a newer server; the code has chosen one
        error.details["reason"] = info.reason
    for name, value in sorted(info.metadata.items()):
        if name == "elements":
            error.elements = tuple(int(digits) for digits in re.findall(r"[0-9]+", value))
        else:
            error.details[name] = value


def of_rpc(code: grpc.StatusCode, message: str, details: bytes) -> ArapError:
    """The error of a call that ended so; `details` are its "grpc-status-details-bin"."""
    status = _Status()
    try:
        status.ParseFromString(details)
    except DecodeError:
        status.Clear()
    status.code = code.value[0]
    status.message = message
    return of_status(status)


def bad_answer(sentence: str) -> ArapError:
    """The server sent what was not asked for."""
    return ArapError(Reason.INTERNAL, sentence, grpc.StatusCode.INTERNAL)


def protocol(sentence: str) -> ArapError:
    return ArapError(Reason.PROTOCOL, sentence, grpc.StatusCode.FAILED_PRECONDITION)


def cancelled(sentence: str) -> ArapError:
    return ArapError(Reason.CANCELLED, sentence, grpc.StatusCode.CANCELLED)


def gone(sentence: str) -> ArapError:
    return ArapError(Reason.DRAINING, sentence, grpc.StatusCode.UNAVAILABLE)


def overdue(sentence: str) -> ArapError:
    return ArapError(Reason.DEADLINE_EXCEEDED, sentence, grpc.StatusCode.DEADLINE_EXCEEDED)


def invalid_option(sentence: str, field: str) -> ArapError:
    return ArapError(Reason.INVALID_OPTION, sentence, grpc.StatusCode.INVALID_ARGUMENT, field=field)


def refuse(sentence: str) -> NoReturn:
    """Raises what tells of a server that answered `sentence`."""
    raise bad_answer(f"The server answered {sentence}")
