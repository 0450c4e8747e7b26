"""What a text describes: read in each language, parsed in each way, taken as it fits the map."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from semmap.nodes.language.lexicon.describing import LANGUAGES
from semmap.nodes.language.reference_resolution import reading
from semmap.nodes.language.reference_resolution.description import Description
from semmap.nodes.language.reference_resolution.map_geometry import MapGeometry
from semmap.nodes.language.reference_resolution.map_index import MapIndex
from semmap.nodes.language.reference_resolution.parsing import parses
from semmap.nodes.language.reference_resolution.reading import Reading
from semmap.nodes.language.reference_resolution.resolver import Resolved, Resolver, Scope
from semmap.schemas import errors
from semmap.schemas.language import Outcome

MOST_WORDS: Final = 60
"""Of a description."""
_MOST_PARSES: Final = 24


@dataclass(frozen=True, slots=True)
class Answer:
    """What a text means in a map: outcome and names, with how that was come by."""

    outcome: Outcome
    names: tuple[str, ...]
    parts: tuple[Resolved, ...]
    reading: Reading
    resolver: Resolver


def find(text: str, known: MapIndex, around: MapGeometry, asker: str | None = None) -> Answer:
    """The entities that a text describes; `asker` is who says *my*, by name.

    Raises BadRequest for no words, too many, what is said of the past, and left and right without a viewer.
    """
    read = _read(text, known)
    resolver = Resolver(known, around, read.nouns.describing.language, asker)
    best: tuple[int, Answer] | None = None
    for _, said in zip(range(_MOST_PARSES), parses(read), strict=False):
        made = _answered(said, read, resolver)
        rank = _RANKS[made.outcome]
        if best is None or rank < best[0]:
            best = rank, made
        if rank == 0:
            break
    if best is None:
        raise errors.InternalError("a phrase has no reading at all")
    return best[1]


_RANKS: Final[dict[Outcome, int]] = {"one": 0, "several": 0, "ambiguous": 1, "none": 2}


def _read(text: str, known: MapIndex) -> Reading:
    """A text in the language that it is in, as it seems."""
    if (number := len(text.split())) > MOST_WORDS:
        raise errors.BadRequest(f"a description has at most {MOST_WORDS} words; these are {number}")
    readings = sorted((reading.read(text, known.nouns[name]) for name in LANGUAGES), key=_cost)
    likely = [read for read in readings if read.cost == readings[0].cost]
    best = readings[0] if readings[0].cost == 0.0 else min(map(reading.mended, likely), key=_cost)
    if not best.words:
        raise errors.BadRequest(
            "there are no words in the text; describe a thing, such as: the red cup on the table"
        )
    for i, senses in enumerate(best.senses):
        if "past" in senses and "noun" not in senses:
            said = " ".join(best.words[i : i + senses["past"][0]])
            raise errors.BadRequest(
                f"'{said}' asks about the past, and find looks at the map as it is now;"
                " for the past see: semmap when, semmap last-seen, semmap list --as-of"
            )
    return best


def _cost(read: Reading) -> float:
    return read.cost


def _answered(said: tuple[Description, ...], read: Reading, resolver: Resolver) -> Answer:
    """Things that are named together: each may be spoken of by the next one as *it*, its noun as *one*."""
    parts: list[Resolved] = []
    scope = Scope()
    for description in said:
        found = resolver.resolve(description, scope)
        parts.append(found)
        scope = Scope(found.names, found.description)
    outcomes = [_outcome(part, resolver) for part in parts]
    names = tuple(dict.fromkeys(name for part in parts for name in part.names))
    if any(description.is_alternative for description in said):
        return _either(parts, read, resolver)
    if "none" in outcomes or not parts:
        return Answer("none", (), tuple(parts), read, resolver)
    if "ambiguous" in outcomes:
        unclear = (part for part, outcome in zip(parts, outcomes, strict=True) if outcome == "ambiguous")
        names = tuple(dict.fromkeys(name for part in unclear for name in part.names))
        return Answer("ambiguous", names, tuple(parts), read, resolver)
    return Answer("one" if len(names) == 1 else "several", names, tuple(parts), read, resolver)


def _either(parts: list[Resolved], read: Reading, resolver: Resolver) -> Answer:
    """Things that are named with *or*: any of those that there are is meant."""
    names = tuple(dict.fromkeys(name for part in parts for name in part.names))
    is_any = any(part.description.is_plural or not part.description.is_definite for part in parts)
    outcome: Outcome = "several" if is_any else "ambiguous"
    if len(names) < 2:
        outcome = "one" if names else "none"
    return Answer(outcome, names, tuple(parts), read, resolver)


def _outcome(part: Resolved, resolver: Resolver) -> Outcome:
    said, number = part.description, len(part.names)
    if not number:
        return "none"
    if said.order is not None:
        if part.is_tied:
            return "ambiguous"
        return "one" if number == 1 else "several"
    if said.number is not None and said.number != 1:
        if number < said.number:
            return "none"
        return "several" if number == said.number or not said.is_definite else "ambiguous"
    if number == 1:
        return "one"
    if said.head == "it" or said.is_plural or not said.is_definite:
        return "several"
    return "ambiguous"
