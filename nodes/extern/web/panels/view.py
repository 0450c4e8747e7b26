"""What a tab's panels of knowledge share: the moment with its whereabouts, and what is looked for."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable
from typing import Any, Final

from msgspec import structs
from nicegui import ui

from semmap.nodes.extern.web.knowing import Knowing
from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.views.entity_rows import Table, Wanted
from semmap.nodes.extern.web.views.whereabouts import Whereabouts
from semmap.schemas import errors

log = logging.getLogger(__name__)

_SETTLED_S: Final = 0.3
"""So long a moment of the past is shown before it is asked where everything was then: it takes seconds."""
_VIEWS: dict[str, View] = {}
"""By tab, as long as it is open."""
Touched = frozenset[str] | None
"""The names of the entities that are otherwise; None for possibly all."""


class View:
    """One for each tab: use `View.of(page)`."""

    def __init__(self, page: Page) -> None:
        self.page = page
        self.wanted = Wanted()
        """Which entities the table shows."""
        self.knowing = Knowing.of(page.live)
        self._past: Whereabouts | None = None
        self._on_wanted: list[Callable[[], None]] = []
        self._on_touched: list[Callable[[Touched], None]] = []
        page.client.on_delete(self.knowing.listen(self._on_known))
        page.on_moment(self._on_moment)
        page.on_change(self._on_past)

    @classmethod
    def of(cls, page: Page) -> View:
        """That of this tab."""
        if (view := _VIEWS.get(page.id)) is None:
            view = _VIEWS[page.id] = cls(page)
            page.client.on_delete(lambda: _VIEWS.pop(page.id, None))
        return view

    @property
    def whereabouts(self) -> Whereabouts:
        """Of the moment that is shown."""
        return self.knowing.whereabouts if self._past is None else self._past

    def table(self) -> Table:
        """The rows of the moment that is shown."""
        page = self.page
        scene = page.live.scene if page.moment.is_now else None
        bodies = None if scene is None else {body.name: body for body in scene.bodies}
        return Table(page.state.entities, self.whereabouts, bodies=bodies)

    def want(self, **wanted: Any) -> None:
        """Look for something else; what is not named stays."""
        new = structs.replace(self.wanted, **wanted)
        if new != self.wanted:
            self.wanted = new
            self._tell(self._on_wanted)

    def on_wanted(self, function: Callable[[], None]) -> None:
        """Call it when something else is looked for."""
        self._on_wanted.append(function)

    def on_touched(self, function: Callable[[Touched], None]) -> None:
        """Call it with the names of entities that are, or are somewhere, otherwise than before."""
        self._on_touched.append(function)

    def now_and_then(self, draw: Callable[[], None], period_s: float = 0.5) -> None:
        """Draw at once, and after changes, but no more often than this: for what takes long to draw."""
        is_due = False

        def touch(_: Touched) -> None:
            nonlocal is_due
            is_due = True

        def look() -> None:
            nonlocal is_due
            if is_due:
                is_due = False
                draw()

        self.on_touched(touch)
        ui.timer(period_s, look)
        draw()

    def _on_known(self, names: Touched) -> None:
        if self.page.moment.is_now:
            self._tell(self._on_touched, names)

    def _on_moment(self) -> None:
        self._past = None
        if self.page.moment.is_now:
            self._tell(self._on_touched, None)

    def _on_past(self) -> None:
        """The state of the past is there; where everything was then is asked for."""
        commit = self.page.moment.commit
        if commit is not None:
            self._past = Whereabouts()
            self._tell(self._on_touched, None)
            self.page.later(self._fetch_past(commit))

    async def _fetch_past(self, commit: int) -> None:
        await asyncio.sleep(_SETTLED_S)
        if self.page.moment.commit != commit:
            return
        try:
            past = await self.knowing.at(commit)
        except errors.SemmapError as error:
            log.info("where things were after commit %d is not known: %s", commit, error.text)
            return
        if self.page.moment.commit == commit:
            self._past = past
            self._tell(self._on_touched, None)

    def _tell(self, functions: list[Callable[..., None]], *arguments: Any) -> None:
        with self.page.client:
            for function in tuple(functions):
                function(*arguments)
