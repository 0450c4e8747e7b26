"""What is there, in a few words: answers `tell`."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Mapping, Set
from typing import Final

from nodes.kb_node.answers import answers
from nodes.kb_node.answers.sightings import Sightings
from nodes.kb_node.answers.whereabouts import Now
from nodes.kb_node.entities.class_table import ClassTable
from nodes.kb_node.relations.facts.place_facts import Fact
from nodes.kb_node.relations.measuring import measures
from nodes.kb_node.relations.measuring.space import Space
from nodes.kb_node.relations.selection import only_meant
from nodes.kb_node.semantic_map import SemanticMap
from nodes.language import account, nouns
from nodes.language.account import Account
from nodes.language.inventory import How, Inventory, Place, Thing
from nodes.language.vocabulary import spoken
from ontology.model_shapes import own_size_m
from schemas import language
from schemas.commands import Tell
from schemas.entities import Entity, PropertyInfo, Stated, Value
from schemas.relations import RelationName

_HOW: Final[dict[RelationName, How]] = {"isInside": "in", "isOn": "on"}
_SEATS: Final = frozenset(("Chair", "Stool"))
_TABLES: Final = frozenset(("Table", "Desk"))
_PARTS: Final = "hasSubLocation"
_PLAIN: Final = re.compile(r"[^\W\d_]+(?:[ -][^\W\d_]+){0,2}")
_DETERMINERS: Final = frozenset(("a", "an", "the", "my", "your", "his", "her", "its", "our", "their", "this"))


class Accounts:
    """Tells what is there; owned by the node's thread."""

    def __init__(self, semantic_map: SemanticMap, now: Now, sightings: Sightings) -> None:
        self._map = semantic_map
        self._now = now
        self._sightings = sightings
        self._named: tuple[ClassTable, Nouns] | None = None
        self._known: tuple[int, Inventory] | None = None

    def tell(self, query: Tell) -> language.Account:
        """A text of the map, a place or a thing. Raises UnknownName, BadRequest for an ambiguous word."""
        name = query.name
        if name is not None and self._map.find(name) is None:
            name = only_meant(tuple(self._map.entities()), name)
        told = self._told(name, query.words)
        words = len(told.text.split())
        return language.Account(text=told.text, words=words, left_out=told.left_out, commit=self._map.seq)

    def _told(self, name: str | None, most_words: int) -> Account:
        inventory = self._inventory()
        if name is None:
            return account.of_map(inventory, list(self._troubles(None)), most_words)
        entity = self._map.entity(name)
        if entity.place:
            inside = {thing.name for part in inventory.parts_of(name) for thing in inventory.in_place(part)}
            return account.of_place(inventory, name, list(self._troubles({*inside, name})), most_words)
        first, last = self._of_thing(entity, inventory), self._at_last(entity)
        return account.of_thing(inventory, name, first, last, most_words)

    # What there is

    def _inventory(self) -> Inventory:
        """What there is after the last commit, worked out once."""
        if self._known is None or self._known[0] != self._map.seq:
            self._known = (self._map.seq, self._taken())
        return self._known[1]

    def _taken(self) -> Inventory:
        self._map.believe_places()
        space = self._map.places.space()
        entities = {entity.name: entity for entity in self._map.entities()}
        noun = self._nouns().of
        parts = _parts_said(entities.values())
        places = [
            Place(entity.name, noun(entity), parts.get(entity.name) or _around(space, entity.name))
            for entity in entities.values()
            if entity.place
        ]
        left_out = self._map.beliefs.left_out
        things = [self._thing(entity, entities, left_out) for entity in entities.values() if not entity.place]
        return Inventory(things, places)

    def _thing(self, entity: Entity, entities: Mapping[str, Entity], left_out: Set[Fact]) -> Thing:
        at: tuple[How, str] | None = None
        place: str | None = None
        for relation, other in self._map.places.about(entity.name):
            if (entity.name, relation, other) in left_out:
                continue
            if relation in _HOW and at is None:
                at = (_HOW[relation], other)
            elif relation == "isLocatedIn":
                place = other
        if at is None and not _SEATS.isdisjoint(entity.types):
            table = _table_of(self._map.places.space(), entity.name, entities)
            at = None if table is None else ("round", table)
        return Thing(
            entity.name,
            self._nouns().of(entity),
            self._states(entity),
            place,
            at,
            math.prod(entity.size_m or own_size_m(entity.model) or (0.0,)),
            entity.fixed,
        )

    def _nouns(self) -> Nouns:
        if self._named is None or self._named[0] is not self._map.classes:
            self._named = (self._map.classes, Nouns(self._map.classes))
        return self._named[1]

    def _states(self, entity: Entity) -> str:
        """What is so of it by properties such as "is open": `open and switched on`."""
        labels = self._nouns().states
        return nouns.listed(
            [labels[p] for p, is_so in entity.properties.items() if is_so is True and p in labels]
        )

    def _troubles(self, about: Set[str] | None) -> Iterator[str]:
        """What is not as it should be, of these or of all, a clause each."""
        for entity in self._map.entities():
            if entity.conflict and (about is None or entity.name in about):
                yield f"{entity.name}, {entity.conflict}"
        for relation in self._now.denied():
            if about is None or relation.subject in about:
                yield relation.text
        if about is None:
            yield from answers.withheld(self._map)

    # One thing

    def _of_thing(self, entity: Entity, inventory: Inventory) -> Iterator[str]:
        thing = inventory.things[entity.name]
        where = ""
        if thing.at is not None:
            how, other = thing.at
            word = {"round": "at", "on": "on", "in": "in"}[how]
            where += (
                f" {word} the {inventory.things[other].noun} ({other})" if other in inventory.things else ""
            )
        if thing.place in inventory.places:
            where += f" in the {inventory.places[thing.place].noun} ({thing.place})"
        yield f"{entity.name} is {nouns.counted(1, thing.noun)}{where}."
        called = [ref for ref in (entity.preferred_reference, *entity.alternative_references) if ref]
        if called and called != [thing.noun]:
            yield f"It is called {' or '.join(f'“{text}”' for text in called)}."
        if troubles := list(self._troubles({entity.name})):
            yield f"Not as it should be: {'; '.join(troubles).removeprefix(f'{entity.name}, ')}."
        known = {row.name: row for row in self._map.classes.stated.rows()}
        for property_, stated in entity.properties.items():
            if (row := known.get(property_)) is not None:
                yield _stated(row, stated)

    def _at_last(self, entity: Entity) -> Iterator[str]:
        if entity.pose is not None:
            size = entity.size_m or own_size_m(entity.model)
            measures_ = "" if size is None else f" measures {' x '.join(f'{e:g}' for e in size)} m and"
            x, y, z = (round(value, 3) + 0.0 for value in entity.pose.position_m)
            yield f"It{measures_} stands at ({x:g}, {y:g}, {z:g}) m."
        if not self._sightings.is_gone(entity):
            text = self._sightings.there(entity).text
            yield f"It was {text}." if text.startswith(("placed", "last")) else f"It is {text}."


