"""The table of entities: to look for some of them, to sort them, and to select them."""

from __future__ import annotations

import json
from typing import Any, Final

from nicegui import ui

from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.panels.choice import Choice
from semmap.nodes.extern.web.panels.view import Touched, View
from semmap.nodes.extern.web.views.entity_rows import Cells, Changes, Wanted, changes, counted
from semmap.nodes.extern.web.views.forms import class_choices

_BY: Final = "entities"
_TICKED: Final = "ticks"
"""By the boxes, with which somebody goes on to choose more: a phone keeps the list open."""
_COLUMNS: Final = (
    {"field": "name", "headerName": "Name", "flex": 12, "sort": "asc"},
    {"field": "called", "headerName": "Called", "flex": 11, "hide": True},
    {"field": "class", "headerName": "Class", "flex": 10},
    {"field": "room", "headerName": "Room", "flex": 10},
    {"field": "on", "headerName": "On or in", "flex": 10, "hide": True},
    {"field": "x", "headerName": "x [m]", "flex": 6, "type": "rightAligned", "hide": True},
    {"field": "y", "headerName": "y [m]", "flex": 6, "type": "rightAligned", "hide": True},
    {"field": "z", "headerName": "z [m]", "flex": 6, "type": "rightAligned", "hide": True},
    {"field": "yaw", "headerName": "Yaw [°]", "flex": 7, "type": "rightAligned", "hide": True},
    {"field": "body", "headerName": "Body", "flex": 10, "hide": True},
)
"""They share the width that there is; those that are hidden are shown when there is more of it."""
_FURTHER: Final = [column["field"] for column in _COLUMNS if column.get("hide")]
_OPTIONS: Final = {
    "columnDefs": list(_COLUMNS),
    "defaultColDef": {"resizable": True, "sortable": True, "suppressMovable": True, "minWidth": 40},
    "rowData": [],
    ":getRowId": "(row) => row.data.name",
    ":getRowClass": "(row) => (window.semmapMarks ?? {})[row.data?.name]",
    "rowSelection": {"mode": "multiRow", "enableClickSelection": True, "headerCheckbox": True},
    "selectionColumnDef": {"width": 40},
    "rowHeight": 30,
    "headerHeight": 34,
    "animateRows": False,
    "suppressFieldDotNotation": True,
    "localeText": {"noRowsToShow": "No entity fits."},
    ":onGridReady": "(grid) => { const table = document.querySelector('.entity-table [role=grid]');"
    " if (table) table.setAttribute('aria-label', 'Entities'); }",
    ":onFirstDataRendered": "() => semmapBeginScene()",
}
_CHOSEN_BY_HAND: Final = (
    "(event) => { if (!/^(api|rowData|rowGroup|selectable|gridInit)/.test(event.source))"
    " emit({isTicked: !/^rowClicked/.test(event.source),"
    " names: getElement(%d).api.getSelectedNodes().map((row) => row.id)}); }"
)
_SELECT: Final = """
    const api = getElement(%d)?.api;
    if (api) {
        const wanted = new Set(%s), on = [], off = [];
        api.forEachNode((row) => {
            if (wanted.has(row.id)) { if (!row.isSelected()) on.push(row); }
            else if (row.isSelected()) off.push(row);
        });
        if (off.length) api.setNodesSelected({nodes: off, newValue: false, source: "api"});
        if (on.length) api.setNodesSelected({nodes: on, newValue: true, source: "api"});
        const first = api.getRowNode(%s);
        if (first) api.ensureNodeVisible(first);
    }
"""
_MARK: Final = "window.semmapMarks = %s; getElement(%d)?.api?.redrawRows();"
"""Rows that are otherwise than in the moment compared with; the rest is as it was drawn."""


def entities(page: Page) -> None:
    """Draw it where it is called."""
    _Entities(page)


