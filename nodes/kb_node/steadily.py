"""Long work in steps: between them the node tells that it lives, or it would be taken for hanging."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from itertools import islice
from typing import Final, TypeVar

from nodes.kb_node.reasoner import Change, Reasoner
from schemas.explanations import Triple

T = TypeVar("T")

PART = 250_000
"""Triples that the reasoner takes in at once, in a second or two; in smaller parts it takes longer in all."""
_STEP: Final = 1000


def steadily(items: Iterable[T], progress: Callable[[], None]) -> Iterator[T]:
    """The items; `progress` is called now and then."""
    for i, item in enumerate(items):
        if i % _STEP == 0:
            progress()
        yield item


def apply(
    reasoner: Reasoner, delete: Collection[Triple], insert: Collection[Triple], progress: Callable[[], None]
) -> Change:
    """`reasoner.apply`, a large change in parts; `progress` is called before each. Raises Inconsistent.

    A part of a consistent map is consistent, so no more is refused. On any error all is as before.
    """
    if len(delete) + len(insert) <= PART or not reasoner.is_compiled:
        return reasoner.apply(delete=delete, insert=insert)
    changes, deleted, inserted = list[Change](), list[Triple](), list[Triple]()
    try:
        for part in _parts(delete, progress):
            changes.append(reasoner.apply(delete=part))
            deleted += part
        for part in _parts(insert, progress):
            changes.append(reasoner.apply(insert=part))
            inserted += part
    except BaseException:
        reasoner.apply(delete=inserted, insert=deleted)
        raise
    return Change.together(changes)


def _parts(items: Iterable[T], progress: Callable[[], None]) -> Iterator[Sequence[T]]:
    rest = iter(items)
    while part := list(islice(rest, PART)):
        progress()
        yield part
