"""Drawing again what has become stale, but only while it is looked at, and not too often."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from typing import Final

from nicegui import context, ui

from nodes.extern.web.page import Page

_PAUSE_S: Final = 0.4


class Redrawing:
    """Calls `draw` when what it shows is stale and its tab is open; to be made where the panel is drawn."""

    def __init__(self, page: Page, draw: Callable[[], Awaitable[None]]) -> None:
        self._page = page
        self._draw = draw
        self._is_stale = True
        self._is_busy = False
        self._panels = _panels()
        for _, panels in self._panels:
            panels.on_value_change(self._begin)
        page.client.on_connect(self._begin)
        self._begin()

    @property
    def is_shown(self) -> bool:
        """Is every tab open that it is in?"""
        return all(panels.value == panel.props["name"] for panel, panels in self._panels)

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


def _panels() -> list[tuple[ui.tab_panel, ui.tab_panels]]:
    """The tabs that what is being drawn is in, from the inside out."""
    found: list[tuple[ui.tab_panel, ui.tab_panels]] = []
    slot = context.slot
    panel: ui.tab_panel | None = None
    while True:
        element = slot.parent
        if isinstance(element, ui.tab_panel):
            panel = element
        elif isinstance(element, ui.tab_panels) and panel is not None:
            found.append((panel, element))
            panel = None
        if element.parent_slot is None:
            return found
        slot = element.parent_slot
