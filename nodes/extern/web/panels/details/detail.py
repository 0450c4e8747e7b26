"""The details of the selected entities: description, facts, states, history and provenance."""

from __future__ import annotations

import asyncio
import contextlib
from typing import Final

from nicegui import ui

from semmap.nodes.extern.phrasing import english, pose_text, size_text
from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.panels.details import detail_requests
from semmap.nodes.extern.web.panels.details.edit import Edit, draw_several
from semmap.nodes.extern.web.panels.details.fact_list import FactList
from semmap.nodes.extern.web.panels.details.history import History
from semmap.nodes.extern.web.panels.details.robot import Robot, draw_robot, has_panel
from semmap.nodes.extern.web.panels.details.states import States
from semmap.nodes.extern.web.panels.widgets.map_view import Changed, MapView
from semmap.nodes.extern.web.panels.widgets.rows import Rows
from semmap.nodes.extern.web.views.entities.entity_history import group_provenance
from semmap.schemas import errors
from semmap.schemas.commands import LastSeen
from semmap.schemas.entities import Entity
from semmap.schemas.errors import shortened

_REDRAW_S: Final = 0.4
_LAST_SEEN_S: Final = 10.0
_LONGEST: Final = 2000
_SETTLED_S: Final = 0.5
"""Delay before the inferences at a past moment are requested, which takes seconds."""
_COMPUTING: Final = "Computing the inferences at that commit ..."


def detail(page: Page) -> None:
    """Draw the details."""
    _Detail(page)


