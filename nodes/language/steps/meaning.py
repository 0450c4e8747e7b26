"""The meaning of noun phrases: the entities that a whole description fits, and what contradicts the map."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from msgspec import structs

from semmap.nodes.language.reference_resolution.description import Description, Quality
from semmap.nodes.language.reference_resolution.resolver import Scope
from semmap.nodes.language.steps import quantities
from semmap.nodes.language.steps.entity_tests import EntityTests, Meaning, Names
from semmap.nodes.language.steps.phrase import NounPhrase, PlacePhrase
from semmap.schemas.language import ThingDescription


class Meanings(EntityTests):
    """Finds the meaning of the noun phrases of one text in one map."""

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
        meaning.description = quantities.describe(phrase, meaning.description)

    # Places

    def _relations(self, places: Iterable[PlacePhrase], meaning: Meaning) -> list[tuple[PlacePhrase, Names]]:
        found: list[tuple[PlacePhrase, Names]] = []
        for place in places:
            if place.other.kind == "thing" and self._is_home(place.other):
                found.append((place, ()))
                continue
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

    # Things and places

    def _thing(self, phrase: NounPhrase, places: Sequence[PlacePhrase], *, may_be_none: bool, as_place: bool,
               owner: Names) -> Meaning:  # fmt: skip
        meaning = Meaning()
        is_any = self._g.is_a(self._nouns.describing.base(phrase.noun), "anything") or phrase.noun in (
            "one",
            "ones",
        )
        if phrase.owner is None and (one := self._index.several_of(phrase.key, "english", 2)) != phrase.key:
            phrase.key, phrase.is_plural = one, True  # but my glasses are for seeing
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
        if not names and not is_any and phrase.kind != "here" and not self._is_home(phrase):
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
            is_negated = attribute.startswith("not ")
            restriction = self._restriction(attribute.removeprefix("not "))
            if is_negated and names and isinstance(restriction, Quality):
                names = self._without(names, restriction, phrase, meaning)
            elif restriction is None or is_negated:
                is_open = True
            elif names:
                kind, names = names, self._fitting(names, restriction, attribute, phrase, meaning)
                meaning.unknown = () if names else tuple(n for n in kind if self._is_open(n, restriction))
        if phrase.of is not None and names:
            names = self._of(names, phrase, meaning)
        names = self._owned(names, phrase, owner, meaning)
        for other in phrase.excluded:
            excluded = self.of(other, may_be_none=True)
            is_unknown = not (excluded.alike or other.key or excluded.is_person or other.attributes)
            if is_unknown and not other.noun.endswith(("one", "ones")):
                meaning.doubts.append(f"'{other.noun}' is not known")
            if not excluded.names and not other.places and (excluded.alike or not other.key):
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
            and not (phrase.amount.is_other or phrase.amount.is_same)
        ):
            labelled = self._nouns.exact.get(phrase.key, {})
            exact = [name for name in names if name in labelled] or [
                name for name in names if self._index.is_exact_match(name, phrase.key, "english")
            ]
            names = exact or names
        if phrase.superlative and names and not is_open:
            ordered = self._ordered(names, phrase)
            meaning.is_unordered, names = ordered is None, names if ordered is None else ordered
            if self._is_beyond(phrase, names):
                if not may_be_none:
                    meaning.doubts.append(
                        f"'{text}': there {'is' if len(names) == 1 else 'are'} only {len(names)}"
                    )
                names = []
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
            and ((phrase.of or phrase.owner) is None or len(names) == len(meaning.alike))
            and (not phrase.superlative or phrase.noun in ("one", "ones"))
        ) or (is_any and wants_one and len(meaning.names) > 1):
            meaning.names = ()
        meaning.description = self._description(phrase, names or meaning.alike, relations, is_any)
        if phrase.asked:
            meaning.verdicts = self.verdicts(phrase, meaning.names)
        return meaning

    def _is_beyond(self, phrase: NounPhrase, names: Sequence[str]) -> bool:
        """Return whether there are fewer things than an ordinal counts: the THIRD of two laptops."""
        ordinal = phrase.superlative.partition(" from ")[0]  # the second from the left
        number = int(self._nouns.describing.sense(tuple(ordinal.split())).get("ordinals", 0))
        return abs(number) > len(names) > 0

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

    def _without(self, names: list[str], quality: Quality, phrase: NounPhrase, meaning: Meaning) -> list[str]:
        """Return the things that do not have a quality: the apple that is not red."""
        described = Description(phrase.noun, "noun", phrase.key, phrase.noun)
        left = [n for n in names if not self._resolver.fits(n, quality, described, tuple(names), Scope())]
        if not left:
            meaning.doubts.append(f"no {self._noun(phrase)} is known that is not {quality.text}")
        return left

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
                said = f"{by.noun} {phrase.noun}" if by.first < phrase.head else by.noun
                meaning.doubts.append(f"'{said}': the owner is not known")
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
        if not names or self._is_home(place.other):
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
            attributes=(*phrase.attributes, *phrase.asked),
            relation=tuple(
                self._relation(place, others) for place, others in relations[: len(phrase.places)]
            ),
            superlative=phrase.superlative,
            purpose=phrase.purpose,
            owner="" if phrase.owner is None else self._t.between(phrase.owner.first, phrase.owner.end),
            excluded=tuple(self._t.between(other.first, other.end) for other in phrase.excluded),
        )
