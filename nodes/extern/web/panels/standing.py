"""Standing queries."""

from __future__ import annotations

from nicegui import ui

from nodes.extern.web.page import Page


def standing(page: Page) -> None:
    """Draw it where it is called."""
    ui.label("Standing queries").classes("text-caption")
