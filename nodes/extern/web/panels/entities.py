"""The table of entities, with filters, sorting and selection."""

from __future__ import annotations

import json
from typing import Any, Final

from nicegui import ui

from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.panels.widgets.map_view import Changed, MapView
from semmap.nodes.extern.web.panels.widgets.select_field import SelectField
from semmap.nodes.extern.web.views.entities.entity_rows import (
    Cells,
    EntityFilter,
    RowChanges,
    diff_rows,
    format_count,
)
from semmap.nodes.extern.web.views.entities.forms import class_choices

_BY: Final = "entities"
_TICKED: Final = "ticks"
"""Selection with the check boxes; on a phone the list then stays open for more."""
_COLUMNS: Final = (
    {"field": "name", "headerName": "Name", "flex": 12, "sort": "asc"},
    {"field": "label", "headerName": "Label", "flex": 11, "hide": True},
    {"field": "class", "headerName": "Class", "flex": 10},
    {"field": "room", "headerName": "Room", "flex": 10},
    {"field": "on", "headerName": "On / in", "flex": 10, "hide": True},
    {"field": "x", "headerName": "x [m]", "flex": 6, "type": "rightAligned", "hide": True},
    {"field": "y", "headerName": "y [m]", "flex": 6, "type": "rightAligned", "hide": True},
    {"field": "z", "headerName": "z [m]", "flex": 6, "type": "rightAligned", "hide": True},
    {"field": "yaw", "headerName": "Yaw [°]", "flex": 7, "type": "rightAligned", "hide": True},
    {"field": "body", "headerName": "Body", "flex": 10, "hide": True},
)
"""The columns share the available width; hidden ones are shown in the wide table."""
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
    "localeText": {"noRowsToShow": "No matching entities"},
    ":onGridReady": "(grid) => { const table = document.querySelector('.entity-table [role=grid]');"
    " if (table) table.setAttribute('aria-label', 'Entities'); }",
    ":onFirstDataRendered": "() => semmapBeginScene()",
}
_SELECTED_BY_USER: Final = (
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
"""Marks the rows of entities that differ from the moment compared with."""


def entities(page: Page) -> None:
    """Draw the table."""
    _Entities(page)


class _Entities:
    def __init__(self, page: Page) -> None:
        self._page, self._view = page, MapView.of(page)
        self._shown: dict[str, Cells] = {}
        self._is_ready = False
        self._is_wide = False
        self._marked: dict[str, str] = {}
        with ui.column().classes("w-full gap-1 no-wrap").style("height: 100%; min-height: 320px"):
            self._draw_filter()
            self._grid = ui.aggrid({**_OPTIONS}, auto_size_columns=False, theme="balham")
            self._grid.classes("entity-table w-full").style("flex: 1 1 0; min-height: 240px; height: auto")
        self._grid.on("gridReady", self._on_ready, args=[])
        self._grid.on(
            "selectionChanged",
            lambda event: page.select(event.args["names"], by=_TICKED if event.args["isTicked"] else _BY),
            js_handler=_SELECTED_BY_USER % self._grid.id,
        )
        page.on_select(self._select)
        page.on_change(self._mark)
        self._view.on_entities_changed(self._on_changed)
        self._view.on_filter(self._show_all_rows)
        self._view.redraw_periodically(self._update_options, 2.0)

    def _draw_filter(self) -> None:
        view = self._view
        with ui.row().classes("w-full items-center gap-2 no-wrap"):
            self._text = (
                ui.input(placeholder="Name, label or class")
                .props('dense outlined clearable debounce=250 aria-label="Filter entities by text"')
                .classes("grow")
                .on_value_change(lambda event: view.set_filter(text=event.value or ""))
            )
            with self._text.add_slot("prepend"):
                ui.icon("filter_alt").props("size=xs")
        with ui.row().classes("w-full gap-2 no-wrap"):
            self._class = self._choice("Class", "class_")
            self._room = self._choice("Room", "room")
            self._support = self._choice("On / in", "support")
        with ui.row().classes("w-full items-center justify-between no-wrap").style("min-height: 28px"):
            self._count = ui.label().classes("text-caption").props('role="status"')
            ui.space()
            self._clear = (
                ui.button("Clear filter", on_click=self._clear_filter)
                .props("flat dense size=sm no-caps")
                .classes("q-px-sm")
            )
            self._more = ui.button(icon="view_column", on_click=self._toggle_columns).classes("semmap-wide")
            self._more.props(
                'flat dense round size=sm color=secondary aria-label="All columns" aria-pressed=false'
            )
            self._more.tooltip("Show all or the main columns")

    def _choice(self, label: str, field: str) -> SelectField:
        def on_change(event: Any) -> None:
            self._view.set_filter(**{field: event.value or ""})

        return (
            SelectField({}, label=label, with_input=True, clearable=True)
            .props("dense outlined options-dense hide-dropdown-icon")
            .classes("grow")
            .style("flex-basis: 0; min-width: 0")
            .on_value_change(on_change)
        )

    def _toggle_columns(self) -> None:
        """Show all columns in a wide drawer, or the main ones."""
        self._is_wide = not self._is_wide
        if self._page.set_wide_lists is not None:
            self._page.set_wide_lists(self._is_wide)
        self._more.props(f"aria-pressed={str(self._is_wide).lower()}")
        self._more.props(f"color={'primary' if self._is_wide else 'secondary'}")
        self._grid.run_grid_method("setColumnsVisible", _FURTHER, self._is_wide)

    # Rows

    def _on_ready(self) -> None:
        """Fill the empty table of the browser."""
        self._is_ready, self._shown = True, {}
        self._show_all_rows()
        if not self._shown and self._page.state.commit >= 0:
            ui.run_javascript("semmapBeginScene()")  # which waits for the first rows

    def _on_changed(self, names: Changed) -> None:
        if names is None or not self._is_ready or len(names) > len(self._shown) // 2:
            self._show_all_rows()
        else:
            self._update_rows(names)

    def _update_rows(self, names: frozenset[str]) -> None:
        """Update the rows of some entities, at a cost that does not depend on the size of the map."""
        found = self._view.table().rows(self._view.filter, names)
        before = {name: row for name, row in self._shown.items() if name in names}
        self._send(diff_rows(before, found))
        for name in names:
            self._shown.pop(name, None)
        self._shown.update(found)
        self._show_count()

    def _show_all_rows(self) -> None:
        """Show the rows that match the filter."""
        self._show_filter()
        if not self._is_ready:
            return
        found = self._view.table().rows(self._view.filter)
        if self._shown:
            self._send(diff_rows(self._shown, found))
        else:
            self._grid.run_grid_method("setGridOption", "rowData", list(found.values()))
        self._shown = found
        self._show_count()
        self._select()

    def _send(self, changes: RowChanges) -> None:
        if changes.add or changes.update or changes.remove:
            removed = [{"name": name} for name in changes.remove]
            self._grid.run_grid_method(
                "applyTransaction", {"add": changes.add, "update": changes.update, "remove": removed}
            )

    def _mark(self) -> None:
        """Mark the entities that differ from the moment compared with."""
        marks = {name: f"semmap-is-{found.mark}" for name, found in self._page.differences.items()}
        if marks != self._marked:
            self._marked = marks
            ui.run_javascript(_MARK % (json.dumps(marks), self._grid.id))

    def _show_count(self) -> None:
        self._count.text = format_count(len(self._shown), len(self._page.state.entities))
        self._clear.set_visibility(self._view.filter != EntityFilter())

    # Filters

    def _update_options(self) -> None:
        """Offer the classes, places and supports of the map in the filters."""
        page, view = self._page, self._view
        used = {entity.class_ for entity in page.state.entities.values()}
        used |= {name for entity in page.state.entities.values() for name in entity.types}
        known = class_choices(page.live.classes)
        self._set_choices(self._class, {name: known.get(name, name) for name in sorted(used)})
        places = sorted(name for name, entity in page.state.entities.items() if entity.place)
        self._set_choices(self._room, {name: name for name in places})
        supports = {view.locations.find_support(entity) for entity in page.state.entities.values()} - {""}
        self._set_choices(self._support, {name: name for name in sorted(supports)})

    @staticmethod
    def _set_choices(choice: ui.select, choices: dict[str, str]) -> None:
        if choice.value:
            choices.setdefault(choice.value, choice.value)
        if choice.options != choices:
            choice.set_options(choices)

    def _show_filter(self) -> None:
        """Show the filter in the fields; other panels change it, too."""
        wanted = self._view.filter
        for choice, value in (
            (self._class, wanted.class_),
            (self._room, wanted.room),
            (self._support, wanted.support),
        ):
            if (choice.value or "") != value:
                choices = dict(choice.options)
                self._set_choices(choice, {**choices, value: choices.get(value, value)} if value else choices)
                choice.value = value or None
        if (self._text.value or "") != wanted.text:
            self._text.value = wanted.text

    def _clear_filter(self) -> None:
        self._view.set_filter(text="", class_="", room="", support="", things=None)

    # Selection

    def _select(self) -> None:
        """Select the selected entities in the table, and scroll to the first one."""
        if not self._is_ready or (self._page.selected_by in (_BY, _TICKED) and self._page.selected):
            return
        names = list(self._page.selected)
        first = json.dumps(names[0] if names else "")
        ui.run_javascript(_SELECT % (self._grid.id, json.dumps(names), first))
