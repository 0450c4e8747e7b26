"""SPARQL: an editor with examples, and the results as a table whose rows select."""

from __future__ import annotations

import time
from typing import Final

from nicegui import ui

from semmap.nodes.extern.cli.output.sparql_formats import text
from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.panels.widgets.tables import columns_of, names_of, table
from semmap.nodes.extern.web.views.example_queries import FIRST, Example, example_queries
from semmap.nodes.extern.web.views.sparql_rows import format_summary, rows_of
from semmap.schemas import errors
from semmap.schemas.commands import Sparql
from semmap.schemas.sparql import SparqlResult

_TIMEOUT_S: Final = 5.0
_ROWS: Final = 10_000


def sparql(page: Page) -> None:
    """Draw the editor, the examples and the results."""
    _Sparql(page)


class _Sparql:
    def __init__(self, page: Page) -> None:
        self._page = page
        self._examples: dict[str, Example] = {}
        self._result: SparqlResult | None = None
        with ui.column().classes("w-full gap-2"):
            with ui.row().classes("w-full items-center gap-2"):
                self._choice = ui.select([], label="Examples", on_change=self._take_example)
                self._choice.props("dense outlined options-dense").classes("grow").style("min-width: 14rem")
                self._choice.mark("sparql-examples")
                self._inferred = ui.switch("Include inferred").props("dense")
                self._inferred.tooltip("Include inferred and computed facts")
            with ui.element("div").classes("w-full").props('role="group" aria-label="SPARQL query"'):
                self._editor = ui.codemirror(
                    FIRST,
                    language="SPARQL",
                    theme="vscodeDark" if page.dark else "vscodeLight",
                    line_wrapping=True,
                    keymap={"Mod-Enter": self._run},
                )
                self._editor.classes("w-full semmap-framed sparql-editor").style("height: 11rem")
            with ui.row().classes("w-full items-center gap-2"):
                self._button = ui.button("Run", icon="play_arrow", on_click=self._run).props("dense no-caps")
                self._button.classes("px-3").tooltip("Ctrl+Enter").mark("sparql-run")
                ui.button("Watch", icon="visibility", on_click=self._watch).props(
                    "dense no-caps flat"
                ).tooltip("Run as a standing query, whose rows follow the map")
                self._limit = ui.number("Time limit [s]", value=_TIMEOUT_S, min=0.1, max=60.0)
                self._limit.props("dense outlined").style("width: 8rem")
                self._save = ui.button("CSV", icon="download", on_click=self._download)
                self._save.props("dense no-caps flat").tooltip("Save the results as a file")
                self._status = ui.label().classes("text-caption grow").props('role="status"')
                self._status.mark("sparql-status")
            self._error = ui.label().classes("text-negative whitespace-pre-wrap").props('role="alert"')
            self._error.mark("sparql-error")
            self._notes = ui.label().classes("text-caption whitespace-pre-wrap")
            self._table = table("Results", [], select=self._select).mark("sparql-rows")
        self._table.visible = False
        self._save.set_enabled(False)
        self._update_examples()
        page.on_change(self._update_examples)

    def _update_examples(self) -> None:
        """Offer the examples for the map at the moment shown."""
        classes = {info.name: info for info in self._page.live.classes}
        found = {e.title: e for e in example_queries(self._page.state.entities, classes)}
        if found != self._examples:
            self._examples = found
            self._choice.set_options(list(found))

    def _take_example(self) -> None:
        chosen = self._examples.get(self._choice.value or "")
        if chosen is not None:
            self._editor.value = chosen.query
            self._inferred.value = chosen.inferred

    async def _run(self) -> None:
        limit = min(max(float(self._limit.value or _TIMEOUT_S), 0.1), 60.0)
        began_s = time.perf_counter()
        self._error.text, self._notes.text, self._status.text = "", "", "detail_requests ..."
        self._button.set_enabled(False)
        try:
            query = Sparql(
                query=self._editor.value or " ",
                inferred=bool(self._inferred.value),
                as_of=None if self._page.moment.is_now else self._page.state.commit,
                timeout=limit,
                limit=_ROWS,
            )
            result = await self._page.live.ask(query, limit + 30.0)
        except errors.SemmapError as error:
            self._error.text, self._status.text = _with_hint(error.text), ""
            return
        finally:
            self._button.set_enabled(True)
        self._show(result, time.perf_counter() - began_s)

    def _show(self, result: SparqlResult, elapsed_s: float) -> None:
        found = rows_of(result, self._page.state.entities)
        self._result = result
        self._save.set_enabled(result.kind == "select")
        self._status.text = format_summary(result, elapsed_s)
        self._notes.text = "\n".join(result.notes)
        self._table.columns = columns_of((f"c{i}", name) for i, name in enumerate(found.columns))
        self._table.visible = True
        self._table.rows, self._table.selected = found.rows, []

    def _select(self, rows: list[dict[str, object]]) -> None:
        names = names_of(rows)
        if names:
            self._page.select(names, "sparql")

    def _watch(self) -> None:
        if self._page.watch_query is not None and self._editor.value:
            self._page.watch_query(self._editor.value, bool(self._inferred.value))

    def _download(self) -> None:
        if self._result is not None:
            ui.download.content(text(self._result, "csv"), "rows.csv", "text/csv")


def _with_hint(message: str) -> str:
    """Add the panels of the page to messages about commands."""
    if "read-only" in message:
        return f"{message} (on this page: the panels Add and Details)"
    return message
