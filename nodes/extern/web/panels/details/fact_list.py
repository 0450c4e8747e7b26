"""The facts about one entity in three groups, each with a button for its explanation."""

from __future__ import annotations

from typing import Final

from nicegui import ui

from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.panels.details.proof import draw_proof
from semmap.nodes.extern.web.panels.widgets.map_view import MapView
from semmap.nodes.extern.web.panels.widgets.rows import Rows, Update, keyed
from semmap.nodes.extern.web.views.entities.facts import ExplainArgs, Fact, Facts
from semmap.schemas import errors
from semmap.schemas.commands import Explain, Unset

_MOST: Final = 40
_TIMEOUT_S: Final = 15.0
_LONGEST: Final = 1000
_MOST_INFERRED: Final = 15
_MOST_COMPUTED: Final = 10
"""Longer groups are closed at first."""
_NO_PROOFS: Final = "Explanations are available for the current map only."


class FactList:
    """The facts of one entity at one moment. Opened parts stay open when the facts change."""

    def __init__(self, page: Page) -> None:
        """Draw an empty list."""
        self._asserted = _Group(page, "Asserted", _MOST)
        with ui.column().classes("w-full gap-0") as self._pending:
            ui.label("Inferred").classes("semmap-title q-pt-sm q-px-md")
            self._why_pending = ui.label().classes("semmap-sentence q-px-md").props('role="status"')
        self._inferred = _Group(page, "Inferred", _MOST_INFERRED)
        self._computed = _Group(page, "Computed", _MOST_COMPUTED)
        self._past = ui.label(_NO_PROOFS).classes("semmap-quiet q-px-md")
        self._past.set_visibility(not page.moment.is_now)

    def show(self, facts: Facts, pending: str = "") -> None:
        """Show these facts; `pending` is the reason why inferred facts are missing, or empty."""
        self._asserted.show(facts.asserted)
        self._why_pending.text = pending
        self._pending.set_visibility(bool(pending))
        self._inferred.all.set_visibility(not pending)
        self._inferred.show(facts.inferred)
        self._computed.show(facts.computed)


class _Group:
    """The facts of one kind, with their number."""

    def __init__(self, page: Page, title: str, most_open: int) -> None:
        self._page = page
        self._title, self._most_open = title, most_open
        self._facts: tuple[Fact, ...] | None = None
        self._most = _MOST
        self.all = ui.expansion().props("dense").classes("w-full semmap-facts")
        with self.all:
            self._rows = Rows(ui.column().classes("w-full gap-0"), self._draw, classes="w-full")
            self._none = ui.label("none").classes("semmap-quiet")
            self._more = ui.button(on_click=self._show_all).props("flat dense")

    def show(self, facts: tuple[Fact, ...]) -> None:
        """Show these facts."""
        if not self._facts and facts:  # later the user decides
            self.all.value = len(facts) <= self._most_open
        self._facts = facts
        self.all.text = f"{self._title} ({len(facts)})"
        self._none.set_visibility(not facts)
        more = len(facts) - self._most
        self._more.text = f"Show {more} more"
        self._more.set_visibility(more > 0)
        self._rows.show(keyed(facts[: self._most], lambda fact: (fact.text, fact.why)))

    def _show_all(self) -> None:
        facts = self._facts or ()
        self._most = max(self._most, len(facts))
        self.show(facts)

    def _draw(self, fact: Fact) -> Update[Fact]:
        return _Row(self._page, fact).show


class _Row:
    """One fact with its buttons, and its explanation below."""

    def __init__(self, page: Page, fact: Fact) -> None:
        self._page = page
        self._reasons: ui.column | None = None
        with ui.row().classes("w-full items-center no-wrap gap-1 semmap-fact"):
            with ui.column().classes("grow gap-0").style("min-width: 0"):
                ui.label(errors.shortened(fact.text, _LONGEST))
                self._measured = ui.label().classes("text-caption")
            self._other = ui.button(icon="near_me", on_click=lambda: page.select([fact.other], by="detail"))
            self._other.props("flat round dense size=sm").props["aria-label"] = f"Select {fact.other}"
            if fact.why is not None and page.moment.is_now:
                if fact.removable is not None and page.is_allowed("unset"):
                    _draw_unset(page, fact.why.name, *fact.removable)
                self._draw_why(fact, fact.why)
        self._below = ui.column().classes("w-full gap-0")
        self.show(fact)

    def show(self, fact: Fact) -> None:
        """Show the last measurement of the fact."""
        self._measured.text = fact.measured
        self._measured.set_visibility(bool(fact.measured))
        self._other.set_visibility(bool(fact.other) and fact.other in self._page.state.entities)

    def _draw_why(self, fact: Fact, args: ExplainArgs) -> None:
        """Draw the button that shows and hides the explanation below the fact."""

        async def toggle() -> None:
            if self._reasons is not None:
                self._reasons.delete()
                self._reasons = None
                button.props("aria-expanded=false")
                return
            with self._below:
                self._reasons = ui.column().classes("w-full gap-1 semmap-why").props('role="status"')
            button.props("aria-expanded=true")
            await _show_proof(self._page, self._reasons, args)

        button = ui.button("Why", on_click=toggle).props("flat dense no-caps size=sm aria-expanded=false")
        button.props["aria-label"] = f"Why: {errors.shortened(fact.text, 100)}"


def _draw_unset(page: Page, name: str, property_: str, value: object) -> None:
    async def unset() -> None:
        reply = await page.change(Unset(name=name, property=property_, value=value))  # type: ignore[arg-type]
        if reply is not None:
            page.notify(reply.text, "positive")

    button = ui.button(icon="close", on_click=unset).props("flat round dense size=sm")
    button.props["aria-label"] = f"Unset {property_}"
    button.tooltip("Unset")


async def _show_proof(page: Page, reasons: ui.column, args: ExplainArgs) -> None:
    try:
        found = await page.live.ask(Explain(**args._asdict()), _TIMEOUT_S)
    except errors.SemmapError as error:
        if not reasons.is_deleted:
            with reasons:
                ui.label(error.text).classes("semmap-sentence")
                if error.explanation is not None:
                    draw_proof(error.explanation, MapView.of(page).knowledge.words, sentence=False)
        return
    if not reasons.is_deleted:
        with reasons:
            draw_proof(found, MapView.of(page).knowledge.words)
