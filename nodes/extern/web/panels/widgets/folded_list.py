"""A list of which the first five items are shown, and the others on request."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from nicegui import ui

from semmap.nodes.extern.web.notices import strip_cli_hints
from semmap.nodes.extern.web.views.error_outline import fold, outline_error
from semmap.schemas.errors import shortened

_LONGEST: Final = 2000
"""The number of characters of an item."""


def draw_folded(items: Sequence[str], *, classes: str = "") -> None:
    """Draw the items below each other, as plain text; those after the first five are folded."""
    shown, others = fold(items)
    _draw(shown, classes)
    if others:
        with ui.expansion(f"{len(others)} more").props("dense").classes(f"w-full semmap-folded {classes}"):
            _draw(others, classes)


def draw_error(text: str, *, classes: str = "") -> None:
    """Draw an error text without hints to the command line; a list in it as such."""
    outline = outline_error(strip_cli_hints(text))
    head = outline.head.removesuffix(":")
    _draw((f"{head}:" if outline.items else outline.head,), classes)
    draw_folded(outline.items, classes=f"{classes} semmap-item")
    if outline.tail:
        _draw((outline.tail,), classes)


def _draw(lines: Sequence[str], classes: str) -> None:
    for line in lines:
        ui.label(shortened(line, _LONGEST)).classes(f"whitespace-pre-wrap {classes}")
