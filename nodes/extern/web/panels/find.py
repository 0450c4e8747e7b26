"""The search box: it takes words, and selects what they describe, or asks back."""

from __future__ import annotations

from typing import Final

from nicegui import ui

from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.panels.view import View
from semmap.nodes.extern.web.views.answers import Answer, answer, reasons
from semmap.schemas import errors
from semmap.schemas.commands import Find
from semmap.schemas.language import Candidate

_BY: Final = "find"
_TIME_S: Final = 20.0
_ICONS: Final = {"found": "check_circle", "question": "help", "nothing": "search_off"}


def find(page: Page) -> None:
    """Draw it where it is called."""
    _Find(page)


class _Find:
    def __init__(self, page: Page) -> None:
        self._page, self._view = page, View.of(page)
        with ui.element("div").classes("w-full"):
            self._words = (
                ui.input(placeholder="the red cup on the table")
                .props('dense outlined clearable aria-label="Find by words" maxlength=1000')
                .classes("w-full semmap-find")
                .on("keydown.enter", self._look)
                .on("clear", self._close)
            )
            with self._words.add_slot("prepend"):
                ui.icon("search").props("size=sm")
            self._answers = ui.menu().props("no-parent-event no-focus fit max-height=60vh")

    async def _look(self) -> None:
        text = (self._words.value or "").strip()
        if not text:
            self._answers.close()
            return
        try:
            found = await self._page.live.ask(Find(text=text, viewpoint=self._page.viewpoint), _TIME_S)
        except errors.SemmapError as error:
            self._show(Answer("nothing", error.text, (), ()))
            return
        shown = answer(found)
        if shown.select:
            self._select(shown.select)
        self._show(shown)

    def _select(self, names: tuple[str, ...]) -> None:
        """Select them; a filter of the table that would hide them is taken away."""
        if not set(names) <= self._view.table().rows(self._view.wanted, names).keys():
            self._view.want(text="", class_="", room="", bearer="", things=None)
        self._page.select(names, by=_BY)

    def _show(self, shown: Answer) -> None:
        self._answers.clear()
        with self._answers, ui.column().classes("semmap-answer gap-1").props('role="status"'):
            with ui.row().classes("items-start gap-2 no-wrap"):
                ui.icon(_ICONS[shown.tone]).classes("semmap-quiet").style("margin-top: 2px")
                ui.label(errors.shortened(shown.text, 1000)).classes("semmap-sentence")
            if shown.tone == "nothing" and shown.choices:
                ui.label("What fits least badly").classes("semmap-title")
            with ui.list().props("dense").classes("w-full"):
                for candidate in shown.choices:
                    self._choice(candidate)
            for note in shown.notes:
                ui.label(note).classes("text-caption")
            if len(shown.select) > 1:
                ui.button("Only these in the table", on_click=lambda: self._only(shown.select)).props(
                    "flat dense"
                )
        self._answers.open()

    def _choice(self, candidate: Candidate) -> None:
        def choose() -> None:
            self._select((candidate.entity,))
            self._answers.close()

        with ui.item(on_click=choose).props("clickable"), ui.item_section():
            ui.item_label(candidate.entity)
            ui.item_label(reasons(candidate)).props("caption lines=2")

    def _close(self) -> None:
        self._answers.close()

    def _only(self, names: tuple[str, ...]) -> None:
        self._view.want(text="", class_="", room="", bearer="", things=frozenset(names))
        self._answers.close()
