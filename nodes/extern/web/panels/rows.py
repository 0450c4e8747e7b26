"""Rows that stay while what they show stays: a change of one redraws no other, and closes nothing in it.

A button that is drawn anew between the press and the release of the mouse, or while its click is on its way,
is not clicked at all.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable
from typing import Generic, NamedTuple, TypeVar

from nicegui import ui

T = TypeVar("T")

Renew = Callable[[T], object]
"""Shows another content in a row that stays."""


class _Row(NamedTuple, Generic[T]):
    content: T
    element: ui.element
    renew: Renew[T] | None


class Rows(Generic[T]):
    """The rows within an element, each drawn by `draw` in an element of its own, with a key of its own."""

    def __init__(
        self,
        container: ui.element,
        draw: Callable[[T], Renew[T] | None],
        *,
        tag: str = "div",
        classes: str = "",
    ) -> None:
        """What `draw` returns shows another content under the same key; without it the row is replaced."""
        self._container = container
        self._draw = draw
        self._tag, self._classes = tag, classes
        self._rows: dict[Hashable, _Row[T]] = {}

    def show(self, contents: Iterable[tuple[Hashable, T]]) -> None:
        """Show these contents in this order, each under its key."""
        before, self._rows = self._rows, {}
        for key, content in contents:
            self._rows[key] = self._renewed(before.pop(key, None), content)
        for gone in before.values():
            gone.element.delete()
        there = self._container.default_slot.children
        for place, row in enumerate(self._rows.values()):
            if there[place] is not row.element:
                row.element.move(target_index=place)

    def _renewed(self, row: _Row[T] | None, content: T) -> _Row[T]:
        if row is not None and row.content == content:
            return row
        if row is not None and row.renew is not None:
            row.renew(content)
            return row._replace(content=content)
        if row is not None:
            row.element.delete()
        with self._container:
            element = ui.element(self._tag).classes(self._classes)
        with element:
            return _Row(content, element, self._draw(content))


def keyed(contents: Iterable[T], key: Callable[[T], Hashable]) -> Iterable[tuple[Hashable, T]]:
    """Contents with their keys; those of one key are told apart by their order."""
    times: dict[Hashable, int] = {}
    for content in contents:
        own = key(content)
        times[own] = times.get(own, -1) + 1
        yield (own, times[own]), content
