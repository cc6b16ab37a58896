"""Carries programs out by waiting: calls, streams of answers, and the two-way call of a stream."""

from __future__ import annotations

import contextlib
import functools
import math
import threading
import time
from collections.abc import Callable, Iterator
from typing import Any

import grpc

from . import faults
from ._calls import Emit, Ended, Pause, Program, Read, Start, T, Unary, ended_by
from ._channel import ChannelPlan
from ._replay import Said
from ._stream_parts import Begin, Outbox, Talker

_OK = Ended(grpc.StatusCode.OK)


class Reading:
    """A call with many answers, of which nothing is read ahead."""

    def __init__(self, rpc: Any):
        self._rpc = rpc
        self._patience: _Patience | None = None
        self.ended: Ended | None = None
        self.overdue = False

    def read(self) -> bytes | None:
        try:
            data: bytes = next(self._rpc)
            return data
        except StopIteration:
            self.ended = _OK
        except grpc.RpcError:
            self.ended = ended_by(self._rpc)
        except BaseException:  # Ctrl-C: grpc has asked for a message that nobody would take
            self.cancel()
            raise
        return None

    def read_within(self, seconds: float) -> bytes | None:
        """As read(); cancels the call when nothing comes for so long."""
        if self._patience is None:
            self._patience = _Patience(self._give_up)
        self._patience.begin(seconds)
        try:
            data = self.read()
        finally:
            self._patience.end()
        if data is None:
            self._patience.stop()
        return data

    def _give_up(self) -> None:
        self.overdue = True
        self._rpc.cancel()

    def cancel(self) -> None:
        self._rpc.cancel()
        if self._patience is not None:
            self._patience.stop()


class _Patience:
    """A thread that calls `give_up` when a wait has lasted too long."""

    def __init__(self, give_up: Callable[[], None]):
        self._changed = threading.Condition()
        self._until = math.inf
        self._stopped = False
        self._give_up = give_up
        threading.Thread(target=self._watch, name="arapd answers", daemon=True).start()

    def begin(self, seconds: float) -> None:
        with self._changed:
            self._until = time.monotonic() + seconds
            self._changed.notify()

    def end(self) -> None:
        with self._changed:
            self._until = math.inf

    def stop(self) -> None:
        with self._changed:
            self._stopped = True
            self._changed.notify()

    def _watch(self) -> None:
        with self._changed:
            while not self._stopped:
                left = self._until - time.monotonic()
                if left <= 0:
                    self._give_up()
                    return
                self._changed.wait(min(left, 3600.0))


class Talking(Reading, Talker):
    """The call of a stream. Messages may be pushed from any thread."""

    def __init__(self, begin: Any, timeout: float | None, metadata: tuple[tuple[str, str], ...]):
        self._changed = threading.Condition()
        self._outbox = Outbox()
        super().__init__(begin(iter(self._next_request, None), timeout=timeout, metadata=metadata))
        if not self._rpc.add_callback(self._over):
            self._over()

    def _over(self) -> None:
        with self._changed:
            self._outbox.over = True
            self._changed.notify_all()

    def _next_request(self) -> bytes | None:
        """On a thread of grpc, which asks for the next message when it has sent the one before."""
        with self._changed:
            self._outbox.taken()
            self._changed.notify_all()
            while not self._outbox.over:
                data = self._outbox.take()
                if data is not None:
                    return data
                if self._outbox.end_wanted:
                    return None
                self._changed.wait()
        return None

    def push(self, data: bytes, said: Said | None = None) -> None:
        with self._changed:
            self._outbox.push(data, said)
            self._changed.notify_all()

    def push_end(self) -> None:
        with self._changed:
            self._outbox.end_wanted = True
            self._changed.notify_all()

    def wait_sent(self, most: int) -> bool:
        with self._changed:
            self._changed.wait_for(lambda: self._outbox.over or self._outbox.left <= most)
            return not self._outbox.over


class Channel:
    """A connection, made anew where a stream asks for it."""

    def __init__(self, plan: ChannelPlan):
        self._plan = plan
        self._grpc = plan.make(grpc)
        self._closed = False
        self._looking: set[Callable[[Any], None]] = set()  # what keeps a thread of grpc at it

    def another(self) -> Channel:
        return Channel(self._plan)

    def close(self) -> None:
        self._closed = True
        # A thread of grpc looks for the server a moment longer than it is told to, and would say so on
        # stderr where the channel has gone meanwhile.
        for ignore in list(self._looking):
            self._grpc.unsubscribe(ignore)
        until = time.monotonic() + 1
        state = getattr(self._grpc, "_connectivity_state", None)
        while getattr(state, "polling", False) and time.monotonic() < until:
            time.sleep(0.005)
        self._grpc.close()

    def wait_ready(self, timeout: float) -> bool:
        ready = grpc.channel_ready_future(self._grpc)
        try:
            ready.result(timeout)
        except grpc.FutureTimeoutError:
            return False
        finally:
            ready.cancel()
        return True

    @contextlib.contextmanager
    def reconnecting(self) -> Iterator[None]:
        """While it lasts the channel looks for its server. grpc does nothing by itself between calls,
        so that one after a pause would still hear what was so before it."""
        def ignore(_: Any) -> None:
            pass

        if not self._closed:
            self._looking.add(ignore)
            self._grpc.subscribe(ignore)
        try:
            yield
        finally:
            self._looking.discard(ignore)
            self._grpc.unsubscribe(ignore)

    def begin(self, command: Begin) -> Talking:
        method = functools.partial(self._call, self._grpc.stream_stream(command.path))
        return Talking(method, command.timeout, command.metadata)

    def _call(self, method: Callable[..., Any], *request: Any, timeout: float | None,
              metadata: tuple[tuple[str, str], ...]) -> Any:
        try:
            return method(*request, timeout=timeout, metadata=metadata + self._plan.identity)
        except ValueError:
            if self._closed:
                raise faults.cancelled("The client was closed.") from None
            raise

    def _do(self, command: Any) -> Any:
        if isinstance(command, Unary):
            try:
                answer = self._call(self._grpc.unary_unary(command.path), command.request,
                                    timeout=command.timeout, metadata=command.metadata)
            except grpc.RpcError as error:
                return ended_by(error)
            return Ended(grpc.StatusCode.OK, answer=answer)
        if isinstance(command, Pause):
            with self.reconnecting():
                return time.sleep(command.seconds)
        if isinstance(command, Start):
            return Reading(self._call(self._grpc.unary_stream(command.path), command.request,
                                      timeout=command.timeout, metadata=command.metadata))
        assert isinstance(command, Read)
        return command.handle.read_within(command.limit)

    def run(self, program: Program[T]) -> T:
        """What a program answers that emits nothing."""
        result: list[T] = []
        for value in self.iterate(program, result):
            raise AssertionError(f"a program without takers has emitted {value!r}")
        return result[0]

    def iterate(self, program: Program[T], result: list[T] | None = None) -> Iterator[Any]:
        """What a program emits; what it answers is put into `result`."""
        told = None
        try:
            while True:
                command = program.send(told)
                if isinstance(command, Emit):
                    told = None
                    yield command.value
                else:
                    told = self._do(command)
        except StopIteration as stop:
            if result is not None:
                result.append(stop.value)
        finally:
            program.close()
