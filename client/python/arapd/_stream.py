"""The live stream, all of it but the sending and receiving: which answer belongs to what, how a lost
stream is opened again and what is said again on it.

The programs of StreamCore say what to wait for, as those of _calls.py do:

    Begin(…)     begin a call; told a handle of it (Outbox, `cancel`, `ended`)
    Next(…)      the next message of a call; told its bytes, or None when the call is over
    Changed(…)   until something about the stream has changed, or so many seconds have passed
    Sent(…)      until so few messages are left with the handle; told False when the call is over
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import grpc
from numpy.typing import NDArray

from . import _answers, _calls, _replay, _requests, _shapes, _wire, faults, model
from ._calls import Program
from ._stream_parts import Begin, Changed, Next, Sent, Trouble
from ._stream_state import METHOD, StreamState, now, over
from .faults import ArapError

_Response = _wire.message("StreamDeformResponse")


class StreamCore(StreamState):
    def send(self, make: Callable[[int], _replay.Said], sequence: int | None) -> Program[int]:
        """Sends what `make` makes with the sequence, or with the next one; answers the sequence."""
        if self._sending_closed:
            raise faults.protocol("Sending on this stream was closed.")
        while self._every and not (self._is_open or self._end or self.cancelled):
            yield Changed(None)
        if self._end or self.cancelled:
            raise over()
        said = make(self._last_sequence + 1 if sequence is None else sequence)
        if self._log is not None:
            if said.sequence <= self._last_sequence:
                raise faults.invalid_option(
                    f"The sequence {said.sequence} has not grown; on a stream that resumes it tells "
                    "the answers apart.", "sequence")
            self._log.sent(said)
        self._last_sequence = max(said.sequence, self._last_sequence)
        self.counts.note_sent(said.sequence)
        if not self._is_open:
            return said.sequence
        self._awaited.sent(said, now())
        call = self.call
        call.push(said.data, None if self._every else said)
        # What a lost call has not sent is said again on the next one.
        waits_for_all = self._every or said.is_edit
        if not (yield Sent(call, 0 if waits_for_all else 1)) and self._log is None:
            raise over()
        return said.sequence

    # What the server answers.

    def open(self) -> Program[None]:
        """Opens the first call. Once, first."""
        try:
            self.handle_set = yield from self._open_call(fresh=False)
        except _Lost as lost:
            self._finish(lost.error)
            raise lost.error from None
        except ArapError as error:
            self._finish(error)
            raise
        self._waiting_since = None
        self._is_open = True

    def read(self) -> Program[model.Event | None]:
        """The next event, or None when the stream ended well."""
        while not self._end:
            call = self.call
            if self._waiting_since is None:
                self._waiting_since = now()
            data = yield from self._next(call)
            error: ArapError | None
            if data is not None:
                try:
                    event = self._event_of(_calls.parse(_Response, data))
                except ArapError as wrong:
                    call.cancel()
                    error, lost = wrong, _is_full(wrong)
                else:
                    if event is None:
                        continue
                    self._waiting_since = None
                    return event
            else:
                error, lost = self._end_of(call)
            if lost and error is not None and self._log is not None:
                try:
                    return (yield from self._resume(error))
                except ArapError as last:
                    error = last
            self._finish(error)
        if self._end[0] is not None:
            raise self._end[0]
        return None

    def _next(self, call: Any) -> Program[Any]:
        self._life.set_waiting(True, now())
        data = yield Next(call)
        self._life.set_waiting(False, now())
        return data

    def _event_of(self, message: Any) -> model.Event | None:
        """The event of a message; None when it is not the user's."""
        kind = message.WhichOneof("payload")
        if kind == "shape":
            return self._shape_of(message.shape)
        if kind == "error":
            error, sequence = faults.of_status(message.error.status), message.error.sequence
            self._awaited.take(sequence)
            # What had worked does not work again: the shapes would be others.
            if self._known(sequence, False):
                raise error
            self.counts.note_answer(sequence, False)
            return model.UpdateError(sequence, error)
        if kind == "pong":
            nonce = message.pong.nonce
            return model.Pong(nonce) if self._life.answered(nonce) else None
        raise faults.bad_answer("The server sent a message that does not belong here.")

    def _shape_of(self, message: Any) -> model.Shape | None:
        asked = self._awaited.take(message.sequence)
        assert self._question is not None
        if self._known(message.sequence, True):
            self._question.answered(message.unmeasured)
            return None
        return _shapes.shape(message, self._question, asked.picks,
                             self.counts.note_answer(message.sequence, True), asked.measured)

    # Opening, the first time and after a loss.

    def _open_call(self, fresh: bool) -> Program[model.HandleSet]:
        """A new call, opened by the server; its handle set. It is the call of the moment, but nothing
        is pushed on it before _is_open. Raises _Lost where another attempt may do better."""
        call = yield Begin(METHOD.path, self._deadline.timeout(), self._headers.metadata, fresh)
        call.push(self._opening)
        self.call = call
        self._silent = False
        self._waiting_since = now()
        self._life.restart(now())
        if self.cancelled:
            call.cancel()
        # The server may have much to compute before it has opened; meanwhile it answers pings.
        try:
            while (data := (yield from self._next(call))) is not None:
                message = _calls.parse(_Response, data)
                if message.HasField("opened"):
                    return self._opened(message.opened)
                if not message.HasField("pong"):
                    raise faults.bad_answer("The server answered before it opened the stream.")
                if self._life.answered(message.pong.nonce):
                    raise faults.bad_answer("The server answered a ping that was not sent.")
        except ArapError:
            call.cancel()
            raise
        error, lost = self._end_of(call)
        error = error or faults.bad_answer("The server ended the stream without opening it.")
        if lost or _is_full(error):
            raise _Lost(error)
        raise error

    def _opened(self, message: Any) -> model.HandleSet:
        handle_set = _answers.handle_set(message.handle_set, self._ids[1], None, self._sizes, [])
        if self._question is None:
            self._question = _shapes.Question(self.options.shape,
                                              self._sizes.of_mesh(handle_set.mesh_id))
        self._question.told(message.vertices)
        return handle_set

    def _resume(self, error: ArapError) -> Program[model.Resumed]:
        """Opens again after a loss, for as long as the options say. The event; raises the last error."""
        self._is_open = False
        silent = self._silent
        # Who is lost again before it has caught up comes back neither at once nor for ever.
        within = self.options.resume_within
        again = self._trouble is not None and now() - self._trouble.opened < within
        if self._trouble is None or not again:
            self._trouble = Trouble(now() + within)
        attempts = 0
        while True:
            attempts += 1
            if again or attempts > 1:
                yield from self._pause(error)
            try:
                handle_set = yield from self._open_call(fresh=silent)
            except _Lost as lost:
                error, silent = lost.error, self._silent
                continue
            self._say_again()
            self.counts.resumed += 1
            return model.Resumed(handle_set, attempts)

    def _pause(self, last: ArapError) -> Program[None]:
        """Waits before the next attempt; raises the error with which to give up."""
        assert self._trouble is not None
        pause = self._trouble.backoff.next()
        if now() + pause >= self._trouble.until:
            raise last
        end = now() + min(pause, max(self._deadline.left(), 0.0))
        while not self.cancelled and now() < end:
            yield Changed(end - now())
        if self.cancelled:
            raise faults.cancelled("The stream was cancelled.")

    def _say_again(self) -> None:
        assert self._log is not None and self._trouble is not None
        messages = self._log.messages()
        if messages:
            self._trouble.opened = now()
            self._trouble.last_said = messages[-1].sequence
        else:
            self._trouble = None
        self._awaited.restart(messages, now())
        for said in messages:
            self.call.push(said.data)
        self._is_open = True
        for nonce in self._life.unanswered():
            self.call.push(_replay.ping(nonce))
        if self._sending_closed:
            self.call.push_end()
        self._waiting_since = None
        self._notify()


class _Lost(Exception):
    """An opening that may do better elsewhere or later."""

    def __init__(self, error: ArapError):
        super().__init__(error)
        self.error = error


def _is_full(error: ArapError) -> bool:
    return error.code is grpc.StatusCode.RESOURCE_EXHAUSTED


def positions_of(positions: Any) -> bytes:
    """All handles of an update, n×2."""
    return b"" if positions is None else _points(positions, "positions")


def picks_of(points: Any) -> bytes:
    return b"" if points is None else _points(points, "picks")


def _points(points: Any, name: str) -> bytes:
    array: NDArray[Any] = _requests.point_array(points, 2, name)
    return array.tobytes()
