"""Why a change was refused."""

from __future__ import annotations

from typing import Any

from nicegui import ui

from nodes.extern.web.page import Page
from schemas import errors
from schemas.commands import Command


def refused(page: Page, command: Command[Any], error: errors.SemmapError) -> None:
    """Show the reason, in a dialog of its own."""
    with ui.dialog(value=True) as dialog, ui.card():
        ui.label("Refused").classes("text-h6")
        ui.label(error.text)
        ui.button("Close", on_click=dialog.close)
