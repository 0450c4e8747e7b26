"""An explanation as indented steps, and as a sentence."""

from __future__ import annotations

from typing import Final

from nicegui import ui

from semmap.nodes.extern.web.views.proof_lines import BASIS_LABELS, proof_lines
from semmap.nodes.kb_node.reasoner.explain.words import Words
from semmap.schemas.explanations import Explanation

_MOST_LINES: Final = 200
_INDENT_PX: Final = 14


def draw_proof(explanation: Explanation, words: Words, *, sentence: bool = True) -> None:
    """Draw the steps and, with `sentence`, the whole explanation as text below them."""
    steps = proof_lines(explanation, words)
    with ui.element("ul").classes("semmap-proof").props('aria-label="Steps"'):
        for line in steps[:_MOST_LINES]:
            with (
                ui.element("li")
                .classes(f"semmap-step is-{line.basis}")
                .style(f"margin-left: {line.depth * _INDENT_PX}px")
            ):
                ui.label(line.text)
                basis = ui.label("shown above" if line.repeated else BASIS_LABELS[line.basis]).classes(
                    "semmap-how"
                )
                if line.rule:
                    basis.tooltip(f"OWL 2 RL rule {line.rule}")
    if len(steps) > _MOST_LINES:
        ui.label(f"… and {len(steps) - _MOST_LINES} more steps").classes("semmap-quiet")
    if sentence:
        ui.label(explanation.text).classes("semmap-sentence text-caption")
