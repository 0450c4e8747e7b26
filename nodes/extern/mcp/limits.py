"""The limits of an agent: the classes and places that it may change, and the rate of changes."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Collection, Iterable, Mapping
from typing import Final

from msgspec import Struct

from semmap.schemas import errors

CHANGES_PER_MIN: Final = 30.0
"""The default rate limit of commits per minute."""
_LOCATED: Final = "isLocatedIn"


class Limits(Struct, frozen=True, kw_only=True):
    """The permitted classes (with subclasses) and places, by name; an empty set permits all."""

    classes: frozenset[str] = frozenset()
    places: frozenset[str] = frozenset()


class Touched(Struct, frozen=True, kw_only=True):
    """An entity of a change, with its classes and places before and after the change."""

    name: str
    classes_before: frozenset[str] = frozenset()
    classes_after: frozenset[str] = frozenset()
    places_before: frozenset[str] = frozenset()
    places_after: frozenset[str] = frozenset()
    is_new: bool = False
    is_gone: bool = False


def require(limits: Limits, touched: Iterable[Touched]) -> None:
    """Raise Refused for an entity that is beyond the limits before or after the change."""
    for one in touched:
        before = () if one.is_new else (("is not", one.classes_before, one.places_before),)
        after = () if one.is_gone else (("would not be", one.classes_after, one.places_after),)
        for is_not, classes, places in (*before, *after):
            _require_one_of(limits.classes, classes, f"{one.name} {is_not} of a class that you may change")
            _require_one_of(limits.places, places, f"{one.name} {is_not} in a place that you may change")


def after(
    places: Collection[str], name: str, follows: Iterable[str], no_longer: Iterable[str]
) -> frozenset[str]:
    """Return the places of `name` after a change, from its inferred facts."""
    return (frozenset(places) - _located(name, no_longer)) | _located(name, follows)


def _located(name: str, facts: Iterable[str]) -> frozenset[str]:
    split = (fact.split(" ") for fact in facts)
    return frozenset(words[2] for words in split if len(words) == 3 and words[:2] == [name, _LOCATED])


def _require_one_of(allowed: Collection[str], given: Collection[str], refusal: str) -> None:
    if allowed and not set(allowed) & set(given):
        raise errors.Refused(f"{refusal}: {errors.enumerated(sorted(allowed))}")


def resolve_classes(words: Collection[str], known: Mapping[str, str]) -> frozenset[str]:
    """Return the names of classes in the map. `known` has the names by key in lower case.

    Raises UnknownClass.
    """
    found = {word: known.get(word.casefold().replace("_", "")) for word in words}
    for word, name in found.items():
        if name is None:
            raise errors.UnknownClass(
                f"unknown class '{word}'{errors.suggestion(word, known.values(), 'classes')}"
            )
    return frozenset(name for name in found.values() if name is not None)


class Rate:
    """A token bucket: `per_s` calls per second, and bursts of `at_once`. It can be used from any thread."""

    def __init__(self, per_s: float, at_once: float, clock: Callable[[], float] = time.monotonic) -> None:
        self._per_s, self._at_once, self._clock = per_s, at_once, clock
        self._left, self._at = at_once, clock()
        self._lock = threading.Lock()

    def wait_s(self) -> float:
        """Take a token and return 0, or return the time until the next token is available [s]."""
        with self._lock:
            now = self._clock()
            self._left = min(self._at_once, self._left + (now - self._at) * self._per_s)
            self._at = now
            if self._left >= 1.0:
                self._left -= 1.0
                return 0.0
            return (1.0 - self._left) / self._per_s
