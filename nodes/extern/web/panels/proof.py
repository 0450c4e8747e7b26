"""An explanation, drawn: the steps, each indented below what rests on it, and the sentence."""

from __future__ import annotations

from typing import Final

from nicegui import ui

from semmap.nodes.extern.web.views.steps import HOW, lines
from semmap.nodes.kb_node.reasoner.explain.words import Words
from semmap.schemas.explanations import Explanation

_MOST_LINES: Final = 200
_INDENT_PX: Final = 14


def proof(explanation: Explanation, words: Words, *, sentence: bool = True) -> None:
    """Draw it where it is called; the `sentence` that says it all comes last."""
    told = lines(explanation, words)
    with ui.element("ul").classes("semmap-proof").props('aria-label="Steps"'):
        for line in told[:_MOST_LINES]:
            with (
                ui.element("li")
                .classes(f"semmap-step is-{line.how}")
                .style(f"margin-left: {line.depth * _INDENT_PX}px")
            ):
                ui.label(line.text)
                how = ui.label("told above" if line.again else HOW[line.how]).classes("semmap-how")
                if line.rule:
                    how.tooltip(f"by the rule {line.rule} of OWL 2 RL")
    if len(told) > _MOST_LINES:
        ui.label(f"and {len(told) - _MOST_LINES} more steps").classes("semmap-quiet")
    if sentence:
        ui.label(explanation.text).classes("semmap-sentence text-caption")
