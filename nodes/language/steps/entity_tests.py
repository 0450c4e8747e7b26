"""What the map tells of the entities that a noun phrase may denote: kind, qualities, places, order."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final

from semmap.nodes.language.lexicon.commands import Grammar
from semmap.nodes.language.reference_resolution.description import (
    Description,
    Of,
    Quality,
    Restriction,
    Sized,
    State,
)
from semmap.nodes.language.reference_resolution.map_geometry import MapGeometry
from semmap.nodes.language.reference_resolution.map_index import MapIndex
from semmap.nodes.language.reference_resolution.resolver import Resolver, Scope
from semmap.nodes.language.steps.phrase import NounPhrase, PlacePhrase
from semmap.nodes.language.steps.tokens import Text
from semmap.schemas.language import PlaceRelation, ThingDescription
from semmap.schemas.relations import RelationName

Names = tuple[str, ...]
Verdicts = tuple[bool | None, ...]
"""For each thing that is asked whether it is so, or None if the map cannot tell."""
_FROM_VIEWER: Final = ("isLeftOf", "isRightOf", "isInFrontOf", "isBehind")
_BY_THICKNESS: Final = {"thickest": -1, "thinnest": 1}
_COLORS: Final = "Color"


@dataclass(frozen=True, slots=True)
class World:
    """The map as commands need it."""

    index: MapIndex
    geometry: MapGeometry
    above: Mapping[str, frozenset[str]]  # class -> its superclasses, itself among them
    where: Callable[[str], str]  # what an entity is on or in, in words
    seen: Callable[[str], str]  # when an entity was last seen or placed, in words


@dataclass(slots=True)
class Meaning:
    """What a noun phrase denotes.

    `alike` are the entities that the noun alone fits. An `ambiguous` phrase denotes one of several entities.
    """

    names: Names = ()
    description: ThingDescription | None = None
    alike: Names = ()
    is_person: bool = False
    is_place: bool = False
    ambiguous: bool = False
    is_unordered: bool = False
    """Whether the map cannot tell which of the entities is the superlative one."""
    doubts: list[str] = field(default_factory=list)
    verdicts: Mapping[str, Verdicts] = field(default_factory=dict)
    """For each entity, whether it is so what a question asks of it: is the fridge open."""
    unknown: Names = ()
    """Entities that may fit the phrase: the map does not have the property of an attribute."""


class EntityTests:
    """Tests entities of one map against the phrases of one text."""

    def __init__(self, text: Text, grammar: Grammar, world: World) -> None:
        """Find meanings of phrases of `text`."""
        self._t, self._g, self._world = text, grammar, world
        self._index = world.index
        self._nouns = world.index.nouns["english"]
        self._resolver = Resolver(world.index, world.geometry, "english")

    def is_person(self, phrase: NounPhrase) -> bool:
        """Return whether a phrase denotes a person: by its noun, or by a known or unknown name."""
        if phrase.kind in ("person", "name"):
            return True
        if phrase.kind == "pronoun":
            return self._g.is_a(phrase.noun, "person_pronoun")
        if phrase.kind != "thing" or not phrase.key:
            return False
        named = self._nouns.entities.get(phrase.key, {})
        if named:
            return all(self._is_of_class(name, "Person") for name in named)
        return any(
            "Person" in self._world.above.get(name, ()) for name in self._nouns.classes.get(phrase.key, ())
        )

    def _is_of_class(self, name: str, class_name: str) -> bool:
        item = self._index.items[name]
        return class_name == item.class_name or class_name in item.types

    def _is_floor(self, place: PlacePhrase) -> bool:
        """Return whether a place is the floor, which no map has as an entity."""
        return self._g.is_a(place.other.noun, "floor") and not self._nouns.is_noun(place.other.key)

    def _is_home(self, phrase: NounPhrase) -> bool:
        """Return whether a phrase denotes all that the map has: (everywhere in) the house."""
        return self._g.is_a(phrase.noun, "home") and not self._nouns.is_noun(phrase.key)

    def _relation(self, place: PlacePhrase, names: Names) -> PlaceRelation:
        other = place.other
        return PlaceRelation(place.preposition, self._t.between(other.first, other.end), names, place.negated)

    def _at(self, names: Sequence[str], place: PlacePhrase, others: Names) -> list[str] | None:
        """Return those of `names` that are at a place, or None if the map cannot tell."""
        if self._is_floor(place):
            return [name for name in names if self._world.geometry.is_on_floor(name) != place.negated]
        if not others:
            return None
        related = self._world.geometry.related
        if place.preposition == "between":
            if len(others) != 2:
                return None
            between = self._world.geometry.between(others[0], others[1])
            return [name for name in names if (name in between) != place.negated]
        relations: tuple[RelationName, ...] = ("isOn", "isInside")
        is_source = self._g.contains("from", place.preposition)
        if not (is_source or self._g.contains("contained", place.preposition)):
            sense = self._nouns.describing.sense(tuple(place.preposition.split())).get("relations")
            if sense is None or sense in _FROM_VIEWER or sense == "outside":
                return None
            if sense in ("isNear", "isNextTo"):  # around the rack may also be on it
                relations = (sense, *relations) if sense == "isNear" else (sense,)
            elif sense != "at":
                relations = (sense,)
        return [
            name
            for name in names
            if any(
                name != other and related(relation, name, other) for other in others for relation in relations
            )
            != place.negated
        ]

    def key(self, text: str) -> str:
        """Return the key by which a noun or name is looked up."""
        return self._nouns.describing.key(self._nouns.describing.split(text))

    def _noun(self, phrase: NounPhrase) -> str:
        """Return the noun of a phrase in the singular, for a doubt."""
        before, space, last = phrase.noun.rpartition(" ")
        return before + space + self._nouns.describing.base(last)

    def _restriction(self, attribute: str) -> Restriction | None:
        """Return the test for an attribute that the map can tell, or None."""
        describing = self._nouns.describing
        words = describing.split(attribute)
        key = describing.key(words)
        if key in self._nouns.qualities:
            return Quality(attribute, frozenset(self._nouns.qualities[key]))
        sense = describing.sense(tuple(words))
        if "sizes" in sense:
            return Sized(attribute, *sense["sizes"])
        if "states" in sense:
            return State(attribute, *sense["states"])
        if self._nouns.is_noun(key):
            return Of(attribute, Description(attribute, "noun", key, attribute, is_definite=False))
        return None

    def verdicts(self, phrase: NounPhrase, names: Names) -> dict[str, Verdicts]:
        """Return for each entity and each thing that a question asks of it whether it is so."""
        return {name: tuple(self._verdict(name, asked, phrase) for asked in phrase.asked) for name in names}

    def _verdict(self, name: str, asked: str, phrase: NounPhrase) -> bool | None:
        """Return whether an entity has a quality or state, or *not* has it; None if the map cannot tell."""
        negated = asked.startswith("not ")
        restriction = self._restriction(asked.removeprefix("not "))
        described = Description(phrase.noun, "noun", phrase.key, phrase.noun)
        kind = self._index.items[name].class_name
        alike = tuple(sorted(self._index.members.get(kind, {}))) or (name,)
        if restriction is None or (isinstance(restriction, Sized) and len(alike) == 1):
            return None
        if self._resolver.fits(name, restriction, described, alike, Scope()):
            return not negated
        return None if self._is_open(name, restriction) else negated

    def _is_open(self, name: str, restriction: Restriction) -> bool:
        """Return whether the map does not have the property that a quality or state is a value of."""
        values = self._index.items[name].values
        match restriction:
            case State(_, "within"):
                return True  # what is not in the fridge may be cold as well
            case State(_, property_name, bool()) if property_name != "holding":
                return not values.get(property_name)
            case Quality(_, meant):
                return not any(_is_alike(value, meant) for found in values.values() for value in found)
        return False

    def _fitting(
        self, names: list[str], restriction: Restriction, attribute: str, phrase: NounPhrase, meaning: Meaning
    ) -> list[str]:
        described = Description(phrase.noun, "noun", phrase.key, phrase.noun)
        kind = tuple(names)
        fitting = [name for name in names if self._resolver.fits(name, restriction, described, kind, Scope())]
        if not fitting:
            meaning.doubts.append(self._contradiction(names, restriction, attribute, phrase))
        return fitting

    def _contradiction(
        self, names: list[str], restriction: Restriction, attribute: str, phrase: NounPhrase
    ) -> str:
        """Return the sentence that nothing known has an attribute; of one thing, with its own colour."""
        if len(names) == 1 and isinstance(restriction, Quality):
            values = self._index.items[names[0]].values
            own = sorted(str(v) for prop, all_ in values.items() if prop.endswith(_COLORS) for v in all_)
            if own:
                return f"{names[0]} is not {attribute}; it is {self._index.label(own[0], 'english')}"
        return f"no {attribute} {self._noun(phrase)} is known"

    def _belongs(self, name: str, whole: str) -> bool:
        item, other = self._index.items[name], self._index.items[whole]
        related = self._world.geometry.related
        return (
            whole in item.all_values
            or name in other.all_values
            or related("isInside", name, whole)
            or related("isInside", whole, name)
        )

    def _elsewhere(
        self, names: list[str], relations: Sequence[tuple[PlacePhrase, Names]], phrase: NounPhrase
    ) -> str:
        """Return the sentence that nothing of the kind is where the command states."""
        at, place = next(
            ((relation.preposition, others[0]) for relation, others in relations if len(others) == 1),
            ("", ""),
        )
        if self._g.contains("contained", at):
            at = "on or in"
        if any(relation.negated for relation, _ in relations):
            return f"'{self._t.between(phrase.first, phrase.end)}': no such {self._noun(phrase)} is known"
        if len(names) > 1 or not place:
            return f"no {self._noun(phrase)} is known {f'{at} {place}' if place else 'there'}"
        where = self._world.where(names[0])
        return f"{names[0]} is not {at} {place}" + (f"; it is {where}" if where else "")

    def _ordered(self, names: list[str], phrase: NounPhrase) -> list[str] | None:
        """Return the first of the things by a superlative, or None if the map cannot tell."""
        sign, values = self._values(names, phrase.superlative)
        known = sorted(
            (name for name in names if math.isfinite(values.get(name, math.inf))),
            key=lambda n: (sign * values[n], n),
        )
        if not sign or len(known) < len(names):
            return None
        count = phrase.quantity or 1
        if phrase.is_plural and phrase.quantity is None:
            return names
        return known[:count]

    def _values(self, names: list[str], superlative: str) -> tuple[int, dict[str, float]]:
        """Return the sign of a superlative (1: the least first, 0: unknown) and the value of each entity."""
        size = self._world.geometry.size
        sizes = {name: s for name in names if (s := size(name)) is not None}
        if superlative in _BY_THICKNESS:
            return _BY_THICKNESS[superlative], {name: min(s) for name, s in sizes.items()}
        sense = self._nouns.describing.sense(tuple(superlative.split())).get("sides")
        if sense is not None and sense[0] == "mass":
            masses = {name: self._index.items[name].number("mass") for name in names}
            return sense[1], {name: mass for name, mass in masses.items() if mass is not None}
        if sense is None or sense[0] not in ("volume", "tallness", "length"):
            return 0, {}
        measured: Mapping[str, Callable[[tuple[float, float, float]], float]] = {
            "volume": math.prod,
            "tallness": lambda s: s[2],
            "length": lambda s: max(s[:2]),
        }
        return sense[1], {name: measured[sense[0]](s) for name, s in sizes.items()}


def _is_alike(value: object, others: frozenset[str]) -> bool:
    """Return whether a value is an individual of the same kind as others by its name: *color_red*."""
    kind, underscore, _ = str(value).partition("_")
    return bool(underscore) and any(other.startswith(f"{kind}_") for other in others)
