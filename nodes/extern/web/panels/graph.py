"""Graph."""

from __future__ import annotations

from nicegui import ui

from nodes.extern.web.page import Page


def graph(page: Page) -> None:
    """Draw it where it is called."""
    ui.label("Graph").classes("text-caption")
