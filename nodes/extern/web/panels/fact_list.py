"""The facts about one thing in three groups, each with a button that asks why it holds."""

from __future__ import annotations

from typing import Final

from nicegui import ui

from nodes.extern.web.page import Page
from nodes.extern.web.panels.proof import proof
from nodes.extern.web.panels.view import View
from nodes.extern.web.views.facts import Fact, Facts, Question
from schemas import errors
from schemas.commands import Explain, Unset

_MOST: Final = 40
_TIME_S: Final = 15.0
_LONGEST: Final = 1000
_OF_THE_PAST: Final = "Only the present can be asked why: there are no proofs of the past."


def fact_list(page: Page, facts: Facts, pending: str = "") -> None:
    """Draw it where it is called. `pending` says why what is inferred is not there; empty if it is."""
    _group(page, "Asserted", "what somebody said", facts.asserted, is_open=True)
    if pending:
        ui.label("Inferred: what follows").classes("semmap-title q-pt-sm q-px-md")
        ui.label(pending).classes("semmap-sentence q-px-md").props('role="status"')
    else:
        _group(page, "Inferred", "what follows", facts.inferred, is_open=len(facts.inferred) <= 15)
    _group(page, "Computed", "what is measured", facts.computed, is_open=len(facts.computed) <= 10)
    if not page.moment.is_now:
        ui.label(_OF_THE_PAST).classes("semmap-quiet q-px-md")


def _group(page: Page, title: str, what: str, facts: tuple[Fact, ...], *, is_open: bool) -> None:
    with (
        ui.expansion(f"{title} ({len(facts)}): {what}", value=is_open and bool(facts))
        .props("dense")
        .classes("w-full semmap-facts")
    ):
        column = ui.column().classes("w-full gap-0")
        with column:
            for fact in facts[:_MOST]:
                _fact(page, fact)
            if not facts:
                ui.label("nothing").classes("semmap-quiet")
            if more := facts[_MOST:]:

                def show_all() -> None:
                    button.delete()
                    with column:
                        for fact in more:
                            _fact(page, fact)

                button = ui.button(f"Show {len(more)} more", on_click=show_all).props("flat dense")


def _fact(page: Page, fact: Fact) -> None:
    with ui.row().classes("w-full items-center no-wrap gap-1 semmap-fact"):
        with ui.column().classes("grow gap-0").style("min-width: 0"):
            ui.label(errors.shortened(fact.text, _LONGEST))
            if fact.measured:
                ui.label(fact.measured).classes("text-caption")
        if fact.other and fact.other in page.state.entities:
            other = fact.other
            ui.button(icon="near_me", on_click=lambda: page.select([other], by="detail")).props(
                "flat round dense size=sm"
            ).props["aria-label"] = f"Select {other}"
        if fact.why is None or not page.moment.is_now:
            return
        if fact.taken_back is not None and page.may("unset"):
            _take_back(page, fact.why.name, *fact.taken_back)
        _why(page, fact, fact.why)


def _take_back(page: Page, name: str, property_: str, value: object) -> None:
    async def do() -> None:
        if (done := await page.change(Unset(name=name, property=property_, value=value))) is not None:  # type: ignore[arg-type]
            page.tell(done.text, "positive")

    button = ui.button(icon="close", on_click=do).props("flat round dense size=sm")
    button.props["aria-label"] = f"Take back {property_}"
    button.tooltip("Take back")


def _why(page: Page, fact: Fact, question: Question) -> None:
    """A button that shows the reasons below the fact, and hides them again."""
    row = ui.context.slot.parent
    reasons: ui.column | None = None

    async def toggle() -> None:
        nonlocal reasons
        if reasons is not None:
            reasons.delete()
            reasons = None
            button.props("aria-expanded=false")
            return
        with row.parent_slot:  # type: ignore[union-attr]
            reasons = ui.column().classes("w-full gap-1 semmap-why").props('role="status"')
        reasons.move(target_index=row.parent_slot.children.index(row) + 1)  # type: ignore[union-attr]
        button.props("aria-expanded=true")
        await _tell_why(page, reasons, question)

    button = ui.button("why", on_click=toggle).props("flat dense no-caps size=sm aria-expanded=false")
    button.props["aria-label"] = f"Why: {errors.shortened(fact.text, 100)}"


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
