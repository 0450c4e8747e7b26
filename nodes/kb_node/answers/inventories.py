"""The objects and places of a map with their nouns and supports, for descriptions."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Set
from typing import Final

from semmap.nodes.kb_node.answers.map_states import MapState
from semmap.nodes.kb_node.entities.class_table import ClassTable
from semmap.nodes.kb_node.relations.facts.place_facts import Fact
from semmap.nodes.kb_node.relations.measuring import proximity
from semmap.nodes.language import nouns
from semmap.nodes.language.generation.inventory import How, Inventory, Place, Thing
from semmap.nodes.language.vocabulary import to_words
from semmap.ontology.model_shapes import own_size_m
from semmap.schemas.entities import Entity
from semmap.schemas.relations import RelationName

LARGEST: Final = 10_000
"""For larger maps only numbers are described, because more takes a quarter of a second."""
_HOW: Final[dict[RelationName, How]] = {"isInside": "in", "isOn": "on"}
_SEATS: Final = frozenset(("Chair", "Stool"))
_TABLES: Final = frozenset(("Table", "Desk"))
_PARTS: Final = "hasSubLocation"
_PLAIN: Final = re.compile(r"[^\W\d_]+(?:[ -][^\W\d_]+){0,2}")
_NO_NAMES: Final = frozenset(("nothing", "something", "anything", "none", "it"))
_DETERMINERS: Final = frozenset(("a", "an", "the", "my", "your", "his", "her", "its", "our", "their", "this"))


class Inventories:
    """Collects objects and places of a map for descriptions. For one thread."""

    def __init__(self, state: MapState, nouns: Nouns) -> None:
        self._state = state
        self.nouns = nouns

    def whole(self) -> Inventory:
        """Return all objects and places."""
        return self._of(self._state.entities())

    def numbers(self) -> Inventory:
        """Return all objects and places without locations."""
        noun = self.nouns.of
        entities = self._state.entities()
        return Inventory(
            (
                Thing(entity.name, noun(entity), kind=self.nouns.kind(entity))
                for entity in entities
                if not entity.place
            ),
            (Place(entity.name, noun(entity)) for entity in entities if entity.place),
        )

    def around(self, entity: Entity) -> Inventory:
        """Return the contents of a place and its parts, or an object with what surrounds it."""
        names = {entity.name, *(other for _, other in self._state.about(entity.name))}
        space = self._state.space()
        if _is_table(entity) and (solid := space.solids.get(entity.name)) is not None:
            names.update(other.name for other in space.counted_around(solid, space.limits.near_most_m))
        if entity.place:
            places = Inventory((), self._places())
            names |= set(places.parts_of(entity.name))
        found = filter(None, map(self._state.find, sorted(self._state.with_supported(names))))
        return self._of(found)

    def _of(self, entities: Iterable[Entity]) -> Inventory:
        left_out = self._state.left_out()
        things = [self._thing(entity, left_out) for entity in entities if not entity.place]
        return Inventory(things, self._places())

    def _places(self) -> Iterator[Place]:
        """Yield all places; their names distinguish them."""
        places = [entity for entity in self._state.entities() if entity.place]
        parts = _parts_said(places)
        for place in places:
            yield Place(place.name, self.nouns.of(place), parts.get(place.name))

    def _thing(self, entity: Entity, left_out: Set[Fact]) -> Thing:
        at: tuple[How, str] | None = None
        place: str | None = None
        for relation, other in self._state.about(entity.name):
            if (entity.name, relation, other) in left_out:
                continue
            if relation in _HOW and at is None:
                at = (_HOW[relation], other)
            elif relation == "isLocatedIn":
                place = other
        if at is None and (table := self._table_of(entity)) is not None:
            at = ("round", table)
        return Thing(
            entity.name,
            self.nouns.of(entity),
            self._states(entity),
            place,
            at,
            math.prod(entity.size_m or own_size_m(entity.model) or (0.0,)),
            entity.fixed,
            self.nouns.kind(entity),
        )

    def _table_of(self, entity: Entity) -> str | None:
        """Return the nearest table of a seat."""
        space = self._state.space()
        if _SEATS.isdisjoint(entity.types) or (solid := space.solids.get(entity.name)) is None:
            return None
        tables = [
            (made.gap_m, other.name)
            for other in space.counted_around(solid, space.limits.near_most_m)
            if _is_table(self._state.find(other.name))
            and (made := proximity.near(solid, other, space.limits)) is not None
            and made.holds
        ]
        return min(tables)[1] if tables else None

    def _states(self, entity: Entity) -> str:
        """Return the states of an entity from properties such as "is open": `open and switched on`."""
        labels = self.nouns.states
        stated = entity.properties.items()
        return nouns.enumerate_nouns([labels[p] for p, is_so in stated if is_so is True and p in labels])


def _is_table(entity: Entity | None) -> bool:
    return entity is not None and not entity.place and not _TABLES.isdisjoint(entity.types)


def _parts_said(entities: Iterable[Entity]) -> dict[str, str]:
    """Return by place which place it is stated to be part of."""
    found: dict[str, str] = {}
    for entity in entities:
        stated = entity.properties.get(_PARTS, ()) if entity.place else ()
        for part in stated if isinstance(stated, tuple) else (stated,):
            found.setdefault(str(part), entity.name)
    return found


class Nouns:
    """Nouns for entities: their label if it is a noun, else their class."""

    def __init__(self, classes: ClassTable) -> None:
        rows = {row.name: row for row in classes.rows}
        self._labels = {
            name: _uncapitalized(row.labels.get("en") or row.labels.get("") or to_words(name))
            for name, row in rows.items()
        }
        self._heads = {
            word.rpartition(" ")[2].lower()
            for row in rows.values()
            for word in (*row.labels.values(), *row.also)
        }
        self.states = {
            row.name: label.removeprefix("is ")
            for row in classes.property_table.rows()
            if row.range == ("boolean",) and (label := row.labels.get("en", "")).startswith("is ")
        }
        """Adjectives for boolean properties."""

    def kind(self, entity: Entity) -> str:
        """Return the name of an entity's class."""
        return self._labels.get(entity.class_) or to_words(entity.class_)

    def of(self, entity: Entity) -> str:
        """Return a singular noun phrase without article; labels that are not noun phrases are not used.

        A label in title case is a proper name, unless it ends in a known noun. Then it is returned in lower
        case.
        """
        label = self.kind(entity)
        reference = (entity.preferred_reference or "").strip()
        if not _PLAIN.fullmatch(reference) or reference.partition(" ")[0].lower() in _DETERMINERS:
            return label
        head = reference.rpartition(" ")[2].lower()
        if head in self._heads:
            return reference.lower() if reference.istitle() else reference
        return reference if head == reference.lower() and head not in _NO_NAMES else label


def _uncapitalized(label: str) -> str:
    """Return the label of a class as a common noun: `designed handle` for `Designed handle`."""
    is_capitalized = label[:1].isupper() and (label.istitle() or label[1:] == label[1:].lower())
    return label.lower() if is_capitalized and len(label) > 1 else label
