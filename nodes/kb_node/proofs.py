"""Converts explanations of the reasoner to messages. No other module does."""

from __future__ import annotations

from collections.abc import Iterable

from semmap.nodes.kb_node.reasoner import Inconsistent
from semmap.nodes.kb_node.reasoner import explanations as reasoner
from semmap.schemas import errors
from semmap.schemas.explanations import Explanation, Step, Triple


def to_message(found: reasoner.Explanation, computed: Iterable[Triple] = ()) -> Explanation:
    """Return an explanation as a wire message. `computed` are its facts that are computed from poses."""
    return Explanation(
        conclusion=found.conclusion,
        support=found.support,
        steps=tuple(
            Step(rule=step.rule, premises=step.premises, conclusion=step.conclusion) for step in found.steps
        ),
        text=found.text,
        supposed=found.supposed,
        computed=tuple(computed),
    )


def to_error(found: Inconsistent, *, of: str = "") -> errors.Inconsistent:
    """Return the error for clients. `of` names what is inconsistent and becomes the beginning of the text."""
    text = found.explanation.text
    return errors.Inconsistent(
        f"{of} is inconsistent: {text}" if of else text, explanation=to_message(found.explanation)
    )
