"""Find."""

from __future__ import annotations

from nicegui import ui

from nodes.extern.web.page import Page


def find(page: Page) -> None:
    """Draw it where it is called."""
    ui.label("Find").classes("text-caption")