class _Entities:
    def __init__(self, page: Page) -> None:
        self._page, self._view = page, View.of(page)
        self._shown: dict[str, Cells] = {}
        self._is_ready = False
        self._is_wide = False
        self._marked: dict[str, str] = {}
        with ui.column().classes("w-full gap-1 no-wrap").style("height: 100%; min-height: 320px"):
            self._draw_filter()
            self._grid = ui.aggrid({**_OPTIONS}, auto_size_columns=False, theme="balham")
            self._grid.classes("entity-table w-full").style("flex: 1 1 0; min-height: 240px; height: auto")
        self._grid.on("gridReady", self._begin, args=[])
        self._grid.on(
            "selectionChanged",
            lambda event: page.select(event.args["names"], by=_TICKED if event.args["isTicked"] else _BY),
            js_handler=_CHOSEN_BY_HAND % self._grid.id,
        )
        page.on_select(self._select)
        page.on_change(self._mark)
        self._view.on_touched(self._touch)
        self._view.on_wanted(self._look)
        self._view.now_and_then(self._offer, 2.0)

    def _draw_filter(self) -> None:
        view = self._view
        with ui.row().classes("w-full items-center gap-2 no-wrap"):
            self._text = (
                ui.input(placeholder="Name, reference or class")
                .props('dense outlined clearable debounce=250 aria-label="Filter entities by text"')
                .classes("grow")
                .on_value_change(lambda event: view.want(text=event.value or ""))
            )
            with self._text.add_slot("prepend"):
                ui.icon("filter_alt").props("size=xs")
        with ui.row().classes("w-full gap-2 no-wrap"):
            self._class = self._choice("Class", "class_")
            self._room = self._choice("Room", "room")
            self._bearer = self._choice("On or in", "bearer")
        with ui.row().classes("w-full items-center justify-between no-wrap").style("min-height: 28px"):
            self._count = ui.label().classes("text-caption").props('role="status"')
            ui.space()
            self._clear = (
                ui.button("Show all", on_click=self._show_all)
                .props("flat dense size=sm no-caps")
                .classes("q-px-sm")
            )
            self._more = ui.button(icon="view_column", on_click=self._turn_wide).classes("semmap-wide")
            self._more.props(
                'flat dense round size=sm color=secondary aria-label="All columns" aria-pressed=false'
            )
            self._more.tooltip("All columns, or those that most want")

    def _choice(self, label: str, field: str) -> Choice:
        def choose(event: Any) -> None:
            self._view.want(**{field: event.value or ""})

        return (
            Choice({}, label=label, with_input=True, clearable=True)
            .props("dense outlined options-dense hide-dropdown-icon")
            .classes("grow")
            .style("flex-basis: 0; min-width: 0")
            .on_value_change(choose)
        )

    def _turn_wide(self) -> None:
        """Show all columns, where there is room for them, or the few."""
        self._is_wide = not self._is_wide
        if self._page.widen is not None:
            self._page.widen(self._is_wide)
        self._more.props(f"aria-pressed={str(self._is_wide).lower()}")
        self._more.props(f"color={'primary' if self._is_wide else 'secondary'}")
        self._grid.run_grid_method("setColumnsVisible", _FURTHER, self._is_wide)

    # What is there

    def _begin(self) -> None:
        """The table is there, and empty."""
        self._is_ready, self._shown = True, {}
        self._look()
        if not self._shown and self._page.state.commit >= 0:
            ui.run_javascript("semmapBeginScene()")  # which waits for the first rows

    def _touch(self, names: Touched) -> None:
        if names is None or not self._is_ready or len(names) > len(self._shown) // 2:
            self._look()
        else:
            self._show_some(names)

    def _show_some(self, names: frozenset[str]) -> None:
        """A commit of few entities costs what they cost, however many there are."""
        found = self._view.table().rows(self._view.wanted, names)
        before = {name: row for name, row in self._shown.items() if name in names}
        self._send(changes(before, found))
        for name in names:
            self._shown.pop(name, None)
        self._shown.update(found)
        self._say()

    def _look(self) -> None:
        """All rows that are wanted now, in place of those that were."""
        self._tell_filter()
        if not self._is_ready:
            return
        found = self._view.table().rows(self._view.wanted)
        if self._shown:
            self._send(changes(self._shown, found))
        else:
            self._grid.run_grid_method("setGridOption", "rowData", list(found.values()))
        self._shown = found
        self._say()
        self._select()

    def _send(self, news: Changes) -> None:
        if news.add or news.update or news.remove:
            gone = [{"name": name} for name in news.remove]
            self._grid.run_grid_method(
                "applyTransaction", {"add": news.add, "update": news.update, "remove": gone}
            )

    def _mark(self) -> None:
        """Mark what differs from the moment that the page compares with."""
        marks = {name: f"semmap-is-{found.mark}" for name, found in self._page.differences.items()}
        if marks != self._marked:
            self._marked = marks
            ui.run_javascript(_MARK % (json.dumps(marks), self._grid.id))

    def _say(self) -> None:
        self._count.text = counted(len(self._shown), len(self._page.state.entities))
        self._clear.set_visibility(self._view.wanted != Wanted())

    # What is looked for

    def _offer(self) -> None:
        """The choices of the filters: what there is."""
        page, view = self._page, self._view
        there = {entity.class_ for entity in page.state.entities.values()}
        there |= {name for entity in page.state.entities.values() for name in entity.types}
        known = class_choices(page.live.classes)
        self._set_choices(self._class, {name: known.get(name, name) for name in sorted(there)})
        places = sorted(name for name, entity in page.state.entities.items() if entity.place)
        self._set_choices(self._room, {name: name for name in places})
        bearers = {view.whereabouts.bearer(entity) for entity in page.state.entities.values()} - {""}
        self._set_choices(self._bearer, {name: name for name in sorted(bearers)})

    @staticmethod
    def _set_choices(choice: ui.select, choices: dict[str, str]) -> None:
        if choice.value:
            choices.setdefault(choice.value, choice.value)
        if choice.options != choices:
            choice.set_options(choices)

    def _tell_filter(self) -> None:
        """Another panel may have asked for something."""
        wanted = self._view.wanted
        for choice, value in (
            (self._class, wanted.class_),
            (self._room, wanted.room),
            (self._bearer, wanted.bearer),
        ):
            if (choice.value or "") != value:
                choices = dict(choice.options)
                self._set_choices(choice, {**choices, value: choices.get(value, value)} if value else choices)
                choice.value = value or None
        if (self._text.value or "") != wanted.text:
            self._text.value = wanted.text

    def _show_all(self) -> None:
        self._view.want(text="", class_="", room="", bearer="", things=None)

    # What is selected

    def _select(self) -> None:
        """Select in the table what is selected in the tab, and bring the first of it into view."""
        if not self._is_ready or (self._page.selected_by in (_BY, _TICKED) and self._page.selected):
            return
        names = list(self._page.selected)
        first = json.dumps(names[0] if names else "")
        ui.run_javascript(_SELECT % (self._grid.id, json.dumps(names), first))
