"""The search box, which selects the entities that match a description."""

from __future__ import annotations

from typing import Final

from nicegui import ui

from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.panels.widgets.map_view import MapView
from semmap.nodes.extern.web.views.find_results import FindResult, format_reasons, summarize
from semmap.schemas import errors
from semmap.schemas.commands import Find
from semmap.schemas.language import Candidate

_BY: Final = "find"
_TIMEOUT_S: Final = 20.0
_ICONS: Final = {"found": "check_circle", "question": "help", "nothing": "search_off"}


def find(page: Page) -> None:
    """Draw the search box."""
    _Find(page)


class _Find:
    def __init__(self, page: Page) -> None:
        self._page, self._view = page, MapView.of(page)
        with ui.element("div").classes("w-full"):
            self._words = (
                ui.input(placeholder="the red cup on the table")
                .props('dense outlined clearable aria-label="Find by words" maxlength=1000')
                .classes("w-full semmap-find")
                .on("keydown.enter", self._find)
                .on("clear", self._close)
            )
            with self._words.add_slot("prepend"):
                ui.icon("search").props("size=sm")
            self._results = ui.menu().props("no-parent-event no-focus fit max-height=60vh")

    async def _find(self) -> None:
        text = (self._words.value or "").strip()
        if not text:
            self._results.close()
            return
        try:
            found = await self._page.live.ask(Find(text=text, viewpoint=self._page.viewpoint), _TIMEOUT_S)
        except errors.SemmapError as error:
            self._show(FindResult("nothing", error.text, (), ()))
            return
        shown = summarize(found)
        if shown.select:
            self._select(shown.select)
        self._show(shown)

    def _select(self, names: tuple[str, ...]) -> None:
        """Select entities, and clear a filter of the table that would hide them."""
        if not set(names) <= self._view.table().rows(self._view.filter, names).keys():
            self._view.set_filter(text="", class_="", room="", support="", things=None)
        self._page.select(names, by=_BY)

    def _show(self, shown: FindResult) -> None:
        self._results.clear()
        with self._results, ui.column().classes("semmap-answer gap-1").props('role="status"'):
            with ui.row().classes("items-start gap-2 no-wrap"):
                ui.icon(_ICONS[shown.tone]).classes("semmap-quiet").style("margin-top: 2px")
                ui.label(errors.shortened(shown.text, 1000)).classes("semmap-sentence")
            if shown.tone == "nothing" and shown.choices:
                ui.label("Closest matches").classes("semmap-title")
            with ui.list().props("dense").classes("w-full"):
                for candidate in shown.choices:
                    self._draw_candidate(candidate)
            for note in shown.notes:
                ui.label(note).classes("text-caption")
            if len(shown.select) > 1:
                ui.button("Filter table", on_click=lambda: self._filter_table(shown.select)).props(
                    "flat dense"
                )
        self._results.open()

    def _draw_candidate(self, candidate: Candidate) -> None:
        def select() -> None:
            self._select((candidate.entity,))
            self._results.close()

        with ui.item(on_click=select).props("clickable"), ui.item_section():
            ui.item_label(candidate.entity)
            ui.item_label(format_reasons(candidate)).props("caption lines=2")

    def _close(self) -> None:
        self._results.close()

    def _filter_table(self, names: tuple[str, ...]) -> None:
        self._view.set_filter(text="", class_="", room="", support="", things=frozenset(names))
        self._results.close()
