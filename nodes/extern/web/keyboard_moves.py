"""Moving the selection by the arrow keys: presses in quick succession are one change."""

from __future__ import annotations

import asyncio
import math
from functools import partial
from typing import Final

from semmap.nodes.extern.web.live import LiveEvent
from semmap.nodes.extern.web.live_subscriber import PERIOD_S
from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.views.key_steps import KEYS, step_of
from semmap.nodes.extern.web.views.pending_moves import PendingMoves
from semmap.schemas import errors

_QUIET_S: Final = 0.3
"""A change is sent when no key was pressed for this time."""
_POSE_DELAY_S: Final = 0.2
"""Time after which the bodies have followed the map."""
_NORTH_RAD: Final = math.pi / 2.0
"""Without a scene, up is +y as on the plan."""


class KeyboardMoves:
    """The steps of one tab. One task at a time sends them, change by change, until none is left."""

    def __init__(self, page: Page) -> None:
        """Handle the arrow keys of a tab; the browser sends them while something is selected."""
        self._page = page
        self._moves = PendingMoves()
        self._is_sending = False
        self._sending = asyncio.Lock()
        """Held from when a change is sent until the map has it."""
        page.discard_pending = self.discard_last
        for key in KEYS:
            page.on_key(key, partial(self._press, key))
        page.on_select(self._moves.close)
        page.client.on_delete(page.live.listen(self._on_event))

    async def discard_last(self) -> bool:
        """Discard the last change if it was not sent, and return whether there was one.

        Without one, wait until the map has the change that is being sent.
        """
        if self._moves.discard_last():
            self._preview()
            return True
        async with self._sending:
            return False

    def _press(self, key: str) -> None:
        page = self._page
        if not page.selected or not page.is_allowed("batch"):
            return
        viewpoint = page.viewpoint
        self._moves.add(page.selected, step_of(key, _NORTH_RAD if viewpoint is None else viewpoint[3]))
        self._preview()
        if not self._is_sending:
            self._is_sending = True
            page.start_task(self._send())

    def _on_event(self, event: LiveEvent) -> None:
        if event.is_new_map:
            self._moves.clear()
            self._preview()

    def _preview(self) -> None:
        """Show the entities at their new poses before the map has them."""
        if self._page.preview is not None:
            self._page.preview(self._moves.poses_after(self._page.live.entities))

    async def _send(self) -> None:
        try:
            while not self._moves.is_empty:
                await self._wait_until_quiet()
                async with self._sending:
                    await self._send_first()
        finally:
            self._is_sending = False
        self._preview()

    async def _wait_until_quiet(self) -> None:
        presses = -1
        while self._moves.is_first_open and presses != self._moves.presses:
            presses = self._moves.presses
            await asyncio.sleep(_QUIET_S)

    async def _send_first(self) -> None:
        """Send the first move, and wait until the map has it: the next one begins at the new poses."""
        page, map_id = self._page, self._page.live.map_id
        if self._moves.is_empty:  # another map is served, or the steps were discarded
            return
        try:
            change = self._moves.take(page.live.entities)
        except errors.BadRequest as error:
            page.notify(error.text, "warning")
            return
        if change is None:
            return
        reply = await page.change(change)
        if reply is not None:
            page.notify(reply.text, "positive")
            while page.live.map_id == map_id and page.live.commit < (reply.commit or 0):
                await asyncio.sleep(PERIOD_S)
        self._moves.finish()
        if reply is None:
            self._preview()  # without the rejected change
        else:
            await asyncio.sleep(_POSE_DELAY_S)
