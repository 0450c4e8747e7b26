"""All about what is selected: what it is in words, its states, facts with their reasons, and its history."""

from __future__ import annotations

import asyncio
import contextlib
from typing import Final

from nicegui import ui

from semmap.nodes.extern.phrasing import english, pose_text, size_text
from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.panels import asking
from semmap.nodes.extern.web.panels.edit import Edit, several
from semmap.nodes.extern.web.panels.fact_list import FactList
from semmap.nodes.extern.web.panels.history import History
from semmap.nodes.extern.web.panels.rows import Rows
from semmap.nodes.extern.web.panels.states import States
from semmap.nodes.extern.web.panels.view import Touched, View
from semmap.nodes.extern.web.views.past import provenance
from semmap.schemas import errors
from semmap.schemas.commands import LastSeen
from semmap.schemas.entities import Entity
from semmap.schemas.errors import shortened

_LATER_S: Final = 0.4
_AGES_S: Final = 10.0
_LONGEST: Final = 2000
_SETTLED_S: Final = 0.5
"""So long a moment of the past is shown before what followed then is asked for: it takes seconds."""
_WORKING: Final = "Being worked out again, as of that commit ..."


def detail(page: Page) -> None:
    """Draw it where it is called."""
    _Detail(page)


class _Detail:
    def __init__(self, page: Page) -> None:
        self._page, self._view = page, View.of(page)
        self._of: tuple[str, ...] | None = None
        self._is_due = False
        self._asked_for = 0
        self._is_asking = False
        self._is_old = False
        """It has changed since what is being asked about it was asked."""
        self._body = ui.column().classes("w-full gap-2 semmap-detail")
        page.on_select(self._draw)
        page.on_moment(self._draw)
        self._view.on_touched(self._touch)
        ui.timer(_LATER_S, self._look)
        ui.timer(_AGES_S, self._see)
        self._draw()

    def _touch(self, names: Touched) -> None:
        if names is None or not names.isdisjoint(self._page.selected) or self._is_another():
            self._is_due = True

    def _is_another(self) -> bool:
        return self._of is not None and self._of != self._present()

    def _look(self) -> None:
        if self._is_due:
            self._is_due = False
            self._renew()

    async def _see(self) -> None:
        """How long ago it was placed or seen grows, without a commit that would tell."""
        names = self._present()
        if len(names) != 1 or names != self._of or not self._page.moment.is_now:
            return
        with contextlib.suppress(errors.SemmapError):  # it has just gone; it will be drawn so
            found = await self._page.live.ask(LastSeen(name=names[0]))
            if names == self._of and self._page.moment.is_now:
                self._say_seen(found.text)

    def _say_seen(self, text: str) -> None:
        self._seen.text = f"{text[:1].upper()}{text[1:]}"
        self._seen.set_visibility(bool(text))

    def _present(self) -> tuple[str, ...]:
        """What is selected and is there, at the moment that is shown."""
        return tuple(name for name in self._page.selected if name in self._page.state.entities)

    def _draw(self) -> None:
        """Everything anew: something else is selected."""
        self._body.clear()
        names = self._of = self._present()
        with self._body:
            if not names:
                self._draw_nothing()
            elif len(names) > 1:
                several(self._page, names)
            else:
                self._draw_one(names[0])

    def _draw_nothing(self) -> None:
        if self._page.selected:
            text = f"{', '.join(self._page.selected[:5])} was not there at this moment."
        else:
            text = "Select something: in the table, in the scene, or by words above."
        ui.label(text).classes("semmap-quiet q-py-md")

    def _draw_one(self, name: str) -> None:
        page = self._page
        entity = page.state.entities[name]
        with ui.column().classes("w-full gap-0"):
            self._called = ui.label().classes("semmap-heading").props('role="heading" aria-level="3"')
            self._is_a = ui.label().classes("semmap-quiet")
            self._also = ui.label().classes("semmap-quiet")
            self._figures = ui.label().classes("semmap-quiet semmap-figures")
        self._words = ui.label().classes("semmap-sentence")
        self._doubt = ui.label().classes("semmap-doubt").props('role="status"')
        with ui.column().classes("w-full gap-0") as facts:
            self._facts = FactList(page)
        facts.set_visibility(False)  # nothing is known of them yet
        self._all_facts = facts
        self._states = States(page, entity)
        with ui.expansion("History", icon="history").props("dense").classes("w-full") as past:
            self._seen = ui.label().classes("semmap-sentence")
            with ui.column().classes("w-full gap-2"):
                self._past = History(page, name)
                self._problems = ui.label().classes("semmap-doubt whitespace-pre-wrap")
        with ui.expansion("Who said so", icon="badge").props("dense").classes("w-full"):
            self._who = Rows(ui.column().classes("w-full gap-1"), _say_who, classes="w-full")
        past.value = True
        self._edit = Edit(page, entity) if page.may("update") else None
        self._asked_for += 1
        self._is_asking = False  # about another thing, or of another moment
        self._show_entity(entity)
        self._ask_again(entity)

    def _renew(self) -> None:
        """The same thing, a little later."""
        names = self._present()
        if names != self._of:
            self._draw()
        elif len(names) == 1 and self._page.moment.is_now:  # the past does not change
            entity = self._page.state.entities[names[0]]
            self._show_entity(entity)
            self._ask_again(entity)

    def _show_entity(self, entity: Entity) -> None:
        """What is known of it without asking."""
        page = self._page
        known = {c.name: c for c in page.live.classes}.get(entity.class_)
        label = english(known.labels) if known is not None else ""
        called = entity.preferred_reference or entity.name
        self._called.text = shortened(called, _LONGEST)
        is_a = entity.class_ if label in ("", entity.class_) else f"{label} ({entity.class_})"
        self._is_a.text = f"{entity.name} · {is_a}"
        self._also.text = f"also called {shortened(', '.join(entity.alternative_references), _LONGEST)}"
        self._also.set_visibility(bool(entity.alternative_references))
        size = f" · {size_text(entity)} m" if entity.size_m is not None else ""
        self._figures.text = f"{pose_text(entity.pose)}{size}"
        self._doubt.text = entity.conflict and f"Perception says otherwise: {entity.conflict}"
        self._doubt.set_visibility(bool(entity.conflict))
        self._states.show(entity)
        if self._edit is not None:
            self._edit.show(entity)
        who = {**provenance(entity), "": entity.iri}
        self._who.show((what, (what, text)) for what, text in who.items())

    def _ask_again(self, entity: Entity) -> None:
        """Ask about it, once the answers to what is being asked are shown: changes may be quicker."""
        self._is_old = True
        if not self._is_asking:
            self._is_asking = True
            self._page.later(self._ask(entity.name, self._asked_for))

    async def _ask(self, name: str, number: int) -> None:
        """What is to be asked about it, drawn when it is answered, if it is still looked at."""
        page, commit = self._page, self._page.moment.commit
        try:
            while number == self._asked_for and self._is_old and name in page.state.entities:
                self._is_old = False
                entity = page.state.entities[name]
                found = await asking.ask(page, self._view.knowing, entity)
                self._show(name, number, found, "" if commit is None else _WORKING)
                if commit is not None:
                    await self._ask_what_followed(entity, number, found, commit)
        finally:
            if number == self._asked_for:
                self._is_asking = False

    async def _ask_what_followed(self, entity: Entity, number: int, found: asking.Asked, commit: int) -> None:
        await asyncio.sleep(_SETTLED_S)
        if number != self._asked_for:
            return
        pending = ""
        try:
            found = await asking.with_what_followed(self._page, self._view.knowing, entity, found, commit)
        except errors.SemmapError as error:
            pending = f"What followed then is not known: {error.text}"
        self._show(entity.name, number, found, pending)

    def _show(self, name: str, number: int, found: asking.Asked, pending: str) -> None:
        """Draw what was answered; `pending` says why what is inferred is not among it."""
        if number != self._asked_for or self._of != (name,) or self._words.is_deleted:
            return
        self._words.text = shortened(found.told, _LONGEST)
        self._words.set_visibility(bool(found.told))
        self._facts.show(found.facts, pending)
        self._all_facts.set_visibility(True)
        self._say_seen(found.last_seen)
        self._past.show(found.commits)
        self._problems.text = "\n".join(found.problems)
        self._problems.set_visibility(bool(found.problems))


def _say_who(said: tuple[str, str]) -> None:
    what, text = said
    if what:
        ui.label(what).classes("semmap-title")
    ui.label(text).classes("semmap-quiet" if what else "semmap-quiet semmap-iri")
