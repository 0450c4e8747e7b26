"""The log of commits and of errors of the nodes."""

from __future__ import annotations

from typing import Any, Final, get_args

from nicegui import ui

from semmap.nodes.extern.web.live import LiveEvent
from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.panels.widgets.redraw import LazyRedraw
from semmap.nodes.extern.web.panels.widgets.tables import names_of, table
from semmap.nodes.extern.web.views.log_lines import WARNING, Log, rows_of
from semmap.schemas import errors
from semmap.schemas.commands import History
from semmap.schemas.entities import Source
from semmap.schemas.replies import LoggedCommit

_FIRST: Final = 300
_PER_REQUEST: Final = 1000
_COLUMNS: Final = (("time", "time"), ("commit", "commit"), ("by", "by"), ("text", "message"))


def log(page: Page) -> None:
    """Draw the log, the newest lines first, with a filter."""
    _Log(page)


class _Log:
    def __init__(self, page: Page) -> None:
        self._page = page
        self._log = Log()
        self._chosen: int | None = None
        with ui.column().classes("w-full gap-2"):
            with ui.row().classes("w-full items-center gap-2"):
                self._search = ui.input("Filter log", on_change=self._filter).props(
                    "dense outlined clearable"
                )
                self._search.classes("grow").mark("log-filter")
                self._kinds = ui.select([*get_args(Source), WARNING], multiple=True, label="Source", value=[])
                self._kinds.props("dense outlined use-chips").style("min-width: 10rem")
                self._kinds.on_value_change(self._filter)
                self._go_button = ui.button("Go to commit", icon="history", on_click=self._go)
                self._go_button.props("dense no-caps flat").set_enabled(False)
            self._table = table("Log", _COLUMNS, select=self._select).mark("log-rows")
        self._redraw = LazyRedraw(page, self._fetch)
        page.client.on_delete(page.live.listen(self._on_event))

    def _on_event(self, event: LiveEvent) -> None:
        if event.kind == "reset" and event.is_new_map:
            self._log.clear()
        if event.kind == "health":
            before = len(self._log.lines)
            for node in event.names:
                self._log.add_health(self._page.live.health[node])
            if len(self._log.lines) != before:
                self._redraw.mark_stale()
        elif event.kind in ("commit", "reset"):
            self._redraw.mark_stale()

    async def _fetch(self) -> None:
        """Request the commits since the last one in the log."""
        last = self._log.last
        if self._page.live.commit > last:
            query = History(since=last + 1, limit=_PER_REQUEST) if last else History(limit=_FIRST)
            try:
                commits: tuple[LoggedCommit, ...] = await self._page.live.ask(query)
                self._log.add_commits(commits)
            except errors.SemmapError as error:
                self._page.notify(error.text, "negative")
        self._filter()

    def _filter(self) -> None:
        self._table.rows = rows_of(self._log.lines, self._search.value or "", self._kinds.value or ())

    def _select(self, rows: list[dict[str, Any]]) -> None:
        commits = [int(row["commit"]) for row in rows if row["commit"]]
        self._chosen = commits[0] if len(commits) == 1 else None
        self._go_button.set_enabled(self._chosen is not None)
        names = [name for name in names_of(rows) if name in self._page.state.entities]
        if names:
            self._page.select(names, "log")

    def _go(self) -> None:
        if self._chosen is not None:
            self._page.go_to(self._chosen)
