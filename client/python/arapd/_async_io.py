"""Carries programs out on an event loop: calls, streams of answers, and the two-way call of a
stream."""

from __future__ import annotations

import asyncio
import weakref
from collections.abc import AsyncIterator, Awaitable, Callable, Coroutine, Generator
from typing import Any

import grpc
import grpc.aio

from . import faults
from ._calls import Emit, Ended, Pause, Program, Read, Start, T, Unary, ended_by
from ._channel import ChannelPlan
from ._replay import Said
from ._stream_parts import Begin, Outbox, Talker

_CANCELLED = Ended(grpc.StatusCode.CANCELLED, "The call was cancelled.")


class Reading:
    """A call with many answers, of which nothing is read ahead."""

    def __init__(self, rpc: Any):
        self._rpc = rpc
        self.ended: Ended | None = None
        self.overdue = False

    async def read(self) -> bytes | None:
        # In a task of its own: grpc cancels a call whose read is cancelled.
        reading = asyncio.ensure_future(self._rpc.read())
        try:
            await asyncio.wait([reading])
        except asyncio.CancelledError:
            self.cancel()
            raise
        if reading.cancelled():
            self.ended = _CANCELLED
            return None
        error = reading.exception()
        if error is None:
            data = reading.result()
            if data is not grpc.aio.EOF:
                answer: bytes = data
                return answer
            self.ended = Ended(await self._rpc.code(), await self._rpc.details() or "")
        elif isinstance(error, grpc.RpcError):
            self.ended = ended_by(error)
        else:
            raise error
        return None

    async def read_within(self, seconds: float) -> bytes | None:
        """As read(); cancels the call when nothing comes for so long."""
        timer = asyncio.get_running_loop().call_later(min(seconds, 1e6), self._give_up)
        try:
            return await self.read()
        finally:
            timer.cancel()

    def _give_up(self) -> None:
        self.overdue = True
        self._rpc.cancel()

    def cancel(self) -> None:
        self._rpc.cancel()


class Talking(Reading, Talker):
    """The call of a stream."""

    def __init__(self, rpc: Any):
        super().__init__(rpc)
        self._outbox = Outbox()
        self._changed = Signal()
        self._rpc.add_done_callback(lambda _: self._over())
        self._writer = asyncio.ensure_future(self._write())

    def _over(self) -> None:
        self._outbox.over = True
        self._changed.notify()

    async def _write(self) -> None:
        try:
            while not self._outbox.over:
                data = self._outbox.take()
                if data is not None:
                    await self._rpc.write(data)
                    self._outbox.taken()
                    self._changed.notify()
                elif self._outbox.end_wanted:
                    await self._rpc.done_writing()
                    return
                else:
                    await self._changed.wait()
        except (grpc.RpcError, asyncio.InvalidStateError, asyncio.CancelledError):
            self._over()  # reading tells why

    def push(self, data: bytes, said: Said | None = None) -> None:
        self._outbox.push(data, said)
        self._changed.notify()

    def push_end(self) -> None:
        self._outbox.end_wanted = True
        self._changed.notify()

    async def wait_sent(self, most: int) -> bool:
        await asyncio.sleep(0)  # who sends without end lets others have their turn
        while not self._outbox.over and self._outbox.left > most:
            await self._changed.wait()
        return not self._outbox.over


async def drive(program: Program[T], do: Callable[[Any], Awaitable[Any]]) -> T:
    """What a program answers whose commands `do` carries out. It emits nothing."""
    told = None
    try:
        while True:
            told = await do(program.send(told))
    except StopIteration as stop:
        answer: T = stop.value
        return answer
    finally:
        program.close()


class Signal:
    """Wakes everybody who waits for it."""

    def __init__(self) -> None:
        self._event = asyncio.Event()

    def notify(self) -> None:
        self._event.set()
        self._event = asyncio.Event()

    async def wait(self, seconds: float | None = None) -> None:
        try:
            await asyncio.wait_for(self._event.wait(), seconds)
        except asyncio.TimeoutError:
            pass


class Pending(Coroutine[Any, Any, T]):
    """A coroutine whose answer may be entered: `async with client.create_session() as session`."""

    def __init__(self, coroutine: Coroutine[Any, Any, T]):
        self._coroutine = coroutine
        self._entered: Any = None

    def send(self, value: Any) -> Any:
        return self._coroutine.send(value)

    def throw(self, *error: Any) -> Any:
        return self._coroutine.throw(*error)

    def close(self) -> None:
        self._coroutine.close()

    def __await__(self) -> Generator[Any, Any, T]:
        return self._coroutine.__await__()

    async def __aenter__(self) -> T:
        answer = await self
        entered: Any = answer
        self._entered = entered
        await entered.__aenter__()
        return answer

    async def __aexit__(self, *error: Any) -> None:
        await self._entered.__aexit__(*error)


class Channel:
    """A connection, made anew where a stream asks for it."""

    def __init__(self, plan: ChannelPlan):
        self._plan = plan
        self._grpc = plan.make(grpc.aio)
        self._closed = False
        # grpc finds out by itself only about calls on which somebody waits when it is closed.
        self._open: weakref.WeakSet[Any] = weakref.WeakSet()

    def another(self) -> Channel:
        return Channel(self._plan)

    async def close(self) -> None:
        self._closed = True
        for rpc in list(self._open):
            rpc.cancel()
        await self._grpc.close()

    async def wait_ready(self, timeout: float) -> bool:
        try:
            await asyncio.wait_for(self._grpc.channel_ready(), timeout)
        except asyncio.TimeoutError:
            return False
        return True

    def begin(self, command: Begin) -> Talking:
        return Talking(self._call(self._grpc.stream_stream(command.path), command))

    def _call(self, method: Callable[..., Any], command: Any, *request: Any) -> Any:
        if self._closed:
            raise faults.cancelled("The client was closed.")
        rpc = method(*request, timeout=command.timeout,
                     metadata=command.metadata + self._plan.identity)
        self._open.add(rpc)
        return rpc

    async def _do(self, command: Any) -> Any:
        if isinstance(command, Unary):
            try:
                rpc = self._call(self._grpc.unary_unary(command.path), command, command.request)
                return Ended(grpc.StatusCode.OK, answer=await rpc)
            except grpc.RpcError as error:
                return ended_by(error)
            except (grpc.aio.UsageError, asyncio.CancelledError):
                if self._closed:
                    raise faults.cancelled("The client was closed.") from None
                raise
        if isinstance(command, Pause):
            return await asyncio.sleep(command.seconds)
        if isinstance(command, Start):
            return Reading(self._call(self._grpc.unary_stream(command.path), command,
                                      command.request))
        assert isinstance(command, Read)
        return await command.handle.read_within(command.limit)

    def run(self, program: Program[T]) -> Pending[T]:
        """What a program answers that emits nothing."""
        return Pending(drive(program, self._do))

    async def iterate(self, program: Program[T]) -> AsyncIterator[Any]:
        """What a program emits."""
        told = None
        try:
            while True:
                command = program.send(told)
                if isinstance(command, Emit):
                    told = None
                    yield command.value
                else:
                    told = await self._do(command)
        except StopIteration:
            return
        finally:
            program.close()
