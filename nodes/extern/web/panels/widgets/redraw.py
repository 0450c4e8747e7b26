"""Redrawing of panels when they are stale and visible, with a minimum interval."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable, Iterator
from typing import Final

from nicegui import context, ui
from nicegui.slot import Slot

from semmap.nodes.extern.web.page import Page

_PAUSE_S: Final = 0.4


class LazyRedraw:
    """Calls `draw` when the panel is stale and visible. It is created where the panel is drawn."""

    def __init__(self, page: Page, draw: Callable[[], Awaitable[None]], *, pause_s: float = _PAUSE_S) -> None:
        self._page = page
        self._draw = draw
        self._pause_s = pause_s
        self._is_stale = True
        self._is_busy = False
        self._is_visible = visibility_check()
        page.on_tab_change(self._start)
        self._start()

    @property
    def is_shown(self) -> bool:
        """Whether the panel is visible."""
        return self._is_visible()

    def mark_stale(self, *_: object) -> None:
        """Redraw the panel as soon as it is visible."""
        self._is_stale = True
        self._start()

    def _start(self, *_: object) -> None:
        if self._is_stale and self.is_shown and not self._is_busy:
            self._is_busy = True
            self._page.start_task(self._run())

    async def _run(self) -> None:
        try:
            while self._is_stale and self.is_shown:
                self._is_stale = False
                await self._draw()
                await asyncio.sleep(self._pause_s)
        finally:
            self._is_busy = False


def visibility_check() -> Callable[[], bool]:
    """Return a function that returns whether all enclosing elements are visible.

    To be called while drawing.
    """
    enclosing = tuple(_enclosing())
    return lambda: all(element.visible for element in enclosing)


def _enclosing() -> Iterator[ui.element]:
    """Yield the elements that enclose the current slot, from the inside out."""
    slot: Slot | None = context.slot
    while slot is not None:
        yield slot.parent
        slot = slot.parent.parent_slot
