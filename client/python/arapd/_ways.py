"""The two ways of waiting: of one method that makes a program, a client that blocks has one that
answers its result, and a client of asyncio one whose answer is awaited. Types say so too."""

from __future__ import annotations

import functools
import inspect
from collections.abc import AsyncIterator, Callable, Iterator
from typing import TYPE_CHECKING, Any, Concatenate, Generic, ParamSpec, TypeVar, overload

from ._calls import Program

if TYPE_CHECKING:
    from ._async_io import Pending

S = TypeVar("S")
P = ParamSpec("P")
T = TypeVar("T")


class Blocking:
    """What carries programs out while the caller waits: `_run` answers what one answers, `_iterate` an
    iterator of what it emits."""


class Awaited:
    """The same for asyncio: `_run` answers a Pending, `_iterate` an asynchronous iterator."""


if TYPE_CHECKING:
    class _Call(Generic[P, T]):
        @overload
        def __get__(self, instance: Blocking, owner: type) -> Callable[P, T]: ...
        @overload
        def __get__(self, instance: Awaited, owner: type) -> Callable[P, Pending[T]]: ...
        def __get__(self, instance: object, owner: type) -> Any: ...

    class _Each(Generic[P, T]):
        @overload
        def __get__(self, instance: Blocking, owner: type) -> Callable[P, Iterator[T]]: ...
        @overload
        def __get__(self, instance: Awaited, owner: type) -> Callable[P, AsyncIterator[T]]: ...
        def __get__(self, instance: object, owner: type) -> Any: ...


def _show(method: Callable[..., Any], make: Callable[..., Any], answer: str) -> None:
    """help() shows what the method answers."""
    signature = inspect.signature(make).replace(return_annotation=answer)
    setattr(method, "__signature__", signature)


def call(make: Callable[Concatenate[S, P], Program[T]]) -> _Call[P, T]:
    """The method that runs what `make` makes."""
    @functools.wraps(make)
    def method(self: Any, *args: Any, **named: Any) -> Any:
        return self._run(make(self, *args, **named))
    made = str(inspect.signature(make).return_annotation)
    _show(method, make, made.removeprefix("Program[").removesuffix("]"))
    return method  # type: ignore[return-value]


def each(value: type[T]) -> Callable[[Callable[Concatenate[S, P], Program[Any]]], _Each[P, T]]:
    """The method that iterates over the values, of this type, that what is made emits."""
    def of(make: Callable[Concatenate[S, P], Program[Any]]) -> _Each[P, T]:
        @functools.wraps(make)
        def method(self: Any, *args: Any, **named: Any) -> Any:
            return self._iterate(make(self, *args, **named))
        _show(method, make, f"Iterator[model.{value.__name__}]")
        return method  # type: ignore[return-value]
    return of
