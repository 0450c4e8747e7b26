"""Drawing again what has become stale, but only while it is in view, and not too often."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable, Iterator
from typing import Final

from nicegui import context, ui
from nicegui.slot import Slot

from semmap.nodes.extern.web.page import Page

_PAUSE_S: Final = 0.4


class Redrawing:
    """Calls `draw` when what it shows is stale and it is in view; to be made where the panel is drawn."""

    def __init__(self, page: Page, draw: Callable[[], Awaitable[None]]) -> None:
        self._page = page
        self._draw = draw
        self._is_stale = True
        self._is_busy = False
        self._is_in_view = in_view()
        page.on_turn(self._begin)
        self._begin()

    @property
    def is_shown(self) -> bool:
        """Is all that it is in visible?"""
        return self._is_in_view()

    def stale(self, *_: object) -> None:
        """What it shows is no longer so."""
        self._is_stale = True
        self._begin()

    def _begin(self, *_: object) -> None:
        if self._is_stale and self.is_shown and not self._is_busy:
            self._is_busy = True
            self._page.later(self._go())

    async def _go(self) -> None:
        try:
            while self._is_stale and self.is_shown:
                self._is_stale = False
                await self._draw()
                await asyncio.sleep(_PAUSE_S)
        finally:
            self._is_busy = False


def in_view() -> Callable[[], bool]:
    """To be called where something is drawn: what is returned tells whether all that it is in is visible."""
    within = tuple(_within())
    return lambda: all(element.visible for element in within)


def _within() -> Iterator[ui.element]:
    """What that which is being drawn is in, from the inside out."""
    slot: Slot | None = context.slot
    while slot is not None:
        yield slot.parent
        slot = slot.parent.parent_slot
