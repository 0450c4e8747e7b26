"""Attributes that are worked out when they are first asked for."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Generic, TypeVar

T = TypeVar("T")


class lazily(Generic[T]):  # noqa: N801 - it is used as a decorator
    """Like `functools.cached_property`, without its lock, which took a quarter of the time of all relations.

    So an object that has such attributes belongs to one thread.
    """

    def __init__(self, work_out: Callable[[Any], T]) -> None:
        self._work_out = work_out
        self._name = work_out.__name__
        self.__doc__ = work_out.__doc__

    def __get__(self, owner: Any, _: type | None = None) -> T:
        value: T = self._work_out(owner)
        owner.__dict__[self._name] = value
        return value
