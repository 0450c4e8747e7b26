"""The knowledge graph: the neighbourhood of the selection, or the whole map by place or by class."""

from __future__ import annotations

import asyncio
from typing import Any, Final

from nicegui import events, ui

from semmap.nodes.drawing.neighbourhood import Neighbourhood, around, by_class, by_place
from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.panels.widgets.redraw import LazyRedraw
from semmap.nodes.extern.web.panels.widgets.tables import names_of, table
from semmap.nodes.extern.web.views.graph_chart import (
    FEW_LINKS,
    FEW_ON_PHONES,
    QUERY,
    Relations,
    chart_options,
    relations_of,
    rows_of,
)
from semmap.nodes.extern.web.views.graph_layout import Positions, arrange
from semmap.schemas import errors
from semmap.schemas.commands import Sparql
from semmap.schemas.sparql import Row

_MODES: Final = {"selected": "Selection", "places": "By place", "classes": "By class"}
_COLUMNS: Final = (("source", "subject"), ("label", "relation"), ("target", "object"))
_LIMIT: Final = 100_000
_TIMEOUT_S: Final = 20.0
_CLICK_S: Final = 0.25
"""Maximum interval between the clicks of a double click."""


def graph(page: Page) -> None:
    """Draw the graph at the moment shown; a click selects, a double click expands."""
    _Graph(page)


class _Graph:
    def __init__(self, page: Page) -> None:
        self._page = page
        self._expanded: dict[str, None] = {}
        self._at: Positions = {}
        self._graph = Neighbourhood()
        self._related: tuple[tuple[str, int, int], Relations] | None = None
        self._clicked: asyncio.Task[Any] | None = None
        with ui.column().classes("w-full gap-2"):
            with ui.row().classes("w-full items-center gap-2"):
                self._mode = ui.toggle(_MODES, value="selected", on_change=self._reset)
                self._mode.props("no-caps dense").mark("graph-mode")
                expand = ui.button("Expand", icon="unfold_more", on_click=self._expand_selected)
                expand.props("dense no-caps flat").tooltip("Show the neighbours of the selected entities")
                ui.button("Collapse", icon="unfold_less", on_click=self._reset).props("dense no-caps flat")
                self._hint = ui.label().classes("text-caption grow").props('role="status"')
                self._hint.mark("graph-hint")
            self._chart = ui.echart(chart_options(self._graph, {}, ()), on_point_click=self._click)
            self._chart.on("chart:dblclick", self._double_click, ["data"])
            self._chart.props('role="img" aria-label="Knowledge graph; the table below has the same content"')
            self._chart.classes("w-full semmap-framed").style(
                "height: calc(100vh - 330px); min-height: 20rem"
            )
            with ui.expansion("Table", icon="table_rows").classes("w-full").props("dense"):
                self._table = table("Relations in the graph", _COLUMNS, select=self._select_rows)
                self._table.mark("graph-rows")
        self._redraw = LazyRedraw(page, self._draw)
        page.on_change(self._redraw.mark_stale)
        page.on_select(self._on_select)

    # Drawing

    def _reset(self) -> None:
        self._expanded.clear()
        self._at = {}
        self._redraw.mark_stale()

    def _on_select(self) -> None:
        """Show the neighbourhood of the selection, unless it was selected in this graph."""
        if self._page.selected_by != "graph" and self._page.selected:
            self._mode.value = "selected"
        self._redraw.mark_stale()

    async def _draw(self) -> None:
        relations = await self._relations()
        entities = dict(self._page.state.entities)
        mode, expanded, before = str(self._mode.value), tuple(self._expanded), self._at
        selected = [name for name in self._page.selected if name in entities]

        def drawn() -> tuple[Neighbourhood, Positions]:
            if mode == "classes":
                found = by_class(entities, expanded)
            elif mode == "places" or not selected:
                found = by_place(entities, relations)
            else:
                found = around(selected, entities, relations, unfolded=expanded)
            return found, arrange(found, before)

        self._graph, self._at = await asyncio.to_thread(drawn)
        few_links = FEW_ON_PHONES if self._page.narrow else FEW_LINKS
        self._chart.options.clear()
        self._chart.options.update(chart_options(self._graph, self._at, selected, few_links=few_links))
        self._chart.update()
        self._table.rows = rows_of(self._graph, entities)
        self._hint.text = self._hint_text(mode, selected)

    def _hint_text(self, mode: str, selected: list[str]) -> str:
        if not self._graph.knots:
            return "The map is empty."
        if mode == "selected" and not selected:
            return "No selection: the graph shows all places. Click to select, double-click to expand."
        return "Click to select, double-click to expand."

    async def _relations(self) -> Relations:
        """Return the relations at the moment shown; they are requested once per commit."""
        state, live = self._page.state, self._page.live
        key = (live.map_id, live.loads, state.commit)
        if self._related is not None and self._related[0] == key:
            return self._related[1]
        rows: tuple[Row, ...] = ()
        try:
            as_of = None if self._page.moment.is_now else state.commit
            query = Sparql(query=QUERY, inferred=True, as_of=as_of, timeout=_TIMEOUT_S, limit=_LIMIT)
            rows = (await live.ask(query, 2.0 * _TIMEOUT_S)).rows
        except errors.SemmapError as error:
            self._page.notify(f"the graph has no computed relations: {error.text}", "warning")
        found = await asyncio.to_thread(relations_of, dict(state.entities), rows)
        self._related = (key, found)
        return found

    # User actions

    def _click(self, event: events.EChartPointClickEventArguments) -> None:
        name = str((event.data or {}).get("id", "")) if isinstance(event.data, dict) else ""
        if self._clicked is not None:
            self._clicked.cancel()
        if name:
            self._clicked = self._page.start_task(self._select_soon(name))

    async def _select_soon(self, name: str) -> None:
        """Select a node, unless a second click makes it a double click."""
        await asyncio.sleep(_CLICK_S)
        if name in self._page.state.entities:
            self._page.select((name,), "graph")
            if self._mode.value == "selected":
                self._redraw.mark_stale()
        elif name.startswith(("class:", "more:")):
            self._expand(name)

    def _double_click(self, event: events.GenericEventArguments) -> None:
        if self._clicked is not None:
            self._clicked.cancel()
        data = event.args.get("data") if isinstance(event.args, dict) else None
        if isinstance(data, dict) and data.get("id"):
            self._expand(str(data["id"]))

    def _expand(self, node: str) -> None:
        """Show the members or neighbours of a node."""
        kind, _, rest = node.partition(":")
        if kind == "class":
            self._mode.value = "classes"
            self._expanded[rest] = None
        elif kind == "more":
            self._expanded[rest.rpartition(":")[0] or rest] = None
        elif self._mode.value == "selected" and self._page.selected:
            self._expanded[node] = None
        else:
            self._mode.value = "selected"
            self._page.select((node,), "graph")
        self._redraw.mark_stale()

    def _expand_selected(self) -> None:
        for knot in self._graph.knots:
            if knot.kind == "centre":
                self._expanded.update(
                    (link.target if link.source == knot.id else link.source, None)
                    for link in self._graph.links
                    if knot.id in (link.source, link.target)
                )
        self._expanded = {n: None for n in self._expanded if n in self._page.state.entities}
        self._redraw.mark_stale()

    def _select_rows(self, rows: list[dict[str, Any]]) -> None:
        if names := names_of(rows):
            self._page.select(names, "graph")
