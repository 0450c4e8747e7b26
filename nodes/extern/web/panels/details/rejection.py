"""The dialog for a rejected change: its reason, the proof, and suggested fixes."""

from __future__ import annotations

from typing import Any

from nicegui import ui

from semmap.nodes.extern.web.page import Page
from semmap.nodes.extern.web.panels.details.proof import draw_proof
from semmap.nodes.extern.web.panels.widgets.folded_list import draw_error
from semmap.nodes.extern.web.panels.widgets.map_view import MapView
from semmap.nodes.extern.web.views.suggested_fixes import SuggestedFix, suggest_fixes
from semmap.schemas import errors
from semmap.schemas.commands import Command


def show_rejection(page: Page, command: Command[Any], error: errors.SemmapError) -> None:
    """Open the dialog; an error without a proof or fixes is shown as a notice instead."""
    view = MapView.of(page)
    fixes = [
        fix
        for fix in suggest_fixes(command, error, page.live.entities, page.live.classes)
        if all(page.is_allowed(step.VERB) for step in fix.commands)
    ]
    if error.explanation is None and not fixes:
        page.notify(error.text, "negative")
        return
    with ui.dialog(value=True).props('aria-label="Rejected"') as dialog, ui.card().classes("semmap-refused"):
        ui.label("Change rejected").classes("text-subtitle1 text-weight-medium")
        with ui.column().classes("w-full gap-0 semmap-sentence").props('role="alert"'):
            draw_error(error.text)
        if error.explanation is not None:
            with ui.expansion("Proof", value=True).classes("w-full").props("dense"):
                draw_proof(error.explanation, view.knowledge.words, sentence=False)
        if fixes:
            ui.label("Suggested fixes").classes("semmap-title")
            for fix in fixes:
                _button(page, dialog, fix)
        with ui.row().classes("w-full justify-end"):
            ui.button("Close", on_click=dialog.close).props("flat")
    dialog.on_value_change(lambda event: None if event.value else dialog.delete())


def _button(page: Page, dialog: ui.dialog, fix: SuggestedFix) -> None:
    async def apply() -> None:
        dialog.close()
        for command in fix.commands:
            if (reply := await page.change(command)) is None:
                return
        page.notify(getattr(reply, "text", "done"), "positive")

    colour = "negative" if fix.is_destructive else "primary"
    ui.button(errors.shortened(fix.text, 120), on_click=apply).props(f"outline no-caps color={colour}")
