"""What is not as it should be: contradictions, what is withheld or denied, doubts, and missing bodies."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator
from typing import Final, Literal, NamedTuple

from semmap.nodes.extern.web.views.steps import HOW, Line, lines, words_of
from semmap.schemas.entities import ClassInfo, Entity
from semmap.schemas.explanations import Explanation
from semmap.schemas.replies import Checked

Gravity = Literal["contradiction", "withheld", "denied", "doubt", "body", "crowd"]

TITLES: Final[dict[Gravity, str]] = {
    "contradiction": "Contradiction",
    "withheld": "Withheld: it would contradict the map",
    "denied": "Said, and not so as things stand",
    "doubt": "In doubt",
    "body": "Not as it should be in the scene",
    "crowd": "Too many things in one spot",
}
UNSURE: Final = 0.5
"""An entity that somebody is less sure of than this is in doubt."""
NBSP: Final = "\u00a0"
_WORD: Final = re.compile(r"[^\W\d][\w.\-]*")


class Finding(NamedTuple):
    """One thing to look at: a sentence, the entities that it is about, and why, in steps."""

    gravity: Gravity
    text: str
    names: tuple[str, ...]
    why: tuple[str, ...] = ()


def findings(
    checked: Checked, entities: Iterable[Entity], classes: Iterable[ClassInfo] = ()
) -> tuple[Finding, ...]:
    """All there is to look at, the gravest first."""
    known = {entity.name: entity for entity in entities}
    return (*_of_check(checked, known, classes), *_of_entities(known.values()))


def verdict(checked: Checked) -> str:
    """The verdict in one sentence, with how long it took."""
    took = f"{1000.0 * checked.elapsed_s:.0f} ms" if checked.elapsed_s < 1.0 else f"{checked.elapsed_s:.1f} s"
    return f"{checked.text} ({checked.triples:,} triples, {took}, {checked.engine})"


def names_in(text: str, known: Collection[str]) -> tuple[str, ...]:
    """The entities that a sentence names, in order, each once."""
    words = (match[0].rstrip(".-") for match in _WORD.finditer(text))
    return tuple(dict.fromkeys(word for word in words if word in known))


def _of_check(checked: Checked, known: Collection[str], classes: Iterable[ClassInfo]) -> Iterator[Finding]:
    if not checked.consistent:
        explained = checked.explanation
        text = checked.text if explained is None else explained.text
        yield Finding(
            "contradiction", text, names_in(text, known), () if explained is None else why(explained)
        )
    for text in checked.withheld:
        yield Finding("withheld", text, names_in(text, known))
    for relation in checked.denied:
        ends = (relation.subject, relation.object, relation.and_object or "")
        yield Finding("denied", relation.text, tuple(name for name in ends if name in known))
    for text in checked.crowds:
        yield Finding("crowd", text, names_in(text, known))


def _of_entities(entities: Iterable[Entity]) -> Iterator[Finding]:
    bodies: list[Finding] = []
    for entity in sorted(entities, key=lambda e: e.name):
        if entity.conflict:
            yield Finding("doubt", f"{entity.name}: perception sees {entity.conflict}", (entity.name,))
        sure = entity.provenance.confidence
        if sure is not None and sure < UNSURE:
            text = f"{entity.name}: {entity.provenance.source} is only {sure:.0%} sure of it"
            yield Finding("doubt", text, (entity.name,))
        body = entity.body
        if body is not None and body.status in ("ghost", "failed", "missing"):
            reason = f": {body.detail}" if body.detail else _UNTOLD.get(body.status, "")
            bodies.append(Finding("body", f"{entity.name} {_BODY[body.status]}{reason}", (entity.name,)))
    yield from bodies


_BODY: Final = {
    "ghost": "is a ghost",
    "failed": "could not be made",
    "missing": "has no body",
}
_UNTOLD: Final = {"ghost": ", because something else fills its place"}
"""Of a simulator that does not tell what."""


def why(explanation: Explanation, classes: Iterable[ClassInfo] = ()) -> tuple[str, ...]:
    """The proof, a line a step, with what each rests on below it and further in."""
    words = words_of(classes, ())
    return tuple(f"{2 * line.depth * NBSP}{line.text} ({_how(line)})" for line in lines(explanation, words))


def _how(line: Line) -> str:
    return f"follows: {line.rule}" if line.how == "follows" and line.rule else HOW[line.how]
