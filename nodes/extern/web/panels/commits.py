"""The table of commits around the moment shown, of all or of the selected entities."""

from __future__ import annotations

from typing import Any, Final

from nicegui import ui

from semmap.nodes.extern.cli.output.lines import format_commit_changes
from semmap.nodes.extern.phrasing import author, moment
from semmap.nodes.extern.web.page import Page
from semmap.schemas.replies import LoggedCommit

ROWS: Final = 200
"""Maximum number of rows in the table."""
_WRAPPED: Final = "white-space: normal"
_TEXT: Final = f"{_WRAPPED}; min-width: 8rem"
"""On a phone the table is scrolled sideways instead of one word being a line."""
_COLUMNS: Final[list[dict[Any, Any]]] = [
    {"name": "seq", "label": "Commit", "field": "seq", "align": "right", "sortable": True},
    {"name": "time", "label": "Time", "field": "time", "align": "left", "style": _WRAPPED},
    {"name": "by", "label": "By", "field": "by", "align": "left"},
    {"name": "why", "label": "Reason", "field": "why", "align": "left", "style": _TEXT},
    {"name": "what", "label": "Changes", "field": "what", "align": "left", "style": _TEXT},
]


def commits(page: Page) -> None:
    """Draw the table."""
    _Commits(page)


class _Commits:
    def __init__(self, page: Page) -> None:
        self._page = page
        self._end: int | None = None
        """The last commit in the table; None follows the moment shown."""
        with ui.row().classes("items-center gap-4"):
            self._only = ui.checkbox("Selected entities only", on_change=lambda: self._go_to_page(None))
            self._older = ui.button("Older", on_click=lambda: self._turn_page(-1)).props("flat dense")
            self._newer = ui.button("Newer", on_click=lambda: self._turn_page(1)).props("flat dense")
            self._count = ui.label().classes("text-caption").props('role="status"')
        self._table = ui.table(columns=_COLUMNS, rows=[], row_key="seq").classes("w-full")
        self._table.props('dense flat virtual-scroll aria-label="Commits" table-style="max-height: 60vh"')
        self._table.on("rowClick", self._on_click)
        page.on_moment(lambda: self._go_to_page(None))
        page.on_change(self._show)
        page.on_select(lambda: self._go_to_page(None) if self._only.value else None)
        page.client.on_delete(page.history.listen(self._on_history))
        self._show()

    def _on_history(self) -> None:
        with self._page.client:
            self._show()

    def _go_to_page(self, end: int | None) -> None:
        self._end = end
        self._show()

    def _turn_page(self, by: int) -> None:
        shown = self._table.rows
        if not shown:
            return
        seqs = [row["seq"] for row in shown]
        self._go_to_page(min(seqs) - 1 if by < 0 else max(seqs) + ROWS)

    def _on_click(self, event: Any) -> None:
        seq = int(event.args[1]["seq"])
        self._page.go_to(None if seq >= self._page.live.commit else seq)

    def _show(self) -> None:
        page, known = self._page, self._page.history.rows
        names = {*page.selected} if self._only.value else None
        chosen = known if names is None else of_names(known, names)
        end = self._end if self._end is not None else page.state.commit + ROWS // 4
        until = [row for row in chosen if row.seq <= end] or chosen[:ROWS]
        rows = until[-ROWS:]
        self._table.rows = [_cells(row, is_shown=row.seq == page.state.commit) for row in reversed(rows)]
        self._older.set_enabled(bool(rows) and rows[0] is not chosen[0])
        self._newer.set_enabled(bool(rows) and rows[-1] is not chosen[-1])
        of = "" if names is None else f" of {', '.join(sorted(names)) or 'the selection, which is empty'}"
        self._count.text = f"{len(chosen)} commits{of}" if len(chosen) != 1 else f"1 commit{of}"


def of_names(rows: list[LoggedCommit], names: set[str]) -> list[LoggedCommit]:
    """Return the commits that changed any of these entities."""
    return [row for row in rows if not names.isdisjoint(row.changed) or not names.isdisjoint(row.removed)]


def _cells(row: LoggedCommit, *, is_shown: bool) -> dict[str, Any]:
    return {
        "seq": row.seq,
        "time": moment(row.stamp_ns).replace("T", " "),
        "by": author(row),
        "why": row.reason,
        "what": ("▶ " if is_shown else "") + format_commit_changes(row),
    }
