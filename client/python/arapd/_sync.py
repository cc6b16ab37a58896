"""The client that waits: every call blocks until its answer is there or its time is over.

Calls may be made from any thread at the same time. What they are is told in _api.py and _session.py,
of which the classes here are the blocking kind.
"""

from __future__ import annotations

import datetime
import threading
import weakref
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from . import _replay, _requests, faults, model
from ._api import ClientMethods
from ._calls import CallOptions, Program, T
from ._channel import ChannelPlan, ConnectOptions
from ._session import SessionMethods
from ._stream import StreamCore, picks_of, positions_of
from ._stream_parts import Begin, Changed, Counts, Next
from ._stream_state import StreamOptions
from ._sync_io import Channel
from ._ways import Blocking


def connect(address: str, **options: Any) -> Client:
    """A Client of the arapd at host:port or unix:PATH, which connects in the background; options are
    those of ConnectOptions (token, tls, root_certificates, …)."""
    return Client(address, ConnectOptions(**options))


class Client(Blocking, ClientMethods):
    """Use it as a context manager, or close() it."""

    def __init__(self, address: str, options: ConnectOptions = ConnectOptions()):
        self._channel = Channel(ChannelPlan(address, options))

    def _run(self, program: Program[Any]) -> Any:
        return self._channel.run(program)

    def create_session(self, session_id: str | None = None, *,
                       ttl: float | datetime.timedelta | None = None,
                       labels: Mapping[str, str] | None = None, **call: Any) -> Session:
        """Opens a Session; without an id, one of 128 random bits. `ttl`: life without use in seconds.
        Repeating it with the same id and arguments is harmless. As a context manager the session is
        deleted at the end of the block; without, it lives until it has not been used for its ttl."""
        return self._channel.run(self._creation(
            lambda name: Session(self._channel, name, True), session_id, ttl, labels, call))

    def attach_session(self, session_id: str) -> Session:
        """A Session that exists already; asks nothing. It stays at the end of a `with` block."""
        return Session(self._channel, session_id, False)

    def wait_ready(self, timeout: float) -> None:
        """Waits until the connection stands; DEADLINE_EXCEEDED after so many seconds."""
        if not self._channel.wait_ready(timeout):
            raise faults.overdue("No connection to the server in time.")

    def close(self) -> None:
        """Ends the connection, and what is under way on it."""
        self._channel.close()

    def __enter__(self) -> Client:
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()


class Session(Blocking, SessionMethods):
    """As a context manager, one that was created is deleted at the end of the block."""

    def __init__(self, channel: Channel, session_id: str, owned: bool):
        super().__init__(session_id)
        self._channel = channel
        self._owned = owned

    def _run(self, program: Program[Any]) -> Any:
        return self._channel.run(program)

    def _iterate(self, program: Program[Any]) -> Iterator[Any]:
        return self._channel.iterate(program)

    def open_stream(self, handle_set_id: str, options: StreamOptions = StreamOptions(),
                    **call: Any) -> Stream:
        """Opens a live Stream and waits until the server has opened it. `timeout` is that of the whole
        stream; without one it may last for ever."""
        return Stream(self._channel, self, handle_set_id, options, CallOptions(**call))

    def __enter__(self) -> Session:
        return self

    def __exit__(self, *error: Any) -> None:
        if not self._owned:
            return
        try:
            self.delete()
        except faults.ArapError as wrong:
            # What went wrong before is what counts, and what is gone is what was wanted.
            if error[0] is None and wrong.reason is not faults.Reason.NOT_FOUND:
                raise


class _Driver:
    """Carries the programs of a StreamCore out, with a lock around them."""

    def __init__(self, channel: Channel):
        self.changed = threading.Condition()
        self.channel = channel
        self.core: StreamCore  # set before anything runs
        self._own: list[Channel] = []  # a connection of the stream's own

    def _do(self, command: Any) -> Any:
        if isinstance(command, Begin):
            if command.fresh:
                self.close_own()
                self.channel = self.channel.another()
                self._own.append(self.channel)
            return self.channel.begin(command)
        if isinstance(command, Next):
            return command.call.read()
        return command.call.wait_sent(command.most)

    def run(self, program: Program[T]) -> T:
        told: Any = None
        with self.changed:
            try:
                while True:
                    command = program.send(told)
                    if isinstance(command, Changed):
                        told = self._wait(command.seconds)
                        continue
                    self.changed.release()
                    try:
                        told = self._do(command)
                    finally:
                        self.changed.acquire()
            except StopIteration as stop:
                answer: T = stop.value
                return answer
            finally:
                program.close()

    def _wait(self, seconds: float | None) -> bool:
        if seconds is None:
            return self.changed.wait()
        with self.channel.reconnecting():  # only pauses between openings have an end
            return self.changed.wait(seconds)

    def watch(self) -> None:
        with self.changed:
            while (seconds := self.core.tick()) is not None:
                self.changed.wait(seconds)

    def cancel(self) -> None:
        with self.changed:
            self.core.cancel()

    def close_own(self) -> None:
        while self._own:
            self._own.pop().close()


