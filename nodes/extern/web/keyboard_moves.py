"""Moving the selection by the arrow keys: presses in quick succession are one change."""

from __future__ import annotations

import asyncio
import math
from functools import partial
from typing import Final

from msgspec import structs

from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.views.entities.forms import build_move
from semmap.nodes.extern.web.views.key_steps import KEYS, step_of
from semmap.schemas.entities import Entity

_QUIET_S: Final = 0.3
"""The change is sent when no key was pressed for this time."""
_POSE_DELAY_S: Final = 0.2
"""Time after which the bodies have followed the map."""
_NORTH_RAD: Final = math.pi / 2.0
"""Without a scene, up is +y as on the plan."""


class KeyboardMoves:
    """The steps of one tab that are not sent yet."""

    def __init__(self, page: Page) -> None:
        """Handle the arrow keys of a tab; the browser sends them while something is selected."""
        self._page = page
        self._names: tuple[str, ...] = ()
        self._offset_m = (0.0, 0.0)
        self._presses = 0
        for key in KEYS:
            page.on_key(key, partial(self._press, key))
        page.on_select(self._forget)

    def _press(self, key: str) -> None:
        page = self._page
        if not page.selected or not page.is_allowed("batch"):
            return
        viewpoint = page.viewpoint
        x, y = step_of(key, _NORTH_RAD if viewpoint is None else viewpoint[3])
        self._offset_m = self._offset_m[0] + x, self._offset_m[1] + y
        is_first = not self._names
        self._names = page.selected
        self._presses += 1
        self._preview()
        if is_first:
            page.start_task(self._send())

    def _forget(self) -> None:
        """Drop the steps for another selection."""
        self._names, self._offset_m = (), (0.0, 0.0)
        self._preview()

    def _entities(self) -> list[Entity]:
        known = self._page.live.entities
        return [known[name] for name in self._names if name in known]

    def _preview(self) -> None:
        """Show the entities at their new poses before the change is sent."""
        if self._page.preview is not None:
            x, y = self._offset_m
            self._page.preview(
                {
                    entity.name: structs.replace(entity.pose, position_m=(px + x, py + y, pz))
                    for entity in self._entities()
                    if entity.pose is not None
                    for px, py, pz in (entity.pose.position_m,)
                }
            )

    async def _send(self) -> None:
        names = self._names
        presses = -1
        while presses != self._presses:
            presses = self._presses
            await asyncio.sleep(_QUIET_S)
        if names != self._names:
            return  # another selection was made
        entities, offset_m = self._entities(), tuple(round(metres, 3) for metres in self._offset_m)
        self._names, self._offset_m = (), (0.0, 0.0)
        if any(offset_m) and any(entity.pose is not None for entity in entities):
            reply = await self._page.change(build_move(entities, (*offset_m, 0.0)))
            if reply is not None:
                self._page.notify(reply.text, "positive")
                await asyncio.sleep(_POSE_DELAY_S)
        if not self._names:
            self._preview()
