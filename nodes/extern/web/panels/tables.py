"""Tables of the page: real tables with a caption, of which only what is in sight is drawn."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any

from nicegui import events, ui

Column = tuple[str, str]
"""The field of a row, and what heads it."""


def table(
    title: str,
    columns: Sequence[Column],
    *,
    key: str = "id",
    height: str = "24rem",
    select: Callable[[list[dict[str, Any]]], None] | None = None,
) -> ui.table:
    """An empty table, sorted by a click on a head; `select` is called with the rows that a person chooses."""
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
        made.on("row-click", lambda event: _choose(made, event, select), [[], ["id", key], None])
    return made


def columns_of(columns: Iterable[Column]) -> list[dict[str, Any]]:
    """Quasar's columns."""
    return [
        {"name": field, "field": field, "label": label, "align": "left", "sortable": True}
        for field, label in columns
    ]


def _choose(
    made: ui.table, event: events.GenericEventArguments, select: Callable[[list[dict[str, Any]]], None]
) -> None:
    """A click on a row chooses that row alone."""
    clicked = event.args[1].get(made.row_key)
    made.selected = [row for row in made.rows if row[made.row_key] == clicked]
    select(made.selected)


def names_of(rows: Iterable[dict[str, Any]]) -> list[str]:
    """The entities that rows are about, each once."""
    return list(dict.fromkeys(name for row in rows for name in row["names"]))
