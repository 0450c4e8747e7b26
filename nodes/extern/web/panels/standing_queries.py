"""Standing queries: tables whose rows follow the map, with marks for new and removed rows."""

from __future__ import annotations

import asyncio
import contextlib
import threading
from collections.abc import Callable
from typing import Final

from nicegui import ui

from semmap.nodes.extern.sparql_client import StandingQuery
from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.panels.widgets.tables import columns_of, names_of, table
from semmap.nodes.extern.web.views.sparql_rows import StandingRows
from semmap.schemas import errors, wording
from semmap.schemas.sparql import RowsChanged

MOST: Final = 8
"""Maximum number of standing queries per tab."""
_MARKED_S: Final = 4.0
_SIGNS: Final = {"added": "+", "removed": "-", "": ""}


def standing_queries(page: Page) -> None:
    """Draw the standing queries of the tab, which are started in the SPARQL panel."""
    with ui.column().classes("w-full gap-2") as box:
        hint = ui.label("No standing queries. Enter a SELECT query above and press Watch.")
        hint.classes("text-caption")
    queries: list[_QueryTable] = []

    def on_end(one: _QueryTable) -> None:
        queries.remove(one)
        hint.visible = not queries

    async def start(query: str, inferred: bool) -> None:
        if len(queries) >= MOST:
            page.notify(f"limit of {MOST} standing queries reached; stop one first", "warning")
            return
        try:
            standing, end = await page.live.watch(query, inferred=inferred)
        except errors.SemmapError as error:
            page.notify(error.text, "negative")
            return
        with box:
            queries.append(_QueryTable(page, query, standing, end, on_end))
        hint.visible = False

    def close() -> None:
        for one in tuple(queries):
            one.subscription.close()

    page.watch_query = lambda query, inferred: page.start_task(start(query, inferred))
    page.client.on_delete(close)


class _QueryTable:
    """One standing query with its rows."""

    def __init__(
        self,
        page: Page,
        text: str,
        query: StandingQuery,
        end: Callable[[], None],
        on_end: Callable[[_QueryTable], None],
    ) -> None:
        self._page = page
        self._rows = StandingRows(query.rows)
        self._unmark: ui.timer | None = None
        with ui.card().classes("w-full").props("flat bordered") as self._card:
            with ui.row().classes("w-full items-center no-wrap gap-2"):
                ui.icon("visibility").props('aria-hidden="true"')
                ui.label(" ".join(text.split())).classes("ellipsis grow text-caption").tooltip(text)
                self._status = ui.label().classes("text-caption").props('role="status"')
                self._status.mark("standing-status")
                button = ui.button(icon="close", on_click=lambda: self._end(on_end)).props("dense flat round")
                button.props('aria-label="Stop standing query"')
            columns = [("sign", ""), *((f"c{i}", name) for i, name in enumerate(query.variables))]
            self._table = table("Rows of the standing query", columns, height="14rem", select=self._select)
            self._table.columns = columns_of(columns)
            self._table.props(""":table-row-class-fn="row => row.state ? 'row-' + row.state : ''" """)
            self._table.mark("standing-rows")
        self._draw(query.seq)
        self.subscription = QuerySubscription(query, end, self._on_change)

    def _on_change(self, change: RowsChanged | str) -> None:
        with self._card:
            if isinstance(change, str):
                self._status.text = f"ended: {change}"
                return
            self._rows.apply(change)
            self._draw(change.seq)
            if self._unmark is not None:
                self._unmark.cancel()
            self._unmark = ui.timer(_MARKED_S, self._clear_marks, once=True)

    def _clear_marks(self) -> None:
        self._rows.clear_marks()
        self._table.rows = self._table_rows()

    def _draw(self, commit: int) -> None:
        self._status.text = f"{wording.counted(len(self._rows), 'row')}, commit {commit}"
        self._table.rows = self._table_rows()

    def _table_rows(self) -> list[dict[str, object]]:
        rows = self._rows.table(self._page.live.entities)
        return [{**row, "sign": _SIGNS[row["state"]]} for row in rows]

    def _select(self, rows: list[dict[str, object]]) -> None:
        if names := names_of(rows):
            self._page.select(names, "standing")

    def _end(self, on_end: Callable[[_QueryTable], None]) -> None:
        self.subscription.close()
        self._card.delete()
        on_end(self)


class QuerySubscription:
    """The subscription to a standing query, until it is closed."""

    def __init__(
        self, query: StandingQuery, end: Callable[[], None], listener: Callable[[RowsChanged | str], None]
    ) -> None:
        """`listener` is called on the event loop with each change, or with the error that ended the query.

        `end` ends the query.
        """
        self._query = query
        self._end = end
        self._listener = listener
        self._loop = asyncio.get_running_loop()
        self._is_closed = False
        threading.Thread(target=self._wait, name="standing query", daemon=True).start()

    def close(self) -> None:
        """End the query without waiting for the system."""
        if not self._is_closed:
            self._is_closed = True
            threading.Thread(target=self._end, name="standing query ends", daemon=True).start()

    def _wait(self) -> None:
        try:
            for change in self._query.changes():
                self._post(change)
        except errors.SemmapError as error:
            self._post(error.text)

    def _post(self, change: RowsChanged | str) -> None:
        with contextlib.suppress(RuntimeError):  # the loop has ended
            self._loop.call_soon_threadsafe(self._deliver, change)

    def _deliver(self, change: RowsChanged | str) -> None:
        if not self._is_closed:
            self._listener(change)
