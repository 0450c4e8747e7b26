"""The log: what has happened, a line a commit in words, and what the nodes warn of."""

from __future__ import annotations

from typing import Any, Final, get_args

from nicegui import ui

from semmap.nodes.extern.web.live import Happening
from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.panels.redrawing import Redrawing
from semmap.nodes.extern.web.panels.tables import names_of, table
from semmap.nodes.extern.web.views.happened import WARNING, Log, rows_of
from semmap.schemas import errors
from semmap.schemas.commands import History
from semmap.schemas.entities import Source
from semmap.schemas.replies import LoggedCommit

_FIRST: Final = 300
_AT_ONCE: Final = 1000
_COLUMNS: Final = (("time", "time"), ("commit", "commit"), ("by", "by"), ("text", "what"))


def log(page: Page) -> None:
    """The newest lines first, with a filter."""
    _Log(page)


class _Log:
    def __init__(self, page: Page) -> None:
        self._page = page
        self._log = Log()
        self._chosen: int | None = None
        with ui.column().classes("w-full gap-2"):
            with ui.row().classes("w-full items-center gap-2"):
                self._wanted = ui.input("Filter the log", on_change=self._filter).props(
                    "dense outlined clearable"
                )
                self._wanted.classes("grow").mark("log-filter")
                self._kinds = ui.select([*get_args(Source), WARNING], multiple=True, label="By", value=[])
                self._kinds.props("dense outlined use-chips").style("min-width: 10rem")
                self._kinds.on_value_change(self._filter)
                self._then = ui.button("Show the map then", icon="history", on_click=self._go)
                self._then.props("dense no-caps flat").set_enabled(False)
            self._table = table("Log", _COLUMNS, select=self._select).mark("log-rows")
        self._redrawing = Redrawing(page, self._fetch)
        page.client.on_delete(page.live.listen(self._hear))

    def _hear(self, happening: Happening) -> None:
        if happening.kind == "begun" and happening.anew:
            self._log.clear()
        if happening.kind == "health":
            before = len(self._log.lines)
            for node in happening.names:
                self._log.hear(self._page.live.health[node])
            if len(self._log.lines) != before:
                self._redrawing.stale()
        elif happening.kind in ("commit", "begun"):
            self._redrawing.stale()

    async def _fetch(self) -> None:
        """Ask for what has been committed since the last time."""
        last = self._log.last
        if self._page.live.commit > last:
            query = History(since=last + 1, limit=_AT_ONCE) if last else History(limit=_FIRST)
            try:
                commits: tuple[LoggedCommit, ...] = await self._page.live.ask(query)
                self._log.take(commits)
            except errors.SemmapError as error:
                self._page.tell(error.text, "negative")
        self._filter()

    def _filter(self) -> None:
        self._table.rows = rows_of(self._log.lines, self._wanted.value or "", self._kinds.value or ())

    def _select(self, rows: list[dict[str, Any]]) -> None:
        commits = [int(row["commit"]) for row in rows if row["commit"]]
        self._chosen = commits[0] if len(commits) == 1 else None
        self._then.set_enabled(self._chosen is not None)
        names = [name for name in names_of(rows) if name in self._page.state.entities]
        if names:
            self._page.select(names, "log")

    def _go(self) -> None:
        if self._chosen is not None:
            self._page.go_to(self._chosen)
