"""The reasoner's explanations as messages: the one place where the two forms meet."""

from __future__ import annotations

from semmap.nodes.kb_node.reasoner import Inconsistent
from semmap.nodes.kb_node.reasoner import explanations as reasoner
from semmap.schemas import errors
from semmap.schemas.explanations import Explanation, Step


def to_message(found: reasoner.Explanation) -> Explanation:
    """An explanation as it goes over the wire."""
    return Explanation(
        conclusion=found.conclusion,
        support=found.support,
        steps=tuple(
            Step(rule=step.rule, premises=step.premises, conclusion=step.conclusion) for step in found.steps
        ),
        text=found.text,
        supposed=found.supposed,
    )


def to_error(found: Inconsistent, *, of: str = "") -> errors.Inconsistent:
    """The error that callers over the wire get; its sentence may begin with what is inconsistent (`of`)."""
    text = found.explanation.text
    return errors.Inconsistent(
        f"{of} is inconsistent: {text}" if of else text, explanation=to_message(found.explanation)
    )
