"""Standing queries: tables whose rows stay up to date; what has just come or gone is marked."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from nicegui import ui

from semmap.nodes.extern.sparql_client import StandingQuery
from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.panels.tables import columns_of, names_of, table
from semmap.nodes.extern.web.standing import Following
from semmap.nodes.extern.web.views.sparql_rows import Standing
from semmap.schemas import errors, wording
from semmap.schemas.sparql import RowsChanged

MOST: Final = 8
"""Standing queries of one tab."""
_MARKED_S: Final = 4.0
_SIGNS: Final = {"came": "+", "gone": "-", "": ""}


def standing(page: Page) -> None:
    """The queries that are watched in this tab; others are begun from the SPARQL panel."""
    with ui.column().classes("w-full gap-2") as box:
        hint = ui.label("Nothing is watched yet: write a SELECT query above, and press Watch.")
        hint.classes("text-caption")
    watched: list[_Watched] = []

    def ended(one: _Watched) -> None:
        watched.remove(one)
        hint.visible = not watched

    async def begin(query: str, inferred: bool) -> None:
        if len(watched) >= MOST:
            page.tell(f"{MOST} queries are watched already; end one first", "warning")
            return
        try:
            asked, end = await page.live.watch(query, inferred=inferred)
        except errors.SemmapError as error:
            page.tell(error.text, "negative")
            return
        with box:
            watched.append(_Watched(page, query, asked, end, ended))
        hint.visible = False

    def close() -> None:
        for one in tuple(watched):
            one.following.close()

    page.watch = lambda query, inferred: page.later(begin(query, inferred))
    page.client.on_delete(close)


class _Watched:
    """One query with its rows."""

    def __init__(
        self,
        page: Page,
        query: str,
        asked: StandingQuery,
        end: Callable[[], None],
        ended: Callable[[_Watched], None],
    ) -> None:
        self._page = page
        self._rows = Standing(asked.rows)
        self._unmark: ui.timer | None = None
        with ui.card().classes("w-full").props("flat bordered") as self._card:
            with ui.row().classes("w-full items-center no-wrap gap-2"):
                ui.icon("visibility").props('aria-hidden="true"')
                ui.label(" ".join(query.split())).classes("ellipsis grow text-caption").tooltip(query)
                self._said = ui.label().classes("text-caption").props('role="status"')
                self._said.mark("standing-said")
                button = ui.button(icon="close", on_click=lambda: self._end(ended)).props("dense flat round")
                button.props('aria-label="Stop watching"')
            columns = [("sign", ""), *((f"c{i}", name) for i, name in enumerate(asked.variables))]
            self._table = table("Rows that are watched", columns, height="14rem", select=self._select)
            self._table.columns = columns_of(columns)
            self._table.props(""":table-row-class-fn="row => row.state ? 'row-' + row.state : ''" """)
            self._table.mark("standing-rows")
        self._draw(asked.seq)
        self.following = Following(asked, end, self._take)

    def _take(self, news: RowsChanged | str) -> None:
        with self._card:
            if isinstance(news, str):
                self._said.text = f"ended: {news}"
                return
            self._rows.take(news)
            self._draw(news.seq)
            if self._unmark is not None:
                self._unmark.cancel()
            self._unmark = ui.timer(_MARKED_S, self._settle, once=True)

    def _settle(self) -> None:
        self._rows.settle()
        self._table.rows = self._drawn()

    def _draw(self, commit: int) -> None:
        self._said.text = f"{wording.counted(len(self._rows), 'row')}, commit {commit}"
        self._table.rows = self._drawn()

    def _drawn(self) -> list[dict[str, object]]:
        rows = self._rows.table(self._page.live.entities)
        return [{**row, "sign": _SIGNS[row["state"]]} for row in rows]

    def _select(self, rows: list[dict[str, object]]) -> None:
        if names := names_of(rows):
            self._page.select(names, "standing")

    def _end(self, ended: Callable[[_Watched], None]) -> None:
        self.following.close()
        self._card.delete()
        ended(self)
