"""Converts explanations of the reasoner to messages. No other module does."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Final

from semmap.nodes.kb_node.reasoner import Inconsistent
from semmap.nodes.kb_node.reasoner import explanations as reasoner
from semmap.schemas import errors
from semmap.schemas.explanations import Explanation, Step, Triple

_NAMELESS: Final = re.compile(r"_:\w+(?:[.-]+\w+)*")


def number_nameless(text: str) -> str:
    """Return a text with [1], [2] ... for the labels of nameless individuals, in their order."""
    numbers: dict[str, int] = {}
    return _NAMELESS.sub(lambda found: f"[{numbers.setdefault(found[0], len(numbers) + 1)}]", text)


def to_message(found: reasoner.Explanation, computed: Iterable[Triple] = ()) -> Explanation:
    """Return an explanation as a wire message. `computed` are its facts that are computed from poses."""
    return Explanation(
        conclusion=found.conclusion,
        support=found.support,
        steps=tuple(
            Step(rule=step.rule, premises=step.premises, conclusion=step.conclusion) for step in found.steps
        ),
        text=number_nameless(found.text),
        supposed=found.supposed,
        computed=tuple(computed),
    )


def to_error(found: Inconsistent, *, of: str = "") -> errors.Inconsistent:
    """Return the error for clients. `of` names what is inconsistent and becomes the beginning of the text."""
    text = number_nameless(found.explanation.text)
    return errors.Inconsistent(
        f"{of} is inconsistent: {text}" if of else text, explanation=to_message(found.explanation)
    )
