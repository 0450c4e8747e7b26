"""Reads what happened or was so from the elements of a clause."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Final

from semmap.nodes.language.past.elements import Element
from semmap.nodes.language.past.question import Claim

_CAUSED: Final = frozenset(
    ("move", "put", "take", "open", "close", "switch_on", "switch_off", "add", "remove", "change")
)
"""Events with an agent, who is named before the thing: Anna moved the cup."""
_OPENING: Final = {"open": "open", "closed": "close", "on": "switch_on", "off": "switch_off"}
"""The events that begin a state."""
_MOVING: Final = frozenset(("enter", "leave", "go"))
"""Events of which the first noun phrase is the subject and the second the place."""
_EVENT_ASKED: Final = frozenset(("when", "who", "how_often", "what", "how_many"))
"""Questions in which *closed* is an event and not a state."""
_LASTING: Final = frozenset(("how_long", "since", "until", "where", "whether"))
"""Questions in which *lay* and *stood* are not events."""


def read_claim(elements: Sequence[Element], asked: str) -> Claim:
    """Return what a clause states, and mark the elements that it uses."""
    _choose_senses(elements, asked)
    claim = Claim()
    _read_kind(claim, elements)
    bare: list[Element] = []
    joined = 0
    pending = ""
    relation: Element | None = None
    for i, element in enumerate(elements):
        if claim.kind and element.is_used and element.kind in ("relation", "thing"):
            continue
        match element.kind, element.value:
            case "relation", value:
                pending, relation = "" if value == "of" else value, element
                element.is_used = True
            case ("thing", _) | ("mark", "it" | "you"):
                if element.text == "yourself":
                    element.is_used = True
                    continue
                text = element.value if element.kind == "mark" else element.text
                element.is_used = True
                if pending == "by":
                    claim.agent = text
                elif pending:
                    claim.places.append((pending, text))
                elif element.is_a("mark", "it"):
                    claim.is_it = True
                else:
                    bare.append(element)
                pending = ""
            case "mark", "anyone" | "no_one":
                claim.is_anyone = element.is_used = True
                pending = ""
            case "mark", "anything":
                claim.is_anything = element.is_used = True
            case "mark", "there":
                element.is_used = True
                claim.is_there = claim.is_there or not _is_existential(elements, i)
            case "mark", "and" | "or" as value:
                element.is_used = value == "and" or not claim.places  # on the table or on the desk
                joined += bool(bare)
            case "event", value:
                pending = "" if pending == "to" else pending  # the last to move the cup
                if claim.event in ("", "change", value) or value == "missing":
                    claim.event, element.is_used = value, True
                elif value in ("go", "change"):
                    element.is_used = True
            case "state", value if claim.state in ("", value):
                claim.state, element.is_used = value, True
            case _:
                pass
    if pending and relation is not None:
        relation.is_used = False  # on average
    _share_out(claim, bare, elements, asked, joined)
    return claim


def _read_kind(claim: Claim, elements: Sequence[Element]) -> None:
    """Read the noun of *in which rooms has it been* and *which table was it on*."""
    is_trailing = any(e.value.startswith("trailing ") for e in elements if e.kind == "mark")
    for i, (element, noun) in enumerate(pairwise(elements)):
        before = elements[i - 1] if i else None
        is_after = before is not None and "relation" in before.senses
        if element.is_a("ask", "what") and noun.kind == "thing" and (is_after or is_trailing):
            claim.kind, noun.is_used = noun.text, True
            if before is not None and is_after:
                before.kind, before.is_used = "relation", True
            return


def _choose_senses(elements: Sequence[Element], asked: str) -> None:
    """Decide which meaning of an ambiguous expression counts."""
    acts = any(element.text in ("did", "do", "does", "has", "have", "got") for element in elements)
    stays = any(element.is_a("mark", "stay") for element in elements)
    does = not stays and any(element.text == "did" for element in elements)
    has_event = any(element.kind == "event" for element in elements)
    for i, element in enumerate(elements):
        senses = element.senses
        if element.kind == "state" and "state_event" in senses and not has_event:
            is_asked = asked in _EVENT_ASKED and (acts or element.text != "open")
            is_done = asked in ("whether", "while") and does and element.text != "closed"
            is_anchor = asked in ("before", "after") and element.text != "open" and _is_passive(elements)
            if is_asked or is_done or is_anchor:
                element.kind, element.value = "event", senses["state_event"]
        elif element.kind == "event" and senses.get("mark") == "stay" and asked in _LASTING:
            element.kind, element.value = "mark", "stay"
        elif element.kind in ("state", "relation") and "relation" in senses:
            following = next((e for e in elements[i + 1 :] if e.kind != "filler"), None)
            is_place = following is not None and (
                following.kind == "thing" or following.is_a("mark", "it", "anyone", "there", "you")
            )
            has_subject = asked in ("where", "what") and _has_subject(elements[:i])
            if is_place:
                element.kind, element.value = "relation", senses["relation"]
            elif has_subject and following is None:  # which table was the cup on
                element.kind, element.value = "mark", f"trailing {senses['relation']}"
            elif "state" in senses:
                element.kind, element.value = "state", senses["state"]
            elif asked in ("where", "what"):
                element.kind, element.value = "mark", f"trailing {senses['relation']}"
            elif "filler" in senses:
                element.kind = "filler"


def _has_subject(elements: Sequence[Element]) -> bool:
    """Return whether there is a noun that does not follow *which* or *what*."""
    pairs = pairwise((None, *elements))
    return any(
        e is not None
        and (e.kind == "thing" or e.is_a("mark", "it", "you"))
        and (before is None or before.kind != "ask")
        for before, e in pairs
    )


def _is_passive(elements: Sequence[Element]) -> bool:
    """Return whether a clause is in the past, where a participle is an event: after it was closed."""
    return any(e.is_a("mark", "past") for e in elements)


def _texts(elements: Sequence[Element]) -> list[str]:
    return [element.text for element in elements]


def _is_existential(elements: Sequence[Element], i: int) -> bool:
    """Return whether *there* stands before its subject: was there a cup."""
    return i + 1 < len(elements) and (
        elements[i + 1].kind == "thing" or elements[i + 1].is_a("mark", "anyone", "anything")
    )


def _share_out(
    claim: Claim, bare: list[Element], elements: Sequence[Element], asked: str, joined: int
) -> None:
    """Make the noun phrases without a preposition agent, subjects and place."""
    texts = ["you" if element.kind == "mark" else element.text for element in bare]
    kind = next(
        (
            element.text
            for before, element in pairwise(elements)
            if before.is_a("ask", "what", "how_many", "missing") and element in bare
        ),
        None,
    )
    if kind is not None:
        texts.remove(kind)
        if claim.event in _MOVING and (texts or claim.is_it):
            claim.kind = kind  # which rooms did the robot visit
        else:
            claim.subjects = [kind]
    if claim.event == "leave" and asked == "who" and any(how in ("on", "in") for how, _ in claim.places):
        claim.event = "put"  # who left the cup on the table
    if claim.event == "leave" and claim.state in _OPENING:
        claim.event = _OPENING[claim.state]  # who left the fridge open
    if claim.event == "see":
        texts = [text for text in texts if text != "you"]
        claim.event = "" if claim.places else claim.event
    if claim.event == "missing" and texts and claim.places:
        claim.event = "leave"  # since when is the cup no longer on the table
    if claim.event == "go" and claim.places:
        claim.event = "leave" if claim.places[0][0] == "from" else "enter"
    if claim.event in _MOVING:
        if texts and asked != "who" and not claim.subjects and not claim.is_it and not claim.is_anyone:
            claim.subjects.append(texts.pop(0))
        claim.places += (("from" if claim.event == "leave" else "to", text) for text in texts)
        return
    if "you" in texts[1:] and joined and claim.event in _CAUSED:  # did you take it, or Anna
        claim.agent, texts = "you", texts[:1]
    if claim.event in _CAUSED and not claim.agent:
        is_active = any(element.text in ("did", "has", "have", "had") for element in elements) and (
            "been" not in _texts(elements)
        )
        pairs = pairwise(elements)  # the last thing that Anna moved
        is_active = is_active or any(a in bare and a.text in texts and b.kind == "event" for a, b in pairs)
        is_first = kind is not None or (len(texts) > joined + 1) or claim.is_it
        if texts and asked != "who" and (is_first or (asked == "what" and is_active)):
            claim.agent = texts.pop(0)
    claim.subjects += texts
