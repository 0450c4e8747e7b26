"""The contents of the map as a tree of groups: similar things in one spot, with what is on and in them.

kitchen: 4 chairs | a table [on it: 2 plates, a bowl [in it: an apple]] | a fridge [in it: milk]
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Final, Literal

from semmap.nodes.language import nouns
from semmap.schemas import errors

How = Literal["on", "in", "round"]
"""The relation of a thing to its support or container, or to the thing that it stands round."""

HOWS: Final[tuple[How, ...]] = ("round", "on", "in")
_MOST_LEVELS: Final = 50
"""The maximum depth of a stack; a deeper one is a measurement error."""


@dataclass(frozen=True, slots=True)
class Thing:
    """A thing in a text. `noun` is singular, without article; `state` is an adjective or ""."""

    name: str
    noun: str
    state: str = ""
    place: str | None = None
    """The innermost place that contains it."""
    at: tuple[How, str] | None = None
    """The name of the thing that it is on, in or round."""
    volume_m3: float = 0.0
    fixed: bool = False
    kind: str = ""
    """The label of its class, if the noun is another label."""


@dataclass(frozen=True, slots=True)
class Place:
    """A place in a text; `within` is the name of the innermost place that it is a part of."""

    name: str
    noun: str
    within: str | None = None


@dataclass(frozen=True)
class Group:
    """Similar things that a text names together; in `load`, the most important groups come first."""

    noun: str
    state: str
    things: tuple[Thing, ...]
    load: Mapping[How, tuple[Group, ...]]

    @cached_property
    def all(self) -> int:
        """The number of things, including those on and in them."""
        return len(self.things) + sum(group.all for groups in self.load.values() for group in groups)

    @property
    def phrase(self) -> str:
        """`4 chairs`, `a door that is open`."""
        phrase = nouns.with_count(len(self.things), self.noun)
        verb = "are" if self.is_plural else "is"
        return f"{phrase} that {verb} {self.state}" if self.state else phrase

    @property
    def definite(self) -> str:
        """`the table`, `the 2 tables`."""
        if len(self.things) == 1:
            return f"the {self.noun}"
        return f"the {len(self.things)} {nouns.plural(self.noun)}"

    @property
    def is_plural(self) -> bool:
        """Whether its verb is in the plural."""
        return nouns.is_plural(len(self.things), self.noun)


class Inventory:
    """The things of a map by place, each with its support or container."""

    def __init__(self, things: Iterable[Thing], places: Iterable[Place] = ()) -> None:
        self.places = {place.name: place for place in places}
        self.things = {thing.name: thing for thing in things}
        self._called = Counter(place.noun for place in self.places.values())
        self._parts: dict[str, list[str]] = {}
        for place in sorted(self.places):
            if (within := self.places[place].within) is not None:
                self._parts.setdefault(within, []).append(place)
        self._above: dict[str, list[Thing]] = {}
        self._standing: dict[str | None, list[Thing]] = {}
        for thing in self.things.values():
            if thing.at is not None and self._is_supported(thing):
                self._above.setdefault(thing.at[1], []).append(thing)
            else:
                self._standing.setdefault(thing.place if thing.place in self.places else None, []).append(
                    thing
                )

    def _is_supported(self, thing: Thing) -> bool:
        """Return whether the chain of supports exists and does not lead back to the thing itself."""
        lower: Thing | None = thing
        for _ in range(_MOST_LEVELS):
            if lower is None or lower.at is None:
                return lower is not None
            lower = self.things.get(lower.at[1])
        return False

    def standing_in(self, place: str | None) -> tuple[Group, ...]:
        """Return the groups in a place, excluding its parts; None stands for outside all places."""
        return self._groups(self._standing.get(place, ()))

    def in_place(self, place: str) -> list[Thing]:
        """Return the things in a place, including those on and in others, excluding its parts."""
        return [thing for thing in self.things.values() if thing.place == place]

    def in_sum(self, things: Iterable[Thing]) -> tuple[Group, ...]:
        """Return things grouped by kind, wherever they are, the largest group first."""
        together: dict[str, list[Thing]] = {}
        for thing in things:
            together.setdefault(thing.kind or thing.noun, []).append(thing)
        groups = [Group(noun, "", tuple(those), {}) for noun, those in together.items()]
        return tuple(sorted(groups, key=lambda group: (-len(group.things), group.noun)))

    def at(self, name: str) -> Mapping[How, tuple[Group, ...]]:
        """Return the groups on, in and round a thing."""
        return self._load((name,))

    def the(self, place: str | None) -> str:
        """Return `the kitchen`, with the name of the place if the noun is ambiguous."""
        noun = self.places[place or ""].noun
        return f"the {noun}" if self._called[noun] == 1 else f"the {noun} {place}"

    def parts_of(self, place: str) -> list[str]:
        """Return the names of a place and of its direct and indirect parts, each before its parts."""
        found, waiting = dict[str, None](), [place]
        while waiting:
            name = waiting.pop()
            if name not in found:
                found[name] = None
                waiting += reversed(self._parts.get(name, ()))
        return list(found)

    def places_in_order(self) -> list[str]:
        """Return all places: each is followed by its parts, but outermost places come after theirs."""
        found = dict[str, None]()
        for name, place in self.places.items():
            if place.within not in self.places:
                _, *parts = self.parts_of(name)
                found.update(dict.fromkeys((*parts, name)))
        return list(found | dict.fromkeys(self.places))

    def _groups(self, things: Iterable[Thing]) -> tuple[Group, ...]:
        """Group things: those with a load first, then large ones, and parts of the building last."""
        together: dict[tuple[str, str], list[Thing]] = {}
        for thing in things:
            together.setdefault((thing.noun, thing.state), []).append(thing)
        groups = [
            Group(noun, state, tuple(those), self._load(thing.name for thing in those))
            for (noun, state), those in together.items()
        ]
        return tuple(sorted(groups, key=_rank))

    def _load(self, names: Iterable[str]) -> Mapping[How, tuple[Group, ...]]:
        by_how: dict[How, list[Thing]] = {}
        for name in names:
            for thing in self._above.get(name, ()):
                if thing.at is None:
                    raise errors.InternalError(f"{thing.name} has a support but no relation to it")
                by_how.setdefault(thing.at[0], []).append(thing)
        return {how: self._groups(by_how[how]) for how in HOWS if how in by_how}


def _rank(group: Group) -> tuple[bool, float, str, str]:
    fixed = all(thing.fixed for thing in group.things)
    weight = group.all - len(group.things) + sum(thing.volume_m3 for thing in group.things)
    return (fixed and not group.load, -weight, group.noun, group.state)
