"""The facts about one thing in three groups, each with a button that asks why it holds."""

from __future__ import annotations

from typing import Final

from nicegui import ui

from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.panels.proof import proof
from semmap.nodes.extern.web.panels.rows import Renew, Rows, keyed
from semmap.nodes.extern.web.panels.view import View
from semmap.nodes.extern.web.views.facts import Fact, Facts, Question
from semmap.schemas import errors
from semmap.schemas.commands import Explain, Unset

_MOST: Final = 40
_TIME_S: Final = 15.0
_LONGEST: Final = 1000
_MOST_INFERRED: Final = 15
_MOST_COMPUTED: Final = 10
"""A longer group is closed at first."""
_OF_THE_PAST: Final = "Only the present can be asked why: there are no proofs of the past."


class FactList:
    """The facts of one thing at one moment. What is opened in it stays open while the facts change."""

    def __init__(self, page: Page) -> None:
        """Draw it where it is made, without facts."""
        self._asserted = _Group(page, "Asserted", "what somebody said", _MOST)
        with ui.column().classes("w-full gap-0") as self._pending:
            ui.label("Inferred: what follows").classes("semmap-title q-pt-sm q-px-md")
            self._why_pending = ui.label().classes("semmap-sentence q-px-md").props('role="status"')
        self._inferred = _Group(page, "Inferred", "what follows", _MOST_INFERRED)
        self._computed = _Group(page, "Computed", "what is measured", _MOST_COMPUTED)
        self._past = ui.label(_OF_THE_PAST).classes("semmap-quiet q-px-md")
        self._past.set_visibility(not page.moment.is_now)

    def show(self, facts: Facts, pending: str = "") -> None:
        """Show these facts; `pending` says why what is inferred is not there, and is empty if it is."""
        self._asserted.show(facts.asserted)
        self._why_pending.text = pending
        self._pending.set_visibility(bool(pending))
        self._inferred.all.set_visibility(not pending)
        self._inferred.show(facts.inferred)
        self._computed.show(facts.computed)


class _Group:
    """The facts of one kind, with how many they are."""

    def __init__(self, page: Page, title: str, what: str, most_open: int) -> None:
        self._page = page
        self._title, self._what, self._most_open = title, what, most_open
        self._facts: tuple[Fact, ...] | None = None
        self._most = _MOST
        self.all = ui.expansion().props("dense").classes("w-full semmap-facts")
        with self.all:
            self._rows = Rows(ui.column().classes("w-full gap-0"), self._draw, classes="w-full")
            self._none = ui.label("nothing").classes("semmap-quiet")
            self._more = ui.button(on_click=self._show_all).props("flat dense")

    def show(self, facts: tuple[Fact, ...]) -> None:
        """Show these facts."""
        if not self._facts and facts:  # whoever opens or closes it later has it so
            self.all.value = len(facts) <= self._most_open
        self._facts = facts
        self.all.text = f"{self._title} ({len(facts)}): {self._what}"
        self._none.set_visibility(not facts)
        more = len(facts) - self._most
        self._more.text = f"Show {more} more"
        self._more.set_visibility(more > 0)
        self._rows.show(keyed(facts[: self._most], lambda fact: (fact.text, fact.why)))

    def _show_all(self) -> None:
        facts = self._facts or ()
        self._most = max(self._most, len(facts))
        self.show(facts)

    def _draw(self, fact: Fact) -> Renew[Fact]:
        return _Row(self._page, fact).show


class _Row:
    """One fact with its buttons, and below it the reasons, where they were asked for."""

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
                if fact.taken_back is not None and page.may("unset"):
                    _take_back(page, fact.why.name, *fact.taken_back)
                self._draw_why(fact, fact.why)
        self._below = ui.column().classes("w-full gap-0")
        self.show(fact)

    def show(self, fact: Fact) -> None:
        """The same fact, as it was measured last."""
        self._measured.text = fact.measured
        self._measured.set_visibility(bool(fact.measured))
        self._other.set_visibility(bool(fact.other) and fact.other in self._page.state.entities)

    def _draw_why(self, fact: Fact, question: Question) -> None:
        """A button that shows the reasons below the fact, and hides them again."""

        async def toggle() -> None:
            if self._reasons is not None:
                self._reasons.delete()
                self._reasons = None
                button.props("aria-expanded=false")
                return
            with self._below:
                self._reasons = ui.column().classes("w-full gap-1 semmap-why").props('role="status"')
            button.props("aria-expanded=true")
            await _tell_why(self._page, self._reasons, question)

        button = ui.button("why", on_click=toggle).props("flat dense no-caps size=sm aria-expanded=false")
        button.props["aria-label"] = f"Why: {errors.shortened(fact.text, 100)}"


def _take_back(page: Page, name: str, property_: str, value: object) -> None:
    async def do() -> None:
        if (done := await page.change(Unset(name=name, property=property_, value=value))) is not None:  # type: ignore[arg-type]
            page.tell(done.text, "positive")

    button = ui.button(icon="close", on_click=do).props("flat round dense size=sm")
    button.props["aria-label"] = f"Take back {property_}"
    button.tooltip("Take back")


async def _tell_why(page: Page, reasons: ui.column, question: Question) -> None:
    try:
        found = await page.live.ask(Explain(**question._asdict()), _TIME_S)
    except errors.SemmapError as error:
        if not reasons.is_deleted:
            with reasons:
                ui.label(error.text).classes("semmap-sentence")
                if error.explanation is not None:
                    proof(error.explanation, View.of(page).knowing.words, sentence=False)
        return
    if not reasons.is_deleted:
        with reasons:
            proof(found, View.of(page).knowing.words)
