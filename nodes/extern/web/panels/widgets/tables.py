"""Accessible tables with a caption, in which only visible rows are drawn."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any

from nicegui import events, ui

Column = tuple[str, str]
"""The field of a row, and the heading of the column."""


def table(
    title: str,
    columns: Sequence[Column],
    *,
    key: str = "id",
    height: str = "24rem",
    select: Callable[[list[dict[str, Any]]], None] | None = None,
) -> ui.table:
    """Draw an empty table that can be sorted; `select` is called with the rows that the user selects."""
    made = ui.table(
        rows=[],
        columns=columns_of(columns),
        row_key=key,
        selection="multiple" if select is not None else None,
        pagination={"rowsPerPage": 0},
        on_select=lambda event: select(event.selection) if select is not None else None,
    )
    made.props("virtual-scroll dense flat bordered hide-pagination wrap-cells").props(f'aria-label="{title}"')
    made.classes("w-full").style(f"max-height: {height}")
    if select is not None:
        made.on("row-click", lambda event: _select_row(made, event, select), [[], ["id", key], None])
    return made


def columns_of(columns: Iterable[Column]) -> list[dict[str, Any]]:
    """Return the columns as Quasar takes them."""
    return [
        {"name": field, "field": field, "label": label, "align": "left", "sortable": True}
        for field, label in columns
    ]


def _select_row(
    made: ui.table, event: events.GenericEventArguments, select: Callable[[list[dict[str, Any]]], None]
) -> None:
    """Select the clicked row only."""
    clicked = event.args[1].get(made.row_key)
    made.selected = [row for row in made.rows if row[made.row_key] == clicked]
    select(made.selected)


def names_of(rows: Iterable[dict[str, Any]]) -> list[str]:
    """Return the entities in the rows, each once."""
    return list(dict.fromkeys(name for row in rows for name in row["names"]))
