"""Resolves a text to entities: tries each language and each parse, and takes the one that matches the map."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

from semmap.nodes.language.lexicon.describing import LANGUAGES
from semmap.nodes.language.reference_resolution import reading
from semmap.nodes.language.reference_resolution.description import Description, OneOf
from semmap.nodes.language.reference_resolution.map_geometry import MapGeometry
from semmap.nodes.language.reference_resolution.map_index import MapIndex
from semmap.nodes.language.reference_resolution.parsing import parses
from semmap.nodes.language.reference_resolution.reading import Reading
from semmap.nodes.language.reference_resolution.resolver import Resolved, Resolver, Scope
from semmap.schemas import errors
from semmap.schemas.language import Outcome

MOST_WORDS: Final = 60
"""The maximum length of a description."""
_MOST_PARSES: Final = 24


@dataclass(frozen=True, slots=True)
class Answer:
    """The result for a text: outcome and names, with the reading and the resolver that produced them."""

    outcome: Outcome
    names: tuple[str, ...]
    parts: tuple[Resolved, ...]
    reading: Reading
    resolver: Resolver


def find(
    text: str, known: MapIndex, around: MapGeometry, asker: str | None = None, answer: str | None = None
) -> Answer:
    """Return the entities that a text describes; *my* refers to the entity named `asker`.

    `answer` answers the clarification question about the text: *the one on the desk*. Raises BadRequest if a
    text has no words or too many, asks about the past, or uses left and right without a viewer.
    """
    question = None if answer is None else find(text, known, around, asker)
    read = _read(text if answer is None else answer, known)
    resolver = Resolver(known, around, read.nouns.describing.language, asker)
    best: tuple[int, Answer] | None = None
    for _, descriptions in zip(range(_MOST_PARSES), parses(read), strict=False):
        made = _resolve_all(descriptions, read, resolver, question)
        rank = _RANKS[made.outcome]
        if best is None or rank < best[0]:
            best = rank, made
        if rank == 0:
            break
    if best is None:
        raise errors.InternalError("a phrase has no parse")
    return best[1]


_RANKS: Final[dict[Outcome, int]] = {"one": 0, "several": 0, "ambiguous": 1, "none": 2}


def _read(text: str, known: MapIndex) -> Reading:
    """Read a text in its most likely language."""
    if (number := len(text.split())) > MOST_WORDS:
        raise errors.BadRequest(f"the description has {number} words; the maximum is {MOST_WORDS}")
    readings = sorted((reading.read(text, known.nouns[name]) for name in LANGUAGES), key=_cost)
    likely = [read for read in readings if read.cost == readings[0].cost]
    best = readings[0] if readings[0].cost == 0.0 else min(map(reading.correct_spelling, likely), key=_cost)
    if not best.words:
        raise errors.BadRequest(
            "the description contains no words; describe an object, for example: the red cup on the table"
        )
    for i, senses in enumerate(best.senses):
        if "past" in senses and "noun" not in senses:
            phrase = " ".join(best.words[i : i + senses["past"][0]])
            raise errors.BadRequest(
                f"'{phrase}' asks about the past, but find searches the current map;"
                " for the past use: semmap when, semmap last-seen, semmap find --as-of"
            )
    return best


def _cost(read: Reading) -> float:
    return read.cost


def _resolve_all(
    descriptions: tuple[Description, ...], read: Reading, resolver: Resolver, question: Answer | None = None
) -> Answer:
    """Resolve a list of descriptions; each may refer to the previous one by *it* or *one*.

    The descriptions may answer a `question`: then they denote some of its candidates.
    """
    parts: list[Resolved] = []
    scope = Scope()
    if question is not None and question.names:
        scope = Scope(question.names, question.parts[0].description)
        one_of = OneOf(" or ".join(question.names), frozenset(question.names))
        descriptions = tuple(replace(d, restrictions=(*d.restrictions, one_of)) for d in descriptions)
    for description in descriptions:
        found = resolver.resolve(description, scope)
        parts.append(found)
        scope = Scope(found.names, found.description)
    outcomes = [_outcome(part, resolver) for part in parts]
    for part, outcome in zip(parts, outcomes, strict=True):
        if part.names and outcome != "ambiguous":  # of things of several owners, the question asks
            resolver.require_speaker(part.description)
    names = tuple(dict.fromkeys(name for part in parts for name in part.names))
    if any(description.is_alternative for description in descriptions):
        return _either(parts, read, resolver)
    if "none" in outcomes or not parts:
        return Answer("none", (), tuple(parts), read, resolver)
    if "ambiguous" in outcomes:
        unclear = (part for part, outcome in zip(parts, outcomes, strict=True) if outcome == "ambiguous")
        names = tuple(dict.fromkeys(name for part in unclear for name in part.names))
        return Answer("ambiguous", names, tuple(parts), read, resolver)
    return Answer("one" if len(names) == 1 else "several", names, tuple(parts), read, resolver)


def _either(parts: list[Resolved], read: Reading, resolver: Resolver) -> Answer:
    """Combine descriptions that are joined by *or*: each that exists counts."""
    names = tuple(dict.fromkeys(name for part in parts for name in part.names))
    is_any = any(part.description.is_plural or not part.description.is_definite for part in parts)
    outcome: Outcome = "several" if is_any else "ambiguous"
    if len(names) < 2:
        outcome = "one" if names else "none"
    return Answer(outcome, names, tuple(parts), read, resolver)


def _outcome(part: Resolved, resolver: Resolver) -> Outcome:
    description, number = part.description, len(part.names)
    if not number:
        return "none"
    if description.order is not None:
        if part.is_tied:
            return "ambiguous"
        return "one" if number == 1 else "several"
    if description.number is not None and description.number != 1:
        if number < description.number:
            return "none"
        return "several" if number == description.number or not description.is_definite else "ambiguous"
    if number == 1:
        return "one"
    if description.head == "it" or description.is_plural or not description.is_definite:
        return "several"
    return "ambiguous"
