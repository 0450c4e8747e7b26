"""Why a change was refused, step by step, and what would mend it."""

from __future__ import annotations

from typing import Any

from nicegui import ui

from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.panels.proof import proof
from semmap.nodes.extern.web.panels.view import View
from semmap.nodes.extern.web.views.mends import Mend, mends
from semmap.nodes.extern.web.views.sentences import in_the_page
from semmap.schemas import errors
from semmap.schemas.commands import Command


def refused(page: Page, command: Command[Any], error: errors.SemmapError) -> None:
    """Open it in this tab; a sentence that says all is shown for some seconds instead."""
    view = View.of(page)
    ways = [
        mend
        for mend in mends(command, error, page.live.entities, page.live.classes)
        if all(page.may(step.VERB) for step in mend.commands)
    ]
    if error.explanation is None and not ways:
        page.tell(error.text, "negative")
        return
    with ui.dialog(value=True).props('aria-label="Refused"') as dialog, ui.card().classes("semmap-refused"):
        ui.label("This was refused; nothing has changed").classes("text-subtitle1 text-weight-medium")
        ui.label(errors.shortened(in_the_page(error.text), 2000)).classes("semmap-sentence").props(
            'role="alert"'
        )
        if error.explanation is not None:
            with ui.expansion("Step by step", value=True).classes("w-full").props("dense"):
                proof(error.explanation, view.knowing.words, sentence=False)
        if ways:
            ui.label("What would mend it").classes("semmap-title")
            for mend in ways:
                _button(page, dialog, mend)
        with ui.row().classes("w-full justify-end"):
            ui.button("Close", on_click=dialog.close).props("flat")
    dialog.on_value_change(lambda event: None if event.value else dialog.delete())


def _button(page: Page, dialog: ui.dialog, mend: Mend) -> None:
    async def do() -> None:
        dialog.close()
        for command in mend.commands:
            if (done := await page.change(command)) is None:
                return
        page.tell(getattr(done, "text", "done"), "positive")

    colour = "negative" if mend.is_grave else "primary"
    ui.button(errors.shortened(mend.text, 120), on_click=do).props(f"outline no-caps color={colour}")
