"""SPARQL."""

from __future__ import annotations

from nicegui import ui

from nodes.extern.web.page import Page


def sparql(page: Page) -> None:
    """Draw it where it is called."""
    ui.label("SPARQL").classes("text-caption")
