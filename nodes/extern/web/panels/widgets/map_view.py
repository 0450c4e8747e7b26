"""State that the panels of a tab share: the filter, and the locations at the moment shown."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable
from typing import Any, Final

from msgspec import structs
from nicegui import ui

from semmap.nodes.extern.web.knowledge_cache import KnowledgeCache
from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.views.entities.entity_rows import EntityFilter, Table
from semmap.nodes.extern.web.views.entities.locations import Locations
from semmap.schemas import errors

log = logging.getLogger(__name__)

_SETTLED_S: Final = 0.3
"""Delay before the locations of a past moment are requested, which takes seconds."""
_VIEWS: dict[str, MapView] = {}
"""The views by tab, while it is open."""
Changed = frozenset[str] | None
"""The names of changed entities; None if all may have changed."""


class MapView:
    """The shared state of a tab; `MapView.of(page)` returns it."""

    def __init__(self, page: Page) -> None:
        self.page = page
        self.filter = EntityFilter()
        """The filter of the entity table."""
        self.knowledge = KnowledgeCache.of(page.live)
        self._past: Locations | None = None
        self._on_filter: list[Callable[[], None]] = []
        self._on_entities_changed: list[Callable[[Changed], None]] = []
        page.client.on_delete(self.knowledge.listen(self._on_known))
        page.on_moment(self._on_moment)
        page.on_change(self._on_past)

    @classmethod
    def of(cls, page: Page) -> MapView:
        """Return the state of this tab."""
        if (view := _VIEWS.get(page.id)) is None:
            view = _VIEWS[page.id] = cls(page)
            page.client.on_delete(lambda: _VIEWS.pop(page.id, None))
        return view

    @property
    def locations(self) -> Locations:
        """The locations at the moment shown."""
        return self.knowledge.locations if self._past is None else self._past

    def table(self) -> Table:
        """Return the rows at the moment shown."""
        page = self.page
        scene = page.live.scene if page.moment.is_now else None
        bodies = None if scene is None else {body.name: body for body in scene.bodies}
        return Table(page.state.entities, self.locations, bodies=bodies)

    def set_filter(self, **conditions: Any) -> None:
        """Set some conditions of the filter."""
        new = structs.replace(self.filter, **conditions)
        if new != self.filter:
            self.filter = new
            self._call(self._on_filter)

    def on_filter(self, function: Callable[[], None]) -> None:
        """Call a function when the filter has changed."""
        self._on_filter.append(function)

    def on_entities_changed(self, function: Callable[[Changed], None]) -> None:
        """Call a function with the names of entities that changed, or whose location did."""
        self._on_entities_changed.append(function)

    def redraw_periodically(self, draw: Callable[[], None], period_s: float = 0.5) -> None:
        """Draw now and after changes, at most once per period; for slow drawings."""
        is_due = False

        def on_changed(_: Changed) -> None:
            nonlocal is_due
            is_due = True

        def draw_if_due() -> None:
            nonlocal is_due
            if is_due:
                is_due = False
                draw()

        self.on_entities_changed(on_changed)
        ui.timer(period_s, draw_if_due)
        draw()

    def _on_known(self, names: Changed) -> None:
        if self.page.moment.is_now:
            self._call(self._on_entities_changed, names)

    def _on_moment(self) -> None:
        self._past = None
        if self.page.moment.is_now:
            self._call(self._on_entities_changed, None)

    def _on_past(self) -> None:
        """Request the locations when a past moment is shown."""
        commit = self.page.moment.commit
        if commit is not None:
            self._past = Locations()
            self._call(self._on_entities_changed, None)
            self.page.start_task(self._fetch_past(commit))

    async def _fetch_past(self, commit: int) -> None:
        await asyncio.sleep(_SETTLED_S)
        if self.page.moment.commit != commit:
            return
        try:
            past = await self.knowledge.locations_at(commit)
        except errors.SemmapError as error:
            log.info("cannot read the locations after commit %d: %s", commit, error.text)
            return
        if self.page.moment.commit == commit:
            self._past = past
            self._call(self._on_entities_changed, None)

    def _call(self, functions: list[Callable[..., None]], *arguments: Any) -> None:
        with self.page.client:
            for function in tuple(functions):
                function(*arguments)