class Stream:
    """Live deformation: updates go out, shapes come back, in the order of the updates.

    A stream that is asked to resume (StreamOptions.resume_within) survives its server: read() opens it
    again, on whichever server answers, says again what the new one has to know, and answers Resumed.
    The shapes that follow are those of an uninterrupted stream, and no answer comes twice. Somebody
    has to read for that. Meanwhile sends to a "latest" stream are kept, newer ones in the place of
    older ones, and sends to an "every" stream wait.

    One thread may read while others send; cancel() may be called from any. Iterating reads to the
    end. As a context manager the stream is cancelled at the end of the block."""

    def __init__(self, channel: Channel, session: Session, handle_set_id: str,
                 options: StreamOptions, call: CallOptions):
        driver = _Driver(channel)
        self._driver = driver
        self._reading = threading.Lock()
        self._core = driver.core = StreamCore(session.id, handle_set_id, options, session._sizes,
                                              call, driver.changed.notify_all)
        self._finalizer = weakref.finalize(self, driver.cancel)
        threading.Thread(target=driver.watch, name="arapd stream", daemon=True).start()
        try:
            driver.run(self._core.open())
        except BaseException:
            self.cancel()
            raise

    @property
    def handle_set(self) -> model.HandleSet:
        """As it was when the stream opened."""
        assert self._core.handle_set is not None
        return self._core.handle_set

    @property
    def connected(self) -> bool:
        """Whether the server has opened it, and it is not known to be lost."""
        return self._core.connected

    @property
    def counts(self) -> Counts:
        """How many updates and edits were sent, answered, refused and replaced by newer ones."""
        return self._core.counts

    def send(self, targets: model.Targets | None = None, *, positions: Any = None,
             picks: Any = None, sequence: int | None = None, measure: bool = False) -> int:
        """Moves handles: `targets` of some of them, the others stay where they are; or `positions` of
        all, n×2 in the order of the set. `picks`: n×2 deformed points to find at rest, at most 1024.
        `measure`: measure the shape whatever measure_every says, or the one that answers a newer update
        in its place; where a hand rests, an update of this alone asks for the quality of what stays.
        Answers the sequence, which answers repeat: the one given, which has to grow, or the next.

        Waits until no more than this update has to be taken by the transport, an "every" stream until
        it has taken this one too. PROTOCOL: the stream is over; reading says why."""
        wanted, points = _requests.targets_of(targets or {}), positions_of(positions)
        found = picks_of(picks)
        return self._driver.run(self._core.send(
            lambda number: _replay.update(number, wanted, points, found, measure), sequence))

    def edit(self, remove: Sequence[str] = (), add: Sequence[model.Handle] = (), *,
             sequence: int | None = None) -> int:
        """Changes the handle set of this stream; removals come first. The answer is a Shape with the
        next revision. An added handle starts where the shape has it."""
        return self._driver.run(self._core.send(
            lambda number: _replay.edit(number, remove, add), sequence))

    def ping(self, nonce: int = 0) -> None:
        """Asks for a sign of life."""
        with self._driver.changed:
            self._core.ping(nonce)

    def close_sending(self) -> None:
        """Says that nothing more will be sent. The server answers what is pending and ends the
        stream."""
        with self._driver.changed:
            self._core.close_sending()

    def read(self) -> model.Event | None:
        """Waits for the next event. None: the stream ended well. ArapError: it is broken, or could not
        be resumed in time. Reads after either repeat it."""
        with self._reading:
            event = self._driver.run(self._core.read())
        if event is None:
            self._driver.close_own()
        return event

    def cancel(self) -> None:
        """Ends the stream at once; a waiting read is CANCELLED."""
        self._finalizer()
        self._driver.close_own()

    def __iter__(self) -> Iterator[model.Event]:
        return iter(self.read, None)

    def __enter__(self) -> Stream:
        return self

    def __exit__(self, *_: Any) -> None:
        self.cancel()
