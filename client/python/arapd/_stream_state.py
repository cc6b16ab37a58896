"""The state of a live stream: how it stands, what its user says, when the server counts as gone.

Used by one thread at a time (_sync.py holds a lock around it); nothing here waits. What goes on with
it, from opening to resuming, is in _stream.py.
"""

from __future__ import annotations

import dataclasses
import math
import time
from collections.abc import Callable
from typing import Any

from . import _answers, _calls, _replay, _shapes, faults, model
from ._awaited import AwaitedAnswers, SignsOfLife
from ._calls import CallOptions, Method
from ._stream_parts import Counts, Trouble
from .faults import ArapError

METHOD = Method("DeformationService", "StreamDeform", math.inf, "never")
now = time.monotonic


@dataclasses.dataclass(frozen=True, slots=True)
class StreamOptions:
    """How a stream answers, and how long it holds out. Times are seconds."""

    # "latest": a new update replaces one that has not started; "every": every one is answered.
    delivery: str = "latest"
    shape: model.ShapeOptions = model.ShapeOptions()
    # After this much silence the server is asked for a sign of life; 0: never.
    heartbeat: float = 5.0
    # A read, or an opening, that hears nothing for so long counts the server as gone. Longer than the
    # longest frame. Without effect when heartbeat is 0.
    silence: float = 30.0
    # For how long an opening, an update, an edit or the end may be without answer while somebody
    # reads, and a message without being taken, whatever signs of life there are. The stream then ends
    # with DEADLINE_EXCEEDED.
    answer: float = _calls.WORK_LIMIT
    # For how long a stream that was lost is opened again and again, growing pauses of up to 2 s apart,
    # until the server has caught up; 0: not at all. Lost is what ended with the server gone or going
    # away. A server that has no room is asked again too. Anything else is final.
    resume_within: float = 0.0


class StreamState:
    def __init__(self, session_id: str, handle_set_id: str, options: StreamOptions,
                 sizes: _answers.KnownSizes, call: CallOptions, notify: Callable[[], None]):
        if options.delivery not in ("latest", "every"):
            raise ValueError(f"delivery is {options.delivery!r}; it has to be latest or every.")
        self.options = options
        self.handle_set: model.HandleSet | None = None  # as it was when the stream opened
        self.counts = Counts()
        self.cancelled = False
        self.call: Any = None  # the handle of the moment
        self._every = options.delivery == "every"
        self._notify = notify
        self._sizes = sizes
        self._ids = (session_id, handle_set_id)
        self._opening = _replay.opening(session_id, handle_set_id, self._every, options.shape)
        self._headers = _calls.Headers(session_id, call.traceparent)
        self._deadline = _calls.Deadline(call, METHOD.limit)
        self._question: _shapes.Question | None = None  # once it was opened
        self._awaited = AwaitedAnswers(self._every)
        self._life = SignsOfLife(options.heartbeat, options.silence)
        self._log = _replay.ReplayLog(not self._every) if options.resume_within > 0 else None
        self._last_sequence = 0
        self._trouble: Trouble | None = None
        self._is_open = False  # `call` may be pushed on
        self._sending_closed = False
        self._silent = False  # for so long that `call` was given up
        self._overdue: ArapError | None = None  # why it was given up for good
        self._waiting_since: float | None = None  # for an opening or an event
        self._end: list[ArapError | None] = []  # how the stream ended

    @property
    def connected(self) -> bool:
        return self._is_open and not self.cancelled

    def ping(self, nonce: int) -> None:
        if self._sending_closed:
            raise faults.protocol("Sending on this stream was closed.")
        if self._end or self.cancelled:
            raise over()
        self._push_ping(nonce)

    def close_sending(self) -> None:
        if self._sending_closed:
            return
        self._sending_closed = True
        if self._end or self.cancelled:
            raise over()
        if self._is_open:
            self.call.push_end()

    def cancel(self) -> None:
        self.cancelled = True
        if self.call is not None:
            self.call.cancel()
        self._notify()

    # How it ends.

    def _finish(self, error: ArapError | None) -> None:
        self._end.append(error)
        self._is_open = False
        self._notify()

    def _end_of(self, call: Any) -> tuple[ArapError | None, bool]:
        """How a call that is over has ended, and whether it was lost."""
        lost = self._overdue is None and (self._silent or call.ended.lost)
        if (lost or self._overdue is not None) and self.cancelled:
            return faults.cancelled("The stream was cancelled."), False
        if self._overdue is not None:
            return self._overdue, False
        if lost and self._silent:
            return faults.gone("Nothing was heard from the server for "
                               f"{self.options.silence:g} s."), True
        if not call.ended.ok:
            error = call.ended.error()
            error.details["request_id"] = self._headers.request_id
            return error, lost
        if self._awaited.oldest is None:
            return None, False
        return faults.bad_answer("The server ended the stream early: what was sent on it has no "
                                 "answer."), False

    def _known(self, sequence: int, good: bool) -> bool:
        """Notes the answer to a sequence. Whether there was one before."""
        seen = self._log is not None and not self._log.answered(sequence, good)
        if (self._trouble is not None and (good or not seen)
                and sequence >= self._trouble.last_said):
            self._trouble = None
        return seen

    # Signs of life.

    def _push_ping(self, nonce: int | None) -> None:
        self._life.ask(nonce, self._is_open, now())
        if self._is_open or nonce is None:
            self.call.push(_replay.ping(nonce or 0))

    def _overdue_now(self, at: float) -> ArapError | None:
        """Why the call is not to be waited for any longer; None as long as it is."""
        answer = self.options.answer

        def fault(what: str) -> ArapError:
            return faults.overdue(f"The server has not {what} for {answer:g} s.")

        writing = self.call.writing_since
        if writing is not None and at - writing >= answer:
            return fault("taken a message")
        if self._waiting_since is None or at - self._waiting_since < answer:
            return None
        if not self._is_open:
            return fault("opened the stream")
        if self._awaited.oldest is not None:
            late = at - self._awaited.oldest >= answer
            return fault("answered an update or edit") if late else None
        return fault("ended the stream") if self._sending_closed else None

    def tick(self) -> float | None:
        """Asks for signs of life, and gives up a call on which nothing happens. Answers in how many
        seconds to do so again; None when the stream is over."""
        if self._end or self.cancelled:
            return None
        asks = self.options.heartbeat > 0
        at = now()
        if self.call is not None:
            if asks and self._life.is_silent(at):
                self._silent = True
                self.call.cancel()
            elif self._overdue is None and (overdue := self._overdue_now(at)) is not None:
                self._overdue = overdue
                self.call.cancel()
            elif (asks and not (self._is_open and self._sending_closed)
                  and self._life.is_due(self.call.is_clear, at)):
                self._push_ping(None)
        shortest = self.options.answer
        if asks:
            shortest = min(shortest, self.options.heartbeat, self.options.silence)
        return min(max(shortest / 2, 0.001), 3600.0)


def over() -> ArapError:
    return faults.protocol("The stream is over; reading tells why.")
