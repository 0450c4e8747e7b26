"""Converts explanations of the reasoner to messages. No other module does."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Final

from semmap.nodes.kb_node.reasoner import Inconsistent
from semmap.nodes.kb_node.reasoner import explanations as reasoner
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.explanations import Explanation, Step, Triple

_NAMELESS: Final = re.compile(r"_:\w+(?:[.-]+\w+)*")


def number_nameless(text: str, about: Iterable[Triple] = ()) -> str:
    """Return a text with [1], [2] ... for the labels of nameless individuals, in their order.

    The first mention of one to which a triple of `about` leads is `[1] (hasPosition of cup1)`, unless the
    text has the name of its subject.
    """
    numbers: dict[str, int] = {}
    nodes = set(_NAMELESS.findall(text))
    owners = {
        o: f" ({v.local_name(p)} of {name})"
        for s, p, o in (about if nodes else ())
        if o in nodes and s.startswith("<") and (name := v.entity_name(s)) not in text
    }

    def number(found: re.Match[str]) -> str:
        node = found[0]
        return f"[{numbers.setdefault(node, len(numbers) + 1)}]{owners.pop(node, '')}"

    return _NAMELESS.sub(number, text)


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


def to_error(found: Inconsistent, *, of: str = "", about: Iterable[Triple] = ()) -> errors.Inconsistent:
    """Return the error for clients. `of` names what is inconsistent and becomes the beginning of the text.

    `about` are the triples that describe nameless individuals.
    """
    text = number_nameless(found.explanation.text, about)
    return errors.Inconsistent(
        f"{of} is inconsistent: {text}" if of else text, explanation=to_message(found.explanation)
    )
