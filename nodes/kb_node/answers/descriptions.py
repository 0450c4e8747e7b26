"""Short descriptions of the map, a place or an object: the command `tell`."""

from __future__ import annotations

import re
from collections.abc import Iterator, Set

from semmap.nodes.kb_node.answers import answers
from semmap.nodes.kb_node.answers.entity_queries import CurrentState
from semmap.nodes.kb_node.answers.inventories import LARGEST, Inventories
from semmap.nodes.kb_node.answers.sightings import Sightings
from semmap.nodes.kb_node.entities.equal_individuals import about_entity
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.language import nouns
from semmap.nodes.language.generation import summary
from semmap.nodes.language.generation.inventory import Inventory
from semmap.nodes.language.generation.summary import Summary
from semmap.nodes.language.vocabulary import to_words
from semmap.ontology import vocabulary as v
from semmap.ontology.model_shapes import own_size_m
from semmap.schemas import language
from semmap.schemas.commands import Tell
from semmap.schemas.entities import Entity, PropertyInfo, Stated, Value
from semmap.schemas.joints import JOINT_POSITIONS, SWITCH_POSITIONS


class Descriptions:
    """Describes the map in words. Owned by the node's thread."""

    def __init__(self, semantic_map: SemanticMap, now: CurrentState, sightings: Sightings) -> None:
        self._map = semantic_map
        self._now = now
        self._sightings = sightings
        self._inventories = Inventories(semantic_map)

    def describe(self, query: Tell) -> language.Account:
        """Return a description of the map, a place or an object.

        Raises UnknownName; BadRequest for an ambiguous word.
        """
        name = None if query.name is None else self._map.resolve(query.name).name
        description = self._describe(name, query.words)
        words = description.text.split()  # quoted labels may contain line breaks
        if len(words) > query.words:  # class labels may be that long
            words[query.words - 1 :] = [f"{words[query.words - 1]}…"]
        return language.Account(
            text=" ".join(words), words=len(words), left_out=description.left_out, commit=self._map.seq
        )

    def _describe(self, name: str | None, most_words: int) -> Summary:
        if name is None:
            is_large = len(self._map) > LARGEST
            inventory = self._inventories.numbers() if is_large else self._inventories.whole()
            tell = summary.summarize_large_map if is_large else summary.summarize_map
            return tell(inventory, list(self._problems(None)), most_words)
        entity = self._map.entity(name)
        inventory = self._inventories.around(entity)
        if entity.place:
            inside = {thing.name for part in inventory.parts_of(name) for thing in inventory.in_place(part)}
            return summary.summarize_place(inventory, name, list(self._problems({*inside, name})), most_words)
        first, last = self._thing_sentences(entity, inventory), self._last_sentences(entity)
        return summary.summarize_thing(inventory, name, first, last, most_words)

    def _problems(self, about: Set[str] | None) -> Iterator[str]:
        """Yield a clause on each problem of these entities, or of all."""
        for entity in self._map.entities():
            if entity.conflict and (about is None or entity.name in about):
                yield f"{entity.name}, {entity.conflict}"
        for relation in self._now.find_denied():
            if about is None or relation.subject in about:
                yield relation.text
        if about is None:
            yield from answers.suppressed_facts(self._map)

    # One object

    def _thing_sentences(self, entity: Entity, inventory: Inventory) -> Iterator[str]:
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
        yield f"{entity.name} is {nouns.with_count(1, thing.noun)}{where}."
        called = [ref for ref in (entity.preferred_reference, *entity.alternative_references) if ref]
        if called and called != [thing.noun]:
            yield f"It is called {' or '.join(f'“{text}”' for text in called)}."
        if troubles := list(self._problems({entity.name})):
            yield f"Problems: {'; '.join(troubles).removeprefix(f'{entity.name}, ')}."
        wrong = {(r.subject, r.relation, r.object) for r in self._now.find_denied()}
        known = {row.name: row for row in self._map.classes.property_table.rows()}
        iri = v.iri(entity.iri)
        nameless = self._map.classes.property_table.read_nameless(about_entity(self._map.reasoner, iri), iri)
        for property_, stated in {**entity.properties, **nameless}.items():
            for_programs = property_ in (JOINT_POSITIONS, SWITCH_POSITIONS)
            if not for_programs and (row := known.get(property_)) is not None:
                values = stated if isinstance(stated, tuple) else (stated,)
                left = tuple(value for value in values if (entity.name, property_, value) not in wrong)
                if left:
                    yield _stated(row, left if len(left) > 1 else left[0])

    def _last_sentences(self, entity: Entity) -> Iterator[str]:
        if entity.pose is not None:
            size = entity.size_m or (own_size_m(entity.model) if entity.model else None)
            measures_ = "" if size is None else f" measures {' x '.join(f'{e:g}' for e in size)} m and"
            x, y, z = (round(value, 3) + 0.0 for value in entity.pose.position_m)
            yield f"It{measures_} stands at ({x:g}, {y:g}, {z:g}) m."
        if not self._sightings.is_missing(entity):
            text = self._sightings.describe_present(entity).text
            yield f"It was {text}." if text.startswith(("placed", "last", "never")) else f"It is {text}."


def _stated(row: PropertyInfo, stated: Stated) -> str:
    """Return a property as a sentence: `It is open.`, `Its main color is red.`, `Its serial number is 7.`."""
    label = row.labels.get("en") or to_words(row.name).lower()
    if isinstance(stated, bool) and label.startswith("is "):
        return f"It {label}." if stated else f"It is not {label.removeprefix('is ')}."
    values = nouns.enumerate_nouns(
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