class _Detail:
    def __init__(self, page: Page) -> None:
        self._page, self._view = page, MapView.of(page)
        self._of: tuple[str, ...] | None = None
        self._is_due = False
        self._request = 0
        self._is_requesting = False
        self._is_stale = False
        """Whether the entity has changed since the current request was sent."""
        self._robot: Robot | None = None
        self._body = ui.column().classes("w-full gap-2 semmap-detail")
        page.on_select(self._draw)
        page.on_moment(self._draw)
        self._view.on_entities_changed(self._on_changed)
        ui.timer(_REDRAW_S, self._redraw_if_due)
        ui.timer(_LAST_SEEN_S, self._update_last_seen)
        self._draw()

    def _on_changed(self, names: Changed) -> None:
        if names is None or not names.isdisjoint(self._page.selected) or self._is_other_selection():
            self._is_due = True

    def _is_other_selection(self) -> bool:
        return self._of is not None and self._of != self._present()

    def _redraw_if_due(self) -> None:
        if self._is_due:
            self._is_due = False
            self._update()

    async def _update_last_seen(self) -> None:
        """Update the age of the last observation, which grows without a commit."""
        names = self._present()
        if len(names) != 1 or names != self._of or not self._page.moment.is_now:
            return
        with contextlib.suppress(errors.SemmapError):  # it was just removed, which will be drawn
            found = await self._page.live.ask(LastSeen(name=names[0]))
            if names == self._of and self._page.moment.is_now:
                self._show_last_seen(found.text)

    def _show_last_seen(self, text: str) -> None:
        self._last_seen.text = f"{text[:1].upper()}{text[1:]}"
        self._last_seen.set_visibility(bool(text))

    def _present(self) -> tuple[str, ...]:
        """Return the selected entities that exist at the moment shown."""
        return tuple(name for name in self._page.selected if name in self._page.state.entities)

    def _draw(self) -> None:
        """Redraw everything for another selection."""
        self._close_robot()
        self._body.clear()
        names = self._of = self._present()
        with self._body:
            if not names:
                self._draw_nothing()
            elif len(names) > 1:
                draw_several(self._page, names)
            else:
                self._draw_one(names[0])

    def _draw_nothing(self) -> None:
        if self._page.selected:
            text = f"{', '.join(self._page.selected[:5])} did not exist at this moment."
        else:
            text = "No selection. Select an entity in the table, in the scene, or with the search box."
        ui.label(text).classes("semmap-quiet q-py-md")

    def _draw_one(self, name: str) -> None:
        page = self._page
        entity = page.state.entities[name]
        with ui.column().classes("w-full gap-0"):
            self._label = ui.label().classes("semmap-heading").props('role="heading" aria-level="3"')
            self._class = ui.label().classes("semmap-quiet")
            self._aliases = ui.label().classes("semmap-quiet")
            self._geometry = ui.label().classes("semmap-quiet semmap-figures")
        self._description = ui.label().classes("semmap-sentence")
        self._conflict = ui.label().classes("semmap-doubt").props('role="status"')
        self._robot_panel = ui.column().classes("w-full gap-0")
        self._draw_robot(entity)
        with ui.column().classes("w-full gap-0") as facts:
            self._facts = FactList(page)
        facts.set_visibility(False)  # until the first reply
        self._all_facts = facts
        self._states = States(page, entity)
        with ui.expansion("History", icon="history").props("dense").classes("w-full") as past:
            self._last_seen = ui.label().classes("semmap-sentence")
            with ui.column().classes("w-full gap-2"):
                self._history = History(page, name)
                self._problems = ui.label().classes("semmap-doubt whitespace-pre-wrap")
        with ui.expansion("Provenance", icon="badge").props("dense").classes("w-full"):
            self._provenance = Rows(ui.column().classes("w-full gap-1"), _draw_provenance, classes="w-full")
        past.value = True
        self._edit = Edit(page, entity) if page.is_allowed("update") else None
        self._request += 1
        self._is_requesting = False  # an open request is for another entity or moment
        self._show_entity(entity)
        self._refresh(entity)

    def _draw_robot(self, entity: Entity) -> None:
        """Draw the panel of a robot or a tracked entity; of others it is hidden."""
        self._close_robot()
        self._robot_panel.clear()
        with self._robot_panel:
            self._robot = draw_robot(self._page, entity)
        self._robot_panel.set_visibility(self._robot is not None)

    def _close_robot(self) -> None:
        if self._robot is not None:
            self._robot.close()
            self._robot = None

    def _update(self) -> None:
        """Show the changes of the selected entity."""
        names = self._present()
        if names != self._of:
            self._draw()
        elif len(names) == 1 and self._page.moment.is_now:  # the past does not change
            entity = self._page.state.entities[names[0]]
            if has_panel(self._page, entity) is (self._robot is None):
                self._draw_robot(entity)
            self._show_entity(entity)
            self._refresh(entity)

    def _show_entity(self, entity: Entity) -> None:
        """Show everything that needs no request."""
        page = self._page
        known = {c.name: c for c in page.live.classes}.get(entity.class_)
        label = english(known.labels) if known is not None else ""
        self._label.text = shortened(entity.preferred_reference or entity.name, _LONGEST)
        class_ = entity.class_ if label in ("", entity.class_) else f"{label} ({entity.class_})"
        self._class.text = f"{entity.name} · {class_}"
        self._aliases.text = f"Aliases: {shortened(', '.join(entity.alternative_references), _LONGEST)}"
        self._aliases.set_visibility(bool(entity.alternative_references))
        size = f" · {size_text(entity)} m" if entity.size_m is not None else ""
        self._geometry.text = f"{pose_text(entity.pose)}{size}"
        self._conflict.text = entity.conflict and f"Perception disagrees: {entity.conflict}"
        self._conflict.set_visibility(bool(entity.conflict))
        self._states.show(entity)
        if self._edit is not None:
            self._edit.show(entity)
        provenance = {**group_provenance(entity), "": entity.iri}
        self._provenance.show((parts, (parts, text)) for parts, text in provenance.items())

    def _refresh(self, entity: Entity) -> None:
        """Request the details again, after the current request: changes may be faster than replies."""
        self._is_stale = True
        if not self._is_requesting:
            self._is_requesting = True
            self._page.start_task(self._fetch(entity.name, self._request))

    async def _fetch(self, name: str, number: int) -> None:
        """Request the details and show them, if the entity is still selected."""
        page, commit = self._page, self._page.moment.commit
        try:
            while number == self._request and self._is_stale and name in page.state.entities:
                self._is_stale = False
                entity = page.state.entities[name]
                found = await detail_requests.fetch_details(page, self._view.knowledge, entity)
                self._show(name, number, found, "" if commit is None else _COMPUTING)
                if commit is not None:
                    await self._fetch_past_inferences(entity, number, found, commit)
        finally:
            if number == self._request:
                self._is_requesting = False

    async def _fetch_past_inferences(
        self, entity: Entity, number: int, found: detail_requests.Details, commit: int
    ) -> None:
        await asyncio.sleep(_SETTLED_S)
        if number != self._request:
            return
        pending = ""
        try:
            found = await detail_requests.add_past_inferences(
                self._page, self._view.knowledge, entity, found, commit
            )
        except errors.SemmapError as error:
            pending = f"Inferences not available: {error.text}"
        self._show(entity.name, number, found, pending)

    def _show(self, name: str, number: int, found: detail_requests.Details, pending: str) -> None:
        """Show the replies; `pending` is the reason why inferred facts are missing."""
        if number != self._request or self._of != (name,) or self._description.is_deleted:
            return
        self._description.text = shortened(found.description, _LONGEST)
        self._description.set_visibility(bool(found.description))
        self._facts.show(found.facts, pending)
        self._all_facts.set_visibility(True)
        self._show_last_seen(found.last_seen)
        self._history.show(found.commits)
        self._problems.text = "\n".join(found.problems)
        self._problems.set_visibility(bool(found.problems))


def _draw_provenance(content: tuple[str, str]) -> None:
    parts, text = content
    if parts:
        ui.label(parts).classes("semmap-title")
    ui.label(text).classes("semmap-quiet" if parts else "semmap-quiet semmap-iri")
