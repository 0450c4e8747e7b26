"""Long work in steps, with heartbeats in between, so that the node is not reported as hanging."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import islice
from typing import Final, TypeVar

T = TypeVar("T")

_STEP: Final = 1000


def with_progress(items: Iterable[T], progress: Callable[[], None]) -> Iterator[T]:
    """Yield the items and call `progress` now and then."""
    for i, item in enumerate(items, start=1):
        if i % _STEP == 0:
            progress()
        yield item


def split_batches(items: Iterable[T], size: int, progress: Callable[[], None]) -> Iterator[Sequence[T]]:
    """Yield the items in batches of `size`, and call `progress` before each."""
    rest = iter(items)
    while part := list(islice(rest, size)):
        progress()
        yield part