class Nouns:
    """What things are called in a sentence: by their references where these are nouns, else by class."""

    def __init__(self, classes: ClassTable) -> None:
        rows = {row.name: row for row in classes.rows}
        self._labels = {
            name: row.labels.get("en") or row.labels.get("") or spoken(name) for name, row in rows.items()
        }
        self._heads = {
            word.rpartition(" ")[2].lower()
            for row in rows.values()
            for word in (*row.labels.values(), *row.also)
        }
        self.states = {
            row.name: label.removeprefix("is ")
            for row in classes.stated.rows()
            if row.range == ("boolean",) and (label := row.labels.get("en", "")).startswith("is ")
        }
        """Of properties that are true or false, what they say of a thing."""

    def of(self, entity: Entity) -> str:
        """A singular noun phrase without article. What is no such phrase by its looks is not repeated."""
        label = self._labels.get(entity.class_) or spoken(entity.class_)
        reference = (entity.preferred_reference or "").strip()
        if not _PLAIN.fullmatch(reference) or reference.partition(" ")[0].lower() in _DETERMINERS:
            return label
        head = reference.rpartition(" ")[2].lower()
        return reference if head == reference.lower() or head in self._heads else label


def _parts_said(entities: Iterable[Entity]) -> dict[str, str]:
    """Place to the place that it is said to be a part of."""
    found: dict[str, str] = {}
    for entity in entities:
        stated = entity.properties.get(_PARTS, ()) if entity.place else ()
        for part in stated if isinstance(stated, tuple) else (stated,):
            found.setdefault(str(part), entity.name)
    return found


def _around(space: Space, name: str) -> str | None:
    """The smallest place that a place is in, by its extent."""
    solid = space.solids.get(name)
    if solid is None:
        return None
    place = space.whereabouts(solid).place
    return None if place is None or place[0].volume <= solid.volume else place[0].name


def _table_of(space: Space, name: str, entities: Mapping[str, Entity]) -> str | None:
    """The nearest table that a seat is near to."""
    seat = space.solids.get(name)
    around = () if seat is None else space.counted_around(seat, space.limits.near_most_m)
    tables = [
        (made.gap_m, other.name)
        for other in around
        if seat is not None
        and _is_table(entities.get(other.name))
        and (made := measures.near(seat, other, space.limits)) is not None
        and made.holds
    ]
    return min(tables)[1] if tables else None


def _is_table(entity: Entity | None) -> bool:
    return entity is not None and not entity.place and not _TABLES.isdisjoint(entity.types)


def _stated(row: PropertyInfo, stated: Stated) -> str:
    """A property as a sentence: `It is open.`, `Its main color is red.`, `Its serial number is 7.`."""
    label = row.labels.get("en") or spoken(row.name).lower()
    if isinstance(stated, bool) and label.startswith("is "):
        return f"It {label}." if stated else f"It is not {label.removeprefix('is ')}."
    values = nouns.listed(
        [_value(value, row) for value in (stated if isinstance(stated, tuple) else (stated,))]
    )
    if label.startswith("has "):
        what = label.removeprefix("has ")
        several = isinstance(stated, tuple) and len(stated) > 1
        return f"Its {nouns.plural(what) if several else what} {'are' if several else 'is'} {values}."
    is_verb = label.startswith("is ") or (
        " " not in label and re.search(r"[^s]s$", label) and label != "mass"
    )
    return f"It {label} {values}." if is_verb else f"Its {label} is {values}."


def _value(value: Value, row: PropertyInfo) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    return row.values.get(value, value) if isinstance(value, str) else f"{value:g}"
