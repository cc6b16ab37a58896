"""The small parts of a stream: what its programs wait for, what waits to be sent, what is counted."""

from __future__ import annotations

import dataclasses
import time
from collections import deque
from typing import Any

from ._calls import Backoff
from ._replay import Said


@dataclasses.dataclass(frozen=True, slots=True)
class Begin:
    path: str
    timeout: float | None
    metadata: tuple[tuple[str, str], ...]
    fresh: bool  # over a new connection, because the old one may be dead without saying so


@dataclasses.dataclass(frozen=True, slots=True)
class Next:
    call: Any


@dataclasses.dataclass(frozen=True, slots=True)
class Changed:
    seconds: float | None


@dataclasses.dataclass(frozen=True, slots=True)
class Sent:
    call: Any
    most: int


@dataclasses.dataclass(slots=True)
class Trouble:
    """From a loss until the server has answered what was said again."""

    until: float
    backoff: Backoff = dataclasses.field(default_factory=Backoff)
    opened: float = 0.0  # again, the last time
    last_said: int = 0  # the sequence


class Outbox:
    """What waits to be sent on one call, and since when the transport has not taken what it has.

    Not thread-safe by itself."""

    def __init__(self) -> None:
        self.end_wanted = False
        self.over = False
        self.writing_since: float | None = None
        self._unsent: deque[tuple[bytes, Said | None]] = deque()

    def push(self, data: bytes, said: Said | None = None) -> None:
        """Puts a message behind the others. With `said`, in the place of the last one where that is
        an update that this one covers."""
        if self.over:
            return
        if said is not None and self._unsent:
            last = self._unsent[-1][1]
            if last is not None and said.covers(last):
                self._unsent.pop()
        self._unsent.append((data, said))

    def take(self) -> bytes | None:
        """The next message, for the transport; None when there is none."""
        if not self._unsent or self.over:
            return None
        self.writing_since = time.monotonic()
        return self._unsent.popleft()[0]

    def taken(self) -> None:
        """The transport has it."""
        self.writing_since = None

    @property
    def left(self) -> int:
        """How many messages the transport does not have."""
        return len(self._unsent) + (self.writing_since is not None)

    @property
    def is_clear(self) -> bool:
        return not self.over and self.left == 0


class Talker:
    """What a call of a stream tells of what waits to be sent on it."""

    _outbox: Outbox

    @property
    def is_clear(self) -> bool:
        return self._outbox.is_clear

    @property
    def writing_since(self) -> float | None:
        return self._outbox.writing_since


class Counts:
    """Of the updates and edits of a stream."""

    _MOST_APART = 4096

    def __init__(self) -> None:
        self.sent = 0
        self.answered = 0  # by a shape
        self.refused = 0  # by an error
        self.replaced = 0  # by newer ones: they have no answer of their own
        self.resumed = 0  # how often the stream was opened again
        self._sent: deque[tuple[int, int]] = deque()  # a sequence, and how many were sent with it

    def note_sent(self, sequence: int) -> None:
        self.sent += 1
        self._sent.append((sequence, self.sent))
        if len(self._sent) > self._MOST_APART:  # the older half is known by its end only
            for _ in range(self._MOST_APART // 2):
                self._sent.popleft()

    def note_answer(self, sequence: int, good: bool) -> int:
        """How many were replaced since the answer before."""
        done = self.answered + self.refused + self.replaced
        while self._sent and self._sent[0][0] <= sequence:
            done = self._sent.popleft()[1]
        if good:
            self.answered += 1
        else:
            self.refused += 1
        before = self.replaced
        self.replaced = max(before, done - self.answered - self.refused)
        return self.replaced - before
