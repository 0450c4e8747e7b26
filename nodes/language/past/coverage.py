"""Which words of a question about the past its answer depends on: no word may be lost without a sign."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final

from semmap.nodes.language.past.elements import Element
from semmap.nodes.language.past.question import Asked, PastQuestion

_USED_BY: Final[Mapping[str, frozenset[Asked]]] = {
    "never": frozenset(("whether", "what", "how_many", "missing")),
    "not": frozenset(("whether", "what", "how_many", "missing")),
    "no_one": frozenset(("whether", "what", "how_many", "missing")),
    "more_than_once": frozenset(("whether", "what", "how_many")),
    "or": frozenset(),
    "or_else": frozenset(("whether",)),
    "previously": frozenset(("where",)),
    "afterwards": frozenset(),
    "first": frozenset(("where", "when", "since", "how_long", "who", "what")),
    "last": frozenset(("where", "when", "since", "until", "how_long", "who", "what", "whether")),
}
"""The questions of which a mark changes the answer; in others it is not used."""
_OF_PLACES: Final = ("where", "who", "what", "how_many", "changed", "missing")
"""Questions without an event that are about places, and not about states."""


def mark_used(question: PastQuestion, main: Sequence[Element]) -> None:
    """Mark the words that change the answer to the question, and those that state only structure."""
    asked, claim = question.asked, question.claim
    has_state = asked not in _OF_PLACES and bool(claim.subjects or claim.is_it)
    is_state_used = has_state or bool(claim.event)
    for element in main:
        if element.kind == "state" and not is_state_used:
            element.is_used = False
        uses = _USED_BY.get(element.value, (asked,)) if element.kind == "mark" else ()
        element.is_used = (
            element.is_used or asked in uses or ("filler" in element.senses and element.kind == "ask")
        )


def find_unused(elements: Sequence[Element]) -> list[str]:
    """Return the words that were not used, each run of them as one text."""
    found: list[str] = []
    is_run = False
    for element in elements:
        is_unused = not element.is_used and element.kind != "filler"
        if is_unused and is_run:
            found[-1] = f"{found[-1]} {element.text}"
        elif is_unused:
            found.append(element.text)
        is_run = is_unused
    return found
