"""Long work in steps: between them the node tells that it lives, or it would be taken for hanging."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import islice
from typing import Final, TypeVar

T = TypeVar("T")

_STEP: Final = 1000


def with_progress(items: Iterable[T], progress: Callable[[], None]) -> Iterator[T]:
    """The items; `progress` is called now and then."""
    for i, item in enumerate(items, start=1):
        if i % _STEP == 0:
            progress()
        yield item


def split_batches(items: Iterable[T], size: int, progress: Callable[[], None]) -> Iterator[Sequence[T]]:
    """The items in parts of that size; `progress` is called before each."""
    rest = iter(items)
    while part := list(islice(rest, size)):
        progress()
        yield part
