"""Coordination: the things that an argument lists, and the clauses that share one verb."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final

from semmap.nodes.language.understanding.referents import ANYTHING
from semmap.nodes.language.understanding.sentence import Sentence

Span = tuple[str, int, int]
"""A slot, and the indices of its first and last word."""

_AND: Final = ("and", "or")
_MOVED: Final = {  # prepositions, also of clauses without a verb: "the cup to the sink and the book to me"
    **dict.fromkeys(("from", "off", "out of"), "source"),
    **dict.fromkeys(("to", "into", "onto"), "goal"),
}
_GOALS: Final = ("goal", "beneficiary")
_BEARING: Final = (
    *("Location", "Connecting_Architecture", "Vessel", "Container", "Appliance", "Fixture", "Bed", "Table"),
    *("Couch", "Furniture", "Person", "Robot"),
)
_NOT_LISTED: Final = ("robot", "speaker")


def clauses(s: Sentence, frame: str, verb: int, spans: Sequence[Span]) -> list[list[Span]]:
    """Return the slot fillers of the verb at index `verb` for each clause, one thing per span.

    *Open the fridge and the oven* is one clause with two things. *Take the cup from the desk and the plate
    from the table* has two clauses.
    """
    if parallel := _parallel(s, verb):
        before = [span for span in spans if span[2] <= verb]
        return [[*before, *_pair(s, thing, where)] for thing, where in parallel]
    has_goal = frame not in ("Bringing", "Placing") or any(slot in _GOALS for slot, _, _ in spans)
    filled = {i for _, first, last in spans for i in range(first, last + 1)}
    found: list[Span] = []
    for named, first, last in spans:
        slot = named
        if found and first <= found[-1][2]:  # "to drink" belongs to "something"
            continue
        if s.words[last].text in ANYTHING and (purpose := _purpose(s, last)):
            found.append((slot, first, purpose))
            continue
        if found and found[-1][2] == first - 2 and s.words[first - 1].text in _AND and frame == "Motion":
            slot = found[-1][0]  # "to the kitchen" and "the sofa": nothing is acted on
        end = _extended(s, last, filled)
        found += [apart for part in _parts(s, first, end) for apart in _moved(s, slot, *part, has_goal)]
    return [found]


def _purpose(s: Sentence, i: int) -> int | None:
    """Return the last word of a purpose: *something to drink*."""
    k = s.phrase_of[i] + 1
    if k >= len(s.phrases) or s.phrases[k].preposition not in ("to", "from"):
        return None
    is_place = bool(s.candidates[k]) and s.branches[k] in _BEARING
    if is_place or s.words[s.phrases[k].last].kind not in ("noun", "adj"):
        return None
    return s.phrases[k].last if s.phrases[k].nominal == s.phrases[k].last else None


def _moved(s: Sentence, slot: str, first: int, last: int, has_goal: bool) -> Iterator[Span]:
    """Yield a thing and, as a separate span, its goal: *the chair* | *to the window*.

    If something is brought without a goal, the room at the end is the goal: *the book* | *in the studio*.
    """
    inside = range(s.phrase_of[first] + 1, s.phrase_of[last] + 1)
    to = next((k for k in inside if _MOVED.get(s.phrases[k].preposition) == "goal"), None)
    if to is None and inside and not has_goal and s.phrases[inside[-1]].kind == "pp":
        to = inside[-1] if s.branches[inside[-1]] == "Location" else None
    if slot != "thing" or to is None:
        yield slot, first, last
        return
    yield slot, first, s.phrases[to].first - 1
    yield "goal", s.phrases[to].first, last


def _parallel(s: Sentence, verb: int) -> list[tuple[int, int]]:
    """Return pairs of a thing and its goal or source after a verb, if there are at least two."""
    behind = [k for k in s.clause(verb) if s.phrases[k].kind != "particle"]
    if len(behind) < 5 or len(behind) % 3 != 2:
        return []
    pairs: list[tuple[int, int]] = []
    for at in range(0, len(behind), 3):
        thing, where = behind[at : at + 2]
        if s.phrases[thing].kind != "np" or s.phrases[where].preposition not in _MOVED:
            return []
        if at and s.words[s.phrases[behind[at - 1]].first].text not in _AND:
            return []
        pairs.append((thing, where))
    slots = {_MOVED[s.phrases[where].preposition] for _, where in pairs}
    return pairs if len(slots) == 1 else []


def _pair(s: Sentence, thing: int, where: int) -> Iterator[Span]:
    one, other = s.phrases[thing], s.phrases[where]
    yield "thing", one.first, one.last
    yield _MOVED[other.preposition], other.first, other.last


def _extended(s: Sentence, last: int, filled: set[int]) -> int:
    """Return the end of a list that begins before `last`: *the kitchen* [*and the studio*]."""
    while True:
        k = s.phrase_of[last] + 1
        if k + 1 >= len(s.phrases) or s.words[s.phrases[k].first].text not in _AND:
            return last
        following = s.phrases[k + 1]
        if not following.names or s.branches[k + 1] in _NOT_LISTED or not s.candidates[k + 1]:
            return last
        if following.kind == "pp" or filled & set(range(following.first, following.last + 1)):
            return last
        if k + 2 < len(s.phrases) and s.phrases[k + 2].kind in ("verb", "aux", "modal"):
            return last
        last = following.last


def _parts(s: Sentence, first: int, last: int) -> Iterator[tuple[int, int]]:
    """Yield the spans of the things in a list, separated by *and* or, before it, by phrase boundaries."""
    inside = range(s.phrase_of[first], s.phrase_of[last] + 1)
    joined = [k for k in inside if k + 1 in inside and _joins(s, k)]
    if not joined:
        yield first, last
        return
    start = first
    for k in inside:
        phrase = s.phrases[k]
        begins = phrase.kind == "np" and k > inside.start and k - 1 not in joined and k < joined[-1]
        if k in joined or (begins and s.phrases[k - 1].names and s.phrases[k - 1].last >= start):
            yield start, phrase.first - 1
            start = phrase.last + 1 if k in joined else phrase.first
    yield start, last


def _joins(s: Sentence, k: int) -> bool:
    """Return whether phrase k is an *and* between two noun phrases."""
    word = s.words[s.phrases[k].first].text
    return word in _AND and s.phrases[k - 1].names and s.phrases[k + 1].names
