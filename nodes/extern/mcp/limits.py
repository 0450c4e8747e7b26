"""What an agent may change: of which classes, in which places, and how often."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from typing import Final

from msgspec import Struct

from semmap.schemas import errors

CHANGES_PER_MIN: Final = 30.0
"""Commits that an agent may make a minute, unless it is said otherwise."""
_LOCATED: Final = "isLocatedIn"


class Limits(Struct, frozen=True, kw_only=True):
    """Classes (with their subclasses) and places, by name; none means all."""

    classes: frozenset[str] = frozenset()
    places: frozenset[str] = frozenset()


class Touched(Struct, frozen=True, kw_only=True):
    """An entity that a change touches: its classes, and the places that it is in, before and after it."""

    name: str
    classes_before: frozenset[str] = frozenset()
    classes_after: frozenset[str] = frozenset()
    places_before: frozenset[str] = frozenset()
    places_after: frozenset[str] = frozenset()
    is_new: bool = False
    is_gone: bool = False


def require(limits: Limits, touched: Iterable[Touched]) -> None:
    """Raises Refused, with what is allowed, for an entity that is beyond the limits before or after."""
    for one in touched:
        before = () if one.is_new else (("is not", one.classes_before, one.places_before),)
        after = () if one.is_gone else (("would not be", one.classes_after, one.places_after),)
        for is_not, classes, places in (*before, *after):
            _require_one_of(limits.classes, classes, f"{one.name} {is_not} of a class that you may change")
            _require_one_of(limits.places, places, f"{one.name} {is_not} where you may change things")


def after(
    places: Collection[str], name: str, follows: Iterable[str], no_longer: Iterable[str]
) -> frozenset[str]:
    """The places that `name` is in after a change, by what follows from it and what does no longer."""
    return (frozenset(places) - _located(name, no_longer)) | _located(name, follows)


def _located(name: str, facts: Iterable[str]) -> frozenset[str]:
    said = (fact.split(" ") for fact in facts)
    return frozenset(words[2] for words in said if len(words) == 3 and words[:2] == [name, _LOCATED])


def _require_one_of(allowed: Collection[str], given: Collection[str], refusal: str) -> None:
    if allowed and not set(allowed) & set(given):
        raise errors.Refused(f"{refusal}: {errors.enumerated(sorted(allowed))}")


def resolve_classes(words: Collection[str], known: Mapping[str, str]) -> frozenset[str]:
    """Classes as the map names them. `known` has their names by themselves in lower case.

    Raises UnknownClass.
    """
    found = {word: known.get(word.casefold().replace("_", "")) for word in words}
    for word, name in found.items():
        if name is None:
            raise errors.UnknownClass(f"unknown class '{word}'{errors.did_you_mean(word, known.values())}")
    return frozenset(name for name in found.values() if name is not None)
