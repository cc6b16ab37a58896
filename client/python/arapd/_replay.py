"""What goes out on a stream, and what of it has to be said again on a new one, so that it goes on
where a lost one ended."""

from __future__ import annotations

import dataclasses
from collections import deque
from collections.abc import Mapping, Sequence
from typing import Any

from . import _requests, _wire
from .model import Handle, Target

_Request = _wire.message("StreamDeformRequest")
# From so many on, updates of a stream with delivery "latest" that newer ones replace become one.
MOST_PENDING = 256


@dataclasses.dataclass(frozen=True, slots=True)
class Said:
    """An update or an edit as it was sent."""

    sequence: int
    data: bytes
    is_edit: bool = False
    targets: Mapping[str, Target] = dataclasses.field(default_factory=dict)
    positions: bytes = b""
    picks: int = 0  # how many points
    measure: bool = False  # the shape, in any case

    def covers(self, older: Said) -> bool:
        """Whether nothing of an older update is of use any more."""
        if self.is_edit or older.is_edit or older.picks or (older.measure and not self.measure):
            return False
        if older.positions:
            return bool(self.positions)
        return not self.positions and older.targets.keys() <= self.targets.keys()


def update(sequence: int, targets: Mapping[str, Target], positions: bytes = b"",
           pick_points: bytes = b"", measure: bool = False) -> Said:
    request = _Request()
    out = request.update
    out.sequence = sequence
    out.targets.extend(_requests.target_message(*item) for item in targets.items())
    out.positions = positions
    out.pick_points = pick_points
    out.measure = measure
    return Said(sequence, request.SerializeToString(), False, targets, positions,
                len(pick_points) // 16, measure)


def _measured(said: Said) -> Said:
    """The same update, which asks to be measured."""
    request = _Request.FromString(said.data)
    request.update.measure = True
    return dataclasses.replace(said, data=request.SerializeToString(), measure=True)


def edit(sequence: int, remove: Sequence[str], add: Sequence[Handle]) -> Said:
    request = _Request()
    out = request.edit
    out.sequence = sequence
    out.remove.extend(remove)
    for handle in add:
        _requests.set_handle(out.add.add(), handle)
    return Said(sequence, request.SerializeToString(), True)


def ping(nonce: int) -> bytes:
    request = _Request()
    request.ping.nonce = nonce
    request.ping.SetInParent()
    return _wire.serialized(request)


class _Pose:
    """Targets that several updates have come to: single ones, then all positions at once, which leave
    angles and scales as they are, then single ones again. Each with the last sequence that it has
    something from."""

    def __init__(self) -> None:
        self.before: dict[str, Target] = {}
        self.positions = b""
        self.after: dict[str, Target] = {}
        self.before_sequence = self.positions_sequence = self.after_sequence = 0

    def add(self, said: Said) -> None:
        if said.positions:
            if self.after:
                self.before_sequence = self.after_sequence
                self.before.update(self.after)
                self.after = {}
            self.positions, self.positions_sequence = said.positions, said.sequence
        if said.targets:
            self.after_sequence = said.sequence
            self.after.update(said.targets)

    def say(self, out: list[Said]) -> None:
        if self.before:
            out.append(update(self.before_sequence, self.before))
        if self.positions:
            out.append(update(self.positions_sequence, {}, self.positions))
        if self.after:
            out.append(update(self.after_sequence, dict(self.after)))


class ReplayLog:
    """A stream's state on the server is its targets and what its edits have made of the handle set; a
    handle that is added starts where the shape of that moment has it. So the edits that were answered
    are kept, with the last targets before each; the targets after them, merged; and what was not
    answered, as it was sent. Memory: a target per handle and edit, and every update that has no
    answer, with `latest` about MOST_PENDING of them."""

    def __init__(self, latest: bool):
        self._latest = latest
        self._edits: list[tuple[_Pose, Said]] = []
        self._pose = _Pose()  # since the last edit
        self._pending: deque[Said] = deque()
        self._answered = -1  # the last sequence

    def sent(self, said: Said) -> None:
        """An update or an edit goes out; its sequence has grown."""
        self._pending.append(said)
        if self._latest and len(self._pending) > MOST_PENDING:
            self._fold()

    def _fold(self) -> None:
        # The last update before an edit, and the newest of all, are answered in any case: they stay
        # as they were sent. What answers in the place of one that asks to be measured is measured.
        folded: list[Said] = []
        pose = _Pose()
        measure = False
        entries = list(self._pending)
        for said, following in zip(entries, [*entries[1:], None]):
            if said.is_edit or following is None or following.is_edit:
                pose.say(folded)
                pose = _Pose()
                folded.append(_measured(said) if measure and not said.is_edit else said)
                measure = False
            else:
                pose.add(said)
                measure = measure or said.measure
        self._pending = deque(folded)

    def answered(self, sequence: int, good: bool) -> bool:
        """The answer to `sequence` came: a shape, or an error, which means that nothing was changed.
        False when it was answered before."""
        if sequence <= self._answered:
            return False
        self._answered = sequence
        while self._pending and self._pending[0].sequence <= sequence:
            said = self._pending.popleft()
            if good or said.sequence < sequence:
                self._keep(said)
        return True

    def _keep(self, said: Said) -> None:
        if said.is_edit:
            self._edits.append((self._pose, said))
            self._pose = _Pose()
        else:
            self._pose.add(said)

    def messages(self) -> list[Said]:
        """What to send behind the opening of a new stream, in this order; sequences grow."""
        out: list[Said] = []
        for pose, said in self._edits:
            pose.say(out)
            out.append(said)
        self._pose.say(out)
        return [*out, *self._pending]


def opening(session_id: str, handle_set_id: str, every: bool, options: Any) -> bytes:
    request = _Request()
    out = request.open
    out.session_id = session_id
    out.handle_set_id = handle_set_id
    out.delivery = _requests.choice("Delivery", "DELIVERY", "every" if every else "latest",
                                    "delivery")
    _requests.set_shape_options(out.options, options)
    return _wire.serialized(request)
