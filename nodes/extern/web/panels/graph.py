"""The knowledge graph: what is next to the selected things, or all of it by places or by classes."""

from __future__ import annotations

import asyncio
from typing import Any, Final

from nicegui import events, ui

from semmap.nodes.drawing.neighbourhood import Neighbourhood, around, by_class, by_place
from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.panels.redrawing import Redrawing
from semmap.nodes.extern.web.panels.tables import names_of, table
from semmap.nodes.extern.web.views.graph_drawing import (
    FEW_LINKS,
    FEW_ON_PHONES,
    QUERY,
    Relations,
    options,
    relations_of,
    rows_of,
)
from semmap.nodes.extern.web.views.graph_layout import Positions, arranged
from semmap.schemas import errors
from semmap.schemas.commands import Sparql
from semmap.schemas.sparql import Row

_WAYS: Final = {"selected": "Selected", "places": "By place", "classes": "By class"}
_COLUMNS: Final = (("source", "what"), ("label", "is related by"), ("target", "to"))
_LIMIT: Final = 100_000
_TIMEOUT_S: Final = 20.0
_CLICK_S: Final = 0.25
"""A second click within this time makes one that unfolds."""


def graph(page: Page) -> None:
    """Drawn from the moment shown; a click selects, a double click unfolds."""
    _Graph(page)


class _Graph:
    def __init__(self, page: Page) -> None:
        self._page = page
        self._unfolded: dict[str, None] = {}
        self._at: Positions = {}
        self._graph = Neighbourhood()
        self._related: tuple[tuple[str, int], Relations] | None = None
        self._clicked: asyncio.Task[Any] | None = None
        with ui.column().classes("w-full gap-2"):
            with ui.row().classes("w-full items-center gap-2"):
                self._way = ui.toggle(_WAYS, value="selected", on_change=self._begin_anew)
                self._way.props("no-caps dense").mark("graph-way")
                unfold = ui.button("Unfold", icon="unfold_more", on_click=self._unfold_selected)
                unfold.props("dense no-caps flat").tooltip("Show what is next to the selected, too")
                ui.button("Fold", icon="unfold_less", on_click=self._begin_anew).props("dense no-caps flat")
                self._said = ui.label().classes("text-caption grow").props('role="status"')
                self._said.mark("graph-said")
            self._chart = ui.echart(options(self._graph, {}, ()), on_point_click=self._click)
            self._chart.on("chart:dblclick", self._double_click, ["data"])
            self._chart.props('role="img" aria-label="Knowledge graph; the table below says the same"')
            self._chart.classes("w-full semmap-framed").style(
                "height: calc(100vh - 330px); min-height: 20rem"
            )
            with ui.expansion("As a table", icon="table_rows").classes("w-full").props("dense"):
                self._table = table("Relations that are drawn", _COLUMNS, select=self._select_rows)
                self._table.mark("graph-rows")
        self._redrawing = Redrawing(page, self._draw)
        page.on_change(self._redrawing.stale)
        page.on_select(self._on_select)

    # What is drawn

    def _begin_anew(self) -> None:
        self._unfolded.clear()
        self._at = {}
        self._redrawing.stale()

    def _on_select(self) -> None:
        """Another thing is in the middle, unless it was chosen in what is drawn by places or classes."""
        if self._page.selected_by != "graph" and self._page.selected:
            self._way.value = "selected"
        self._redrawing.stale()

    async def _draw(self) -> None:
        relations = await self._relations()
        entities = dict(self._page.state.entities)
        way, unfolded, before = str(self._way.value), tuple(self._unfolded), self._at
        selected = [name for name in self._page.selected if name in entities]

        def drawn() -> tuple[Neighbourhood, Positions]:
            if way == "classes":
                found = by_class(entities, unfolded)
            elif way == "places" or not selected:
                found = by_place(entities, relations)
            else:
                found = around(selected, entities, relations, unfolded=unfolded)
            return found, arranged(found, before)

        self._graph, self._at = await asyncio.to_thread(drawn)
        few_links = FEW_ON_PHONES if self._page.narrow else FEW_LINKS
        self._chart.options.clear()
        self._chart.options.update(options(self._graph, self._at, selected, few_links=few_links))
        self._chart.update()
        self._table.rows = rows_of(self._graph, entities)
        self._said.text = self._sentence(way, selected)

    def _sentence(self, way: str, selected: list[str]) -> str:
        if not self._graph.knots:
            return "The map is empty."
        if way == "selected" and not selected:
            return "Nothing is selected: this is all, by places. A click selects, a double click unfolds."
        return "A click selects, a double click unfolds."

    async def _relations(self) -> Relations:
        """Those of the moment shown; asked for once a commit."""
        state, live = self._page.state, self._page.live
        of = (live.map_id, state.commit)
        if self._related is not None and self._related[0] == of:
            return self._related[1]
        rows: tuple[Row, ...] = ()
        try:
            as_of = None if self._page.moment.is_now else state.commit
            query = Sparql(query=QUERY, inferred=True, as_of=as_of, timeout=_TIMEOUT_S, limit=_LIMIT)
            rows = (await live.ask(query, 2.0 * _TIMEOUT_S)).rows
        except errors.SemmapError as error:
            self._page.tell(f"The graph lacks what is measured: {error.text}", "warning")
        found = await asyncio.to_thread(relations_of, dict(state.entities), rows)
        self._related = (of, found)
        return found

    # What people do

    def _click(self, event: events.EChartPointClickEventArguments) -> None:
        name = str((event.data or {}).get("id", "")) if isinstance(event.data, dict) else ""
        if self._clicked is not None:
            self._clicked.cancel()
        if name:
            self._clicked = self._page.later(self._select_soon(name))

    async def _select_soon(self, name: str) -> None:
        """Unless it is the first half of a double click."""
        await asyncio.sleep(_CLICK_S)
        if name in self._page.state.entities:
            self._page.select((name,), "graph")
            if self._way.value == "selected":
                self._redrawing.stale()
        elif name.startswith(("class:", "more:")):
            self._unfold(name)

    def _double_click(self, event: events.GenericEventArguments) -> None:
        if self._clicked is not None:
            self._clicked.cancel()
        data = event.args.get("data") if isinstance(event.args, dict) else None
        if isinstance(data, dict) and data.get("id"):
            self._unfold(str(data["id"]))

    def _unfold(self, node: str) -> None:
        """Show more of what a node stands for or is next to."""
        kind, _, rest = node.partition(":")
        if kind == "class":
            self._way.value = "classes"
            self._unfolded[rest] = None
        elif kind == "more":
            self._unfolded[rest.rpartition(":")[0] or rest] = None
        elif self._way.value == "selected" and self._page.selected:
            self._unfolded[node] = None
        else:
            self._way.value = "selected"
            self._page.select((node,), "graph")
        self._redrawing.stale()

    def _unfold_selected(self) -> None:
        for knot in self._graph.knots:
            if knot.kind == "centre":
                self._unfolded.update(
                    (link.target if link.source == knot.id else link.source, None)
                    for link in self._graph.links
                    if knot.id in (link.source, link.target)
                )
        self._unfolded = {n: None for n in self._unfolded if n in self._page.state.entities}
        self._redrawing.stale()

    def _select_rows(self, rows: list[dict[str, Any]]) -> None:
        if names := names_of(rows):
            self._page.select(names, "graph")
