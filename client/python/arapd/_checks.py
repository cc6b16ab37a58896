"""What every answer has to fulfil before anything of it is handed out. ArapError INTERNAL says what
does not fit. Numbers that only tell (times, counts of warnings, bytes) are taken as they are."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _wire
from .faults import refuse

_NAME = re.compile(r"[A-Za-z0-9._-]{1,128}")
MOST_PICKS = 1024


def is_name(text: str) -> bool:
    return _NAME.fullmatch(text) is not None


def quote(text: str) -> str:
    clean = "".join(c if " " <= c <= "~" else "?" for c in text[:64])
    return f'"{clean}"' + ("..." if len(text) > 64 else "")


def name(answered: str, asked: str | None, what: str) -> None:
    """`answered` is the id that was asked for; any id when None was."""
    if asked is None:
        if not is_name(answered):
            refuse(f"the {what} {quote(answered)}, which is no id.")
    elif answered != asked:
        refuse(f"the {what} {quote(answered)}, not {quote(asked)}.")


def count(answered: int, expected: int, what: str) -> None:
    if answered != expected:
        refuse(f"{answered} {what}, not {expected}.")


def finite(numbers: Iterable[float], what: str) -> None:
    if not all(math.isfinite(number) for number in numbers):
        refuse(f"a number of {what} that is not finite.")


def run(message: Any, field: str, what: str) -> NDArray[Any]:
    """A run of numbers."""
    try:
        return _wire.numbers(message, field)
    except ValueError:
        refuse(f"{what} in a run of odd length.")


def groups(numbers: NDArray[Any], columns: int, what: str) -> NDArray[Any]:
    if numbers.size % columns:
        refuse(f"{what} in a run of odd length.")
    return numbers.reshape(-1, columns)


def points(message: Any, field: str, columns: int, what: str) -> NDArray[Any]:
    """Finite numbers in groups."""
    return finite_rows(groups(run(message, field, what), columns, what), what)


def finite_rows(array: NDArray[Any], what: str) -> NDArray[Any]:
    if not np.isfinite(array).all():
        at = int(np.flatnonzero(~np.isfinite(array).all(axis=1))[0])
        refuse(f"{what} {at} that is not finite.")
    return array


def indices(values: Any, limit: int | None, what: str) -> NDArray[Any]:
    """Indices below a limit, if that is known."""
    array = np.fromiter(values, np.uint32, len(values))
    array.flags.writeable = False
    if limit is not None and array.size and array.max() >= limit:
        refuse(f"{what} {array.max()}, but there are only {limit}.")
    return array


def order(array: NDArray[Any]) -> None:
    """Every triangle once."""
    if not np.array_equal(np.sort(array), np.arange(array.size)):
        refuse("a drawing order that does not have every triangle once.")
