"""All about what is selected: what it is in words, its states, facts with their reasons, and its history."""

from __future__ import annotations

import asyncio
import contextlib
from typing import Final

from nicegui import ui

from nodes.extern.phrasing import english, pose_text, size_text
from nodes.extern.web.page import Page
from nodes.extern.web.panels import asking
from nodes.extern.web.panels.edit import Edit, several
from nodes.extern.web.panels.fact_list import fact_list
from nodes.extern.web.panels.history import history
from nodes.extern.web.panels.states import States
from nodes.extern.web.panels.view import Touched, View
from nodes.extern.web.views.past import provenance
from schemas import errors
from schemas.commands import LastSeen
from schemas.entities import Entity
from schemas.errors import shortened

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
        self._head = ui.column().classes("w-full gap-0")
        self._words = ui.label().classes("semmap-sentence")
        self._doubt = ui.label().classes("semmap-doubt").props('role="status"')
        self._facts = ui.column().classes("w-full gap-0")
        self._states = States(page, entity)
        with ui.expansion("History", icon="history").props("dense").classes("w-full") as past:
            self._seen = ui.label().classes("semmap-sentence")
            self._past = ui.column().classes("w-full gap-2")
        with ui.expansion("Who said so", icon="badge").props("dense").classes("w-full"):
            self._who = ui.column().classes("w-full gap-1")
        past.value = True
        self._edit = Edit(page, entity) if page.may("update") else None
        self._drawn: tuple[asking.Asked, str] | None = None
        self._show_entity(entity)
        page.later(self._ask(entity))

    def _renew(self) -> None:
        """The same thing, a little later."""
        names = self._present()
        if names != self._of:
            self._draw()
        elif len(names) == 1 and self._page.moment.is_now:  # the past does not change
            entity = self._page.state.entities[names[0]]
            self._show_entity(entity)
            self._page.later(self._ask(entity))

    def _show_entity(self, entity: Entity) -> None:
        """What is known of it without asking."""
        page = self._page
        known = {c.name: c for c in page.live.classes}.get(entity.class_)
        label = english(known.labels) if known is not None else ""
        called = entity.preferred_reference or entity.name
        self._head.clear()
        with self._head:
            ui.label(shortened(called, _LONGEST)).classes("semmap-heading").props(
                'role="heading" aria-level="3"'
            )
            is_a = entity.class_ if label in ("", entity.class_) else f"{label} ({entity.class_})"
            ui.label(f"{entity.name} · {is_a}").classes("semmap-quiet")
            if entity.alternative_references:
                also = ", ".join(entity.alternative_references)
                ui.label(f"also called {shortened(also, _LONGEST)}").classes("semmap-quiet")
            size = f" · {size_text(entity)} m" if entity.size_m is not None else ""
            ui.label(f"{pose_text(entity.pose)}{size}").classes("semmap-quiet semmap-figures")
        self._doubt.text = entity.conflict and f"Perception says otherwise: {entity.conflict}"
        self._doubt.set_visibility(bool(entity.conflict))
        self._states.show(entity)
        if self._edit is not None:
            self._edit.show(entity)
        self._who.clear()
        with self._who:
            for what, text in provenance(entity).items():
                ui.label(what).classes("semmap-title")
                ui.label(text).classes("semmap-quiet")
            ui.label(entity.iri).classes("semmap-quiet semmap-iri")

    async def _ask(self, entity: Entity) -> None:
        """What is to be asked about it, drawn when it is answered, if it is still looked at."""
        self._asked_for += 1
        number, commit = self._asked_for, self._page.moment.commit
        found = await asking.ask(self._page, self._view.knowing, entity)
        self._show(entity.name, number, found, "" if commit is None else _WORKING)
        if commit is None:
            return
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
        if number != self._asked_for or self._of != (name,) or self._facts.is_deleted:
            return
        before, self._drawn = self._drawn, (found, pending)
        self._words.text = shortened(found.told, _LONGEST)
        self._words.set_visibility(bool(found.told))
        if before is None or (before[0].facts, before[1]) != (found.facts, pending):
            self._facts.clear()
            with self._facts:
                fact_list(self._page, found.facts, pending)
        self._say_seen(found.last_seen)
        past = (found.commits, found.problems)
        if before is None or (before[0].commits, before[0].problems) != past:
            self._past.clear()
            with self._past:
                history(self._page, name, found.commits)
                for problem in found.problems:
                    ui.label(problem).classes("semmap-doubt")
