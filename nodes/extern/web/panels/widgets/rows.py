"""Rows with keys. A change of one row does not redraw the others, so opened parts stay open.

This also keeps clicks: a browser loses a click on a button that is redrawn before the click arrives.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable
from typing import Generic, NamedTuple, TypeVar

from nicegui import ui

T = TypeVar("T")

Update = Callable[[T], object]
"""Shows new content in an existing row."""


class _Row(NamedTuple, Generic[T]):
    content: T
    element: ui.element
    update: Update[T] | None


class Rows(Generic[T]):
    """The rows of a container. Each has a key and its own element, in which `draw` draws it."""

    def __init__(
        self,
        container: ui.element,
        draw: Callable[[T], Update[T] | None],
        *,
        tag: str = "div",
        classes: str = "",
    ) -> None:
        """`draw` returns a function that shows new content in the row, or None to have the row replaced."""
        self._container = container
        self._draw = draw
        self._tag, self._classes = tag, classes
        self._rows: dict[Hashable, _Row[T]] = {}

    def show(self, contents: Iterable[tuple[Hashable, T]]) -> None:
        """Show these contents, each with its key, in this order."""
        before, self._rows = self._rows, {}
        for key, content in contents:
            self._rows[key] = self._update(before.pop(key, None), content)
        for removed in before.values():
            removed.element.delete()
        children = self._container.default_slot.children
        for index, row in enumerate(self._rows.values()):
            if children[index] is not row.element:
                row.element.move(target_index=index)

    def _update(self, row: _Row[T] | None, content: T) -> _Row[T]:
        if row is not None and row.content == content:
            return row
        if row is not None and row.update is not None:
            row.update(content)
            return row._replace(content=content)
        if row is not None:
            row.element.delete()
        with self._container:
            element = ui.element(self._tag).classes(self._classes)
        with element:
            return _Row(content, element, self._draw(content))


def keyed(contents: Iterable[T], key: Callable[[T], Hashable]) -> Iterable[tuple[Hashable, T]]:
    """Yield contents with unique keys; contents with the same key are numbered."""
    counts: dict[Hashable, int] = {}
    for content in contents:
        shared = key(content)
        counts[shared] = counts.get(shared, -1) + 1
        yield (shared, counts[shared]), content
