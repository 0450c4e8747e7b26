"""The meaning of noun phrases: the entities that a whole description fits, and what contradicts the map."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Final

from msgspec import structs

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
from semmap.nodes.language.steps import quantities
from semmap.nodes.language.steps.phrase import NounPhrase, PlacePhrase
from semmap.nodes.language.steps.tokens import Text
from semmap.schemas.language import PlaceRelation, ThingDescription
from semmap.schemas.relations import RelationName

Names = tuple[str, ...]
_FROM_VIEWER: Final = ("isLeftOf", "isRightOf", "isInFrontOf", "isBehind")
_BY_MASS: Final = {"heaviest": -1, "lightest": 1}
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


class Meanings:
    """Finds the meaning of the noun phrases of one text in one map."""

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

    def of(self, phrase: NounPhrase, places: Sequence[PlacePhrase] = (), *, may_be_none: bool = False,
           as_place: bool = False, owner: Names = ()) -> Meaning:  # fmt: skip
        """Return the meaning of a phrase that is also at `places`.

        `may_be_none` suppresses doubts about things that are not where the phrase states. `owner` are the
        entities of a possessive pronoun.
        """
        if self.is_person(phrase):
            meaning = self._person(phrase, places)
        else:
            meaning = self._thing(phrase, places, may_be_none=may_be_none, as_place=as_place, owner=owner)
        self._count(phrase, meaning, may_be_none=may_be_none)
        if not phrase.alternatives or meaning.description is None:
            return meaning
        others = [self.of(other, places, may_be_none=may_be_none) for other in phrase.alternatives]
        texts = (self._t.between(other.first, other.end) for other in phrase.alternatives)
        meaning.names = tuple(dict.fromkeys(name for each in (meaning, *others) for name in each.names))
        meaning.ambiguous = meaning.ambiguous or any(other.ambiguous for other in others)
        meaning.doubts += (doubt for other in others for doubt in other.doubts)
        meaning.description = structs.replace(meaning.description, alternatives=tuple(texts))
        return meaning

    def _count(self, phrase: NounPhrase, meaning: Meaning, *, may_be_none: bool) -> None:
        """Add the quantity of a phrase to its meaning, and the doubt that fewer are known."""
        is_known = bool(meaning.names) and not may_be_none and not phrase.superlative
        text = self._t.between(phrase.first, phrase.end)
        doubt = quantities.count(phrase, len(meaning.names) if is_known else None, text)
        meaning.doubts += [doubt] if doubt else []
        if meaning.description is not None:
            meaning.description = structs.replace(
                meaning.description,
                quantity="all" if phrase.all_of and phrase.quantity is None else phrase.quantity,
                at_least=phrase.amount.at_least,
                at_most=phrase.amount.at_most,
            )

    # Places

    def _relations(self, places: Iterable[PlacePhrase], meaning: Meaning) -> list[tuple[PlacePhrase, Names]]:
        found: list[tuple[PlacePhrase, Names]] = []
        for place in places:
            if place.other.kind in ("pronoun", "speaker", "here", "robot") or self._is_floor(place):
                found.append((place, place.names))
                continue
            if place.other.kind == "name" and not self._t.tokens[place.other.head].is_capital:
                meaning.doubts.append(f"'{place.preposition} {place.other.name}' is not understood")
                found.append((place, ()))
                continue
            other = self.of(place.other, as_place=True)
            meaning.doubts += other.doubts
            names = other.names
            if place.other.second is not None:
                names = (*names, *self.of(place.other.second).names)
            found.append((place, names))
        return found

    def _is_floor(self, place: PlacePhrase) -> bool:
        """Return whether a place is the floor, which no map has as an entity."""
        return self._g.is_a(place.other.noun, "floor") and not self._nouns.is_noun(place.other.key)

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
        if not self._g.contains("contained", place.preposition):
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

    # Persons

    def _person(self, phrase: NounPhrase, places: Sequence[PlacePhrase]) -> Meaning:
        meaning = Meaning(is_person=True)
        relations = self._relations((*phrase.places, *places), meaning)
        name = phrase.name
        if phrase.kind == "thing" and phrase.key in self._nouns.entities:
            name = self._t.between(phrase.head - len(phrase.noun.split()) + 1, phrase.head + 1)
        meaning.description = ThingDescription(
            "Person",
            name=name,
            attributes=tuple(phrase.attributes),
            relation=tuple(self._relation(place, names) for place, names in relations),
            superlative=phrase.superlative,
            excluded=tuple(self._t.between(other.first, other.end) for other in phrase.excluded),
        )
        key = phrase.key if phrase.kind == "thing" else self.key(phrase.name) if phrase.name else ""
        if name:
            named = [n for n in self._nouns.entities.get(key, {}) if self._is_of_class(n, "Person")]
            exact = [n for n in named if n in self._nouns.exact.get(key, ())]
            meaning.names = meaning.alike = tuple(sorted(exact or named))
            meaning.ambiguous = len(meaning.names) > 1
            return meaning
        if phrase.owner is not None and phrase.owner.kind != "pronoun":
            return meaning
        if (
            not phrase.attributes
            and not phrase.superlative
            and relations
            and phrase.of is None
            and not phrase.excluded
        ):
            there: list[str] | None = sorted(self._index.members.get("Person", {}))
            for place, names in relations:
                there = self._at(there or (), place, names) if there else there
            meaning.names = tuple(there or ())
            meaning.ambiguous = (
                len(meaning.names) > 1 and phrase.is_definite and not phrase.is_plural and not phrase.all_of
            )
        return meaning

    def key(self, text: str) -> str:
        """Return the key by which a noun or name is looked up."""
        return self._nouns.describing.key(self._nouns.describing.split(text))

    # Things and places

    def _noun(self, phrase: NounPhrase) -> str:
        """Return the noun of a phrase in the singular, for a doubt."""
        before, space, last = phrase.noun.rpartition(" ")
        return before + space + self._nouns.describing.base(last)

    def _thing(self, phrase: NounPhrase, places: Sequence[PlacePhrase], *, may_be_none: bool, as_place: bool,
               owner: Names) -> Meaning:  # fmt: skip
        meaning = Meaning()
        is_any = self._g.is_a(self._nouns.describing.base(phrase.noun), "anything") or phrase.noun in (
            "one",
            "ones",
        )
        names = self._alike(phrase, is_any)
        meaning.is_place = bool(names) and all(self._index.items[name].is_place for name in names)
        relations = self._relations((*phrase.places, *places), meaning)
        is_open = False
        text = self._t.between(phrase.first, phrase.end)
        if (
            not names
            and phrase.of is not None
            and self._nouns.describing.base(phrase.noun) in self._nouns.describing.content
        ):
            names = list(self.of(phrase.of).names)
        if not names and not is_any and phrase.kind != "here":
            known = list(self._nouns.classes.get(phrase.key, ()))
            meaning.doubts += (
                []
                if may_be_none and not known
                else [
                    f"'{text}': no {self._noun(phrase)} is known"
                    if known
                    else f"'{phrase.noun}' is not known"
                ]
            )
        meaning.alike = tuple(names)
        attributes = list(phrase.attributes)
        for attribute in attributes:
            restriction = self._restriction(attribute)
            if restriction is None:
                is_open = True
            elif names:
                names = self._fitting(names, restriction, attribute, phrase, meaning)
        if phrase.of is not None and names:
            names = self._of(names, phrase, meaning)
        names = self._owned(names, phrase, owner, meaning)
        for other in phrase.excluded:
            excluded = self.of(other, may_be_none=True)
            if not excluded.names and (excluded.alike or not other.key):
                is_open = True  # the map cannot tell which one is broken
            if other is not phrase.excluded[0] and set(excluded.names).isdisjoint(meaning.alike):
                text = self._t.between(other.first, other.end)
                meaning.doubts.append(f"'{text}' is read as an exception")
            names = [name for name in names if name not in excluded.names]
        before = names
        for place, others in relations[: len(phrase.places)]:
            names, is_open = self._placed(names, place, others, is_open)
        if before and not names and self._is_served(phrase):
            names = before
        for place, others in relations[len(phrase.places) :]:
            names, is_open = self._placed(names, place, others, is_open)
        if before and not names and not is_open and not may_be_none:
            meaning.doubts.append(self._elsewhere(before, relations, phrase))
        if (
            len(names) > 1
            and phrase.is_definite
            and not phrase.is_plural
            and not phrase.superlative
            and not is_any
            and not phrase.amount.is_other
        ):
            labelled = self._nouns.exact.get(phrase.key, {})
            exact = [name for name in names if name in labelled] or [
                name for name in names if self._index.is_exact_match(name, phrase.key, "english")
            ]
            names = exact or names
        if phrase.superlative and names and not is_open:
            ordered = self._ordered(names, phrase)
            meaning.is_unordered, names = ordered is None, names if ordered is None else ordered
        wants_one = (
            phrase.is_definite
            and not phrase.is_plural
            and not phrase.superlative
            and phrase.quantity in (None, 1)
        )
        meaning.names = () if is_open and not phrase.superlative else tuple(sorted(names))
        if is_open and (attributes or not phrase.superlative):
            meaning.names = ()
        meaning.ambiguous = (
            len(meaning.names) > 1 and wants_one and not phrase.all_of and not is_any and not phrase.purpose
        )
        if (
            is_any
            and not relations
            and not phrase.attributes
            and not phrase.purpose
            and not phrase.superlative
        ) or (is_any and wants_one and len(meaning.names) > 1):
            meaning.names = ()
        meaning.description = self._description(phrase, names or meaning.alike, relations, is_any)
        return meaning

    def _alike(self, phrase: NounPhrase, is_any: bool) -> list[str]:
        """Return the entities that the noun alone fits."""
        if phrase.purpose:
            return sorted(self._index.members.get(self._g.purposes[phrase.purpose], {}))
        if is_any:
            return sorted(
                name
                for name, item in self._index.items.items()
                if not item.is_place and not self._is_of_class(name, "Person")
            )
        return sorted(self._index.find_by_noun(phrase.key, "english")) if phrase.key else []

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

    def _of(self, names: list[str], phrase: NounPhrase, meaning: Meaning) -> list[str]:
        """Return the things that belong to another, or that one: a bottle of water, the fridge's door."""
        if phrase.of is None:
            return names
        other = self.of(phrase.of)
        meaning.doubts += other.doubts
        fitting = [name for name in names if any(self._belongs(name, whole) for whole in other.names)]
        is_content = self._nouns.describing.base(phrase.noun) in self._nouns.describing.content
        is_part = not other.is_place and all(self._is_of_class(name, "Door") for name in names)
        stands_for = not other.is_person and (is_content or is_part)
        if not fitting and not stands_for:
            text = self._t.between(phrase.of.first, phrase.of.end)
            meaning.doubts.append(f"no {self._noun(phrase)} is known that belongs to {text}")
            return []
        return fitting or list(other.names)

    def _belongs(self, name: str, whole: str) -> bool:
        item, other = self._index.items[name], self._index.items[whole]
        related = self._world.geometry.related
        return (
            whole in item.all_values
            or name in other.all_values
            or related("isInside", name, whole)
            or related("isInside", whole, name)
        )

    def _owned(self, names: list[str], phrase: NounPhrase, owner: Names, meaning: Meaning) -> list[str]:
        by = phrase.owner
        if by is None or by.noun in ("your", "its"):
            return names
        if by.kind == "speaker" or by.kind == "pronoun":
            owned = [
                name
                for name in names
                if owner and set(owner) & self._index.items[name].values.get("isOwnedBy", frozenset())
            ]
            if names and not owned:
                meaning.doubts.append(f"'{by.noun} {phrase.noun}': the owner is not known")
            return owned or names
        owners = self.of(by)
        text = self._t.between(by.first, by.end)
        if not owners.names:
            meaning.doubts.append(f"'{text}' is not known")
            return []
        owned = [
            name
            for name in names
            if set(owners.names) & self._index.items[name].values.get("isOwnedBy", frozenset())
            or (not owners.is_person and any(self._belongs(name, whole) for whole in owners.names))
        ]
        if names and not owned:
            meaning.doubts.append(f"no {self._noun(phrase)} is known that belongs to {text}")
        return owned

    def _placed(
        self, names: list[str], place: PlacePhrase, others: Names, is_open: bool
    ) -> tuple[list[str], bool]:
        if not names:
            return names, is_open
        there = self._at(names, place, others)
        return (names, True) if there is None else (there, is_open)

    def _is_served(self, phrase: NounPhrase) -> bool:
        """Return whether a phrase states in what food is wanted, and not where it is: some water in a cup."""
        if not phrase.places or phrase.places[-1].other.determiner not in ("a", "an"):
            return False
        is_food = any(
            "Food" in self._world.above.get(self._index.items[n].class_name, ())
            for n in self._index.find_by_noun(phrase.key, "english")
        )
        container = self._nouns.describing.base(self._t.words[phrase.places[-1].other.head])
        return is_food and container in self._nouns.describing.content

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
        if superlative in _BY_MASS:
            masses = {name: self._index.items[name].values.get("mass", frozenset()) for name in names}
            return _BY_MASS[superlative], {
                name: number for name, mass in masses.items() if (number := number_of(mass)) is not None
            }
        sizes = {name: s for name in names if (s := size(name)) is not None}
        if superlative in _BY_THICKNESS:
            return _BY_THICKNESS[superlative], {name: min(s) for name, s in sizes.items()}
        sense = self._nouns.describing.sense(tuple(superlative.split())).get("sides")
        if sense is None or sense[0] not in ("volume", "tallness", "length"):
            return 0, {}
        measured: Mapping[str, Callable[[tuple[float, float, float]], float]] = {
            "volume": math.prod,
            "tallness": lambda s: s[2],
            "length": lambda s: max(s[:2]),
        }
        return sense[1], {name: measured[sense[0]](s) for name, s in sizes.items()}

    def _description(
        self,
        phrase: NounPhrase,
        names: Sequence[str],
        relations: Sequence[tuple[PlacePhrase, Names]],
        is_any: bool,
    ) -> ThingDescription:
        classes = self._nouns.whole.get(phrase.key, set()) or self._nouns.classes.get(phrase.key, set())
        own = {self._index.items[name].class_name for name in names}
        if names and all(name in self._nouns.exact.get(phrase.key, ()) for name in names):
            classes = {name for name in classes if any(self._is_of_class(entity, name) for entity in names)}
        class_name = (
            next(iter(sorted(classes)), "") if classes else (next(iter(own)) if len(own) == 1 else "Object")
        )
        if phrase.purpose:
            class_name = self._g.purposes[phrase.purpose]
        elif is_any:
            class_name = "Object"
        return ThingDescription(
            class_name,
            called="" if classes or is_any else phrase.noun,
            attributes=tuple(phrase.attributes),
            relation=tuple(
                self._relation(place, others) for place, others in relations[: len(phrase.places)]
            ),
            superlative=phrase.superlative,
            purpose=phrase.purpose,
            owner="" if phrase.owner is None else self._t.between(phrase.owner.first, phrase.owner.end),
            excluded=tuple(self._t.between(other.first, other.end) for other in phrase.excluded),
        )


def number_of(values: frozenset[object]) -> float | None:
    """Return the number among the values of a property, or None."""
    for value in values:
        if isinstance(value, int | float) and not isinstance(value, bool):
            return float(value)
        if isinstance(value, str):
            with suppress(ValueError):
                return float(value)
    return None
