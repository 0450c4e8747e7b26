"""Details."""

from __future__ import annotations

from nicegui import ui

from nodes.extern.web.page import Page


def detail(page: Page) -> None:
    """Draw it where it is called."""
    ui.label("Details").classes("text-caption")
