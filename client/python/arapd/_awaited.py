"""What a stream waits for. AwaitedAnswers: which updates and edits have no answer yet, by which an
answer is known for one that was asked for. SignsOfLife: when to ask the server for a sign of life,
which answers belong to whom, and when it has been silent for too long. Times are the caller's to
tell, in seconds of time.monotonic()."""

from __future__ import annotations

import dataclasses
from collections import deque

from ._replay import Said
from .faults import refuse


@dataclasses.dataclass(frozen=True, slots=True)
class Asked:
    """What was asked of an answer."""

    picks: int | None  # how many, when that is known
    measured: bool  # for an edit or an update that asks for it, or in the place of such a one


@dataclasses.dataclass(slots=True)
class _Awaited:
    first: int
    last: int  # the same for a single one
    count: int
    asked: Asked
    since: float


class AwaitedAnswers:
    """Answers come in the order of what they answer; with `every` nothing is left out, else newer
    updates may take the place of older ones. Older ones than MOST_APART are known as a range only,
    unless `every`."""

    MOST_APART = 4096

    def __init__(self, every: bool):
        self._every = every
        self._awaited: deque[_Awaited] = deque()

    def sent(self, said: Said, now: float) -> None:
        asked = Asked(said.picks, said.is_edit or said.measure)
        self._awaited.append(_Awaited(said.sequence, said.sequence, 1, asked, now))
        if not self._every and len(self._awaited) > self.MOST_APART:
            self._shorten()

    def restart(self, messages: list[Said], now: float) -> None:
        """A new call begins, on which these are said first."""
        self._awaited.clear()
        for said in messages:
            self.sent(said, now)

    def _shorten(self) -> None:
        half = [self._awaited.popleft() for _ in range(len(self._awaited) // 2)]
        self._awaited.appendleft(_Awaited(
            min(a.first for a in half), max(a.last for a in half), sum(a.count for a in half),
            Asked(None, False), half[0].since))

    def take(self, sequence: int) -> Asked:
        """The answer to this sequence came: what was asked of it. ArapError INTERNAL when none of that
        sequence is due."""
        measured = False
        for place, awaited in enumerate(self._awaited):
            measured = measured or awaited.asked.measured
            if awaited.first <= sequence <= awaited.last:
                single = awaited.first == awaited.last  # more of a range may be answered yet
                for _ in range(place + single):
                    self._awaited.popleft()
                return Asked(awaited.asked.picks, measured)
            if self._every:
                break
        return refuse(f"the sequence {sequence}, for which it was not asked.")

    @property
    def oldest(self) -> float | None:
        """Since when the oldest waits."""
        return self._awaited[0].since if self._awaited else None


class SignsOfLife:
    """Of the user's pings and the stream's own. The server answers each, in order."""

    def __init__(self, heartbeat: float, silence: float):
        self._heartbeat = heartbeat
        self._silence = silence
        self._asked: deque[int | None] = deque()  # without answer; our own have no nonce
        self._waiting = False  # somebody reads
        self._heard = 0.0  # while somebody reads, since when nothing was heard
        self._last_asked = 0.0  # or when the call was begun

    def restart(self, now: float) -> None:
        """A new call begins. Our own questions were lost with the call before."""
        self._asked = deque(nonce for nonce in self._asked if nonce is not None)
        self._last_asked = now

    def set_waiting(self, waiting: bool, now: float) -> None:
        """Somebody begins to wait for a message, or has got one, or knows that there is none."""
        self._waiting = waiting
        self._heard = now

    def ask(self, nonce: int | None, is_open: bool, now: float) -> None:
        """A question goes out: the user's with its nonce, or our own. While the call is not open yet,
        only our own go out; the user's are kept and come behind them."""
        if nonce is not None or is_open:
            self._asked.append(nonce)
        else:
            self._asked.appendleft(nonce)
        self._last_asked = now

    def answered(self, nonce: int) -> bool:
        """An answer came; whether it is one to the user. ArapError INTERNAL when none is due."""
        if not self._asked or (self._asked[0] or 0) != nonce:
            refuse("a ping that was not sent.")
        return self._asked.popleft() is not None

    def unanswered(self) -> list[int]:
        """The user's questions without answer, in order."""
        return [nonce for nonce in self._asked if nonce is not None]

    def is_silent(self, now: float) -> bool:
        """Whether the server counts as gone."""
        return self._waiting and now - self._heard >= self._silence

    def is_due(self, clear: bool, now: float) -> bool:
        """Whether to ask. `clear`: the transport takes more."""
        # While nobody reads, answers are not seen: we go on asking as long as the server takes it.
        if None in self._asked and (self._waiting or not clear):
            return False
        return now - (self._heard if self._waiting else self._last_asked) >= self._heartbeat
