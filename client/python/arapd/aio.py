"""The client for asyncio: what arapd is, with `await`, `async with` and `async for`.

    async with arapd.aio.connect("localhost:50051") as client:
        async with client.create_session() as session:
            mesh = (await session.register_mesh(vertices, triangles)).mesh
            await session.compile_handles("puppet", mesh.id, handles)
            async with session.open_stream("puppet") as stream:
                await stream.send({"head": (0.0, 60.0)})
                shape = await stream.read()

What the calls are is told in _api.py and _session.py; here each answers a coroutine. Cancelling the
task cancels the call, but for reads of a stream, which may be given up (asyncio.wait_for) and read
again without loss. A client belongs to one event loop.
"""

from __future__ import annotations

import asyncio
import datetime
from collections.abc import AsyncIterator, Mapping, Sequence
from typing import Any

from . import _replay, _requests, faults, model
from ._api import ClientMethods
from ._async_io import Channel, Pending, Signal, drive
from ._calls import CallOptions, Program
from ._channel import ChannelPlan, ConnectOptions
from ._session import SessionMethods
from ._stream import StreamCore, picks_of, positions_of
from ._stream_parts import Begin, Changed, Counts, Next
from ._stream_state import StreamOptions
from ._ways import Awaited


def connect(address: str, **options: Any) -> Client:
    """As arapd.connect. Call it where the event loop runs."""
    return Client(address, ConnectOptions(**options))


class Client(Awaited, ClientMethods):
    """Use it with `async with`, or close() it."""

    def __init__(self, address: str, options: ConnectOptions = ConnectOptions()):
        self._channel = Channel(ChannelPlan(address, options))

    def _run(self, program: Program[Any]) -> Any:
        return self._channel.run(program)

    def create_session(self, session_id: str | None = None, *,
                       ttl: float | datetime.timedelta | None = None,
                       labels: Mapping[str, str] | None = None, **call: Any) -> Pending[Session]:
        """As of arapd.Client; `async with` enters it."""
        return self._channel.run(self._creation(
            lambda name: Session(self._channel, name, True), session_id, ttl, labels, call))

    def attach_session(self, session_id: str) -> Session:
        """A Session that exists already; asks nothing. It stays at the end of an `async with` block."""
        return Session(self._channel, session_id, False)

    async def wait_ready(self, timeout: float) -> None:
        """Waits until the connection stands; DEADLINE_EXCEEDED after so many seconds."""
        if not await self._channel.wait_ready(timeout):
            raise faults.overdue("No connection to the server in time.")

    async def close(self) -> None:
        """Ends the connection, and what is under way on it."""
        await self._channel.close()

    async def __aenter__(self) -> Client:
        return self

    async def __aexit__(self, *_: Any) -> None:
        await self.close()


class Session(Awaited, SessionMethods):
    """With `async with`, one that was created is deleted at the end of the block."""

    def __init__(self, channel: Channel, session_id: str, owned: bool):
        super().__init__(session_id)
        self._channel = channel
        self._owned = owned

    def _run(self, program: Program[Any]) -> Any:
        return self._channel.run(program)

    def _iterate(self, program: Program[Any]) -> AsyncIterator[Any]:
        return self._channel.iterate(program)

    def open_stream(self, handle_set_id: str, options: StreamOptions = StreamOptions(),
                    **call: Any) -> Pending[Stream]:
        """Opens a live Stream, once the server has opened it. `timeout` is that of the whole stream;
        without one it may last for ever."""
        stream = Stream(self._channel, self, handle_set_id, options, CallOptions(**call))
        return Pending(stream._open())

    async def __aenter__(self) -> Session:
        return self

    async def __aexit__(self, *error: Any) -> None:
        if not self._owned:
            return
        try:
            await self.delete()
        except faults.ArapError as wrong:
            # What went wrong before is what counts, and what is gone is what was wanted.
            if error[0] is None and wrong.reason is not faults.Reason.NOT_FOUND:
                raise


class Stream:
    """As arapd.Stream: one task may read while others send."""

    def __init__(self, channel: Channel, session: Session, handle_set_id: str,
                 options: StreamOptions, call: CallOptions):
        self._channel = channel
        self._own: list[Channel] = []  # a connection of the stream's own
        self._changed = Signal()
        self._core = StreamCore(session.id, handle_set_id, options, session._sizes, call,
                                self._changed.notify)
        self._watching: asyncio.Task[Any] | None = None
        self._reading: asyncio.Task[model.Event | None] | None = None

    async def _open(self) -> Stream:
        self._watching = asyncio.create_task(self._watch())
        try:
            await drive(self._core.open(), self._do)
        except BaseException:
            await self.close()
            raise
        return self

    async def _do(self, command: Any) -> Any:
        if isinstance(command, Changed):
            return await self._changed.wait(command.seconds)
        if isinstance(command, Begin):
            if command.fresh:
                await self._close_own()
                self._channel = self._channel.another()
                self._own.append(self._channel)
            return self._channel.begin(command)
        if isinstance(command, Next):
            return await command.call.read()
        return await command.call.wait_sent(command.most)

    async def _watch(self) -> None:
        while (seconds := self._core.tick()) is not None:
            await self._changed.wait(seconds)

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

    async def send(self, targets: model.Targets | None = None, *, positions: Any = None,
                   picks: Any = None, sequence: int | None = None, measure: bool = False) -> int:
        """As arapd.Stream.send."""
        wanted, points = _requests.targets_of(targets or {}), positions_of(positions)
        found = picks_of(picks)
        return await drive(self._core.send(
            lambda number: _replay.update(number, wanted, points, found, measure), sequence),
            self._do)

    async def edit(self, remove: Sequence[str] = (), add: Sequence[model.Handle] = (), *,
                   sequence: int | None = None) -> int:
        """As arapd.Stream.edit."""
        return await drive(self._core.send(
            lambda number: _replay.edit(number, remove, add), sequence), self._do)

    async def ping(self, nonce: int = 0) -> None:
        """Asks for a sign of life."""
        self._core.ping(nonce)

    async def close_sending(self) -> None:
        """As arapd.Stream.close_sending."""
        self._core.close_sending()

    async def read(self) -> model.Event | None:
        """As arapd.Stream.read. A read that is given up loses nothing: the next one goes on with it."""
        if self._reading is None:
            self._reading = asyncio.create_task(drive(self._core.read(), self._do))
            # Who gave up may never ask how it ended.
            self._reading.add_done_callback(lambda task: task.cancelled() or task.exception())
        reading = self._reading
        await asyncio.wait([reading])
        if self._reading is reading:
            self._reading = None
        event = reading.result()
        if event is None:
            await self._close_own()
        return event

    def cancel(self) -> None:
        """Ends the stream at once; a waiting read is CANCELLED."""
        self._core.cancel()

    async def close(self) -> None:
        """Cancels the stream, and waits until nothing of it is left."""
        self.cancel()
        tasks = [task for task in (self._watching, self._reading) if task is not None]
        if tasks:
            await asyncio.wait(tasks)
        await self._close_own()

    async def _close_own(self) -> None:
        while self._own:
            await self._own.pop().close()

    def __aiter__(self) -> AsyncIterator[model.Event]:
        return self

    async def __anext__(self) -> model.Event:
        event = await self.read()
        if event is None:
            raise StopAsyncIteration
        return event

    async def __aenter__(self) -> Stream:
        return self

    async def __aexit__(self, *_: Any) -> None:
        await self.close()
