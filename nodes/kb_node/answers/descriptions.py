"""Short descriptions of the map, a place or an object: the command `tell`."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence, Set

from semmap.nodes.kb_node.answers import answers
from semmap.nodes.kb_node.answers.entity_queries import CurrentState
from semmap.nodes.kb_node.answers.inventories import LARGEST, Inventories, Nouns
from semmap.nodes.kb_node.answers.map_states import MapState, PastState, PresentState
from semmap.nodes.kb_node.answers.sightings import Sightings
from semmap.nodes.kb_node.entities.class_table import ClassTable
from semmap.nodes.kb_node.relations.selection import resolve_single
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.storage.history import HistoryReader
from semmap.nodes.language import nouns
from semmap.nodes.language.generation import summary
from semmap.nodes.language.generation.inventory import Inventory
from semmap.nodes.language.generation.summary import Summary
from semmap.nodes.language.vocabulary import to_words
from semmap.ontology.model_shapes import own_size_m
from semmap.schemas import errors, language
from semmap.schemas.commands import Tell
from semmap.schemas.entities import Entity, PropertyInfo, Stated, Value
from semmap.schemas.joints import JOINT_POSITIONS, SWITCH_POSITIONS
from semmap.schemas.relations import Relation

_MOST_LABELS = 5
_LONGEST_LABEL = 12
"""The number of words of a label that a description quotes, so that there is room for the other facts."""


class Descriptions:
    """Describes the map in words. Owned by the node's thread."""

    def __init__(self, semantic_map: SemanticMap, now: CurrentState, sightings: Sightings) -> None:
        self._map = semantic_map
        self._now = now
        self._sightings = sightings
        self._state = PresentState(semantic_map)
        self._named: tuple[ClassTable, Nouns] | None = None
        self._whole: tuple[int, Inventory] | None = None

    def describe(self, query: Tell) -> language.Account:
        """Return a description of the map, a place or an object.

        Raises UnknownName; BadRequest for an ambiguous word.
        """
        entity = None if query.name is None else self._map.entity(self._map.resolve(query.name).name)
        if entity is not None or len(self._map) <= LARGEST:
            self._map.ensure_derived()
        writer = _Writer(
            self._state,
            self.nouns,
            self._rows(),
            denied=self._now.find_denied,
            suppressed=lambda: answers.suppressed_facts(self._map),
            last_seen=self._last_seen,
        )
        if entity is None and len(self._map) <= LARGEST:  # collected once per commit
            if self._whole is None or self._whole[0] != self._map.seq:
                self._whole = (self._map.seq, writer.inventories.whole())
            description = writer.describe_map(self._whole[1], query.words)
        else:
            description = writer.describe(entity, query.words)
        return _account(description, query.words, self._map.seq)

    def past_writer(self) -> Callable[[Sequence[Entity]], _Writer]:
        """Return what makes the writer for a past map, in another thread, from its entities."""
        nouns_, rows, limits = self.nouns, self._rows(), self._map.classes.limits

        def make(entities: Sequence[Entity]) -> _Writer:
            state = PastState(entities, limits)
            return _Writer(
                state,
                nouns_,
                rows,
                denied=lambda: tuple(state.find_denied()),
                suppressed=tuple,
                last_seen=lambda entity: "",
            )

        return make

    @property
    def nouns(self) -> Nouns:
        """The nouns for entities."""
        if self._named is None or self._named[0] is not self._map.classes:
            self._named = (self._map.classes, Nouns(self._map.classes))
        return self._named[1]

    def _rows(self) -> dict[str, PropertyInfo]:
        return {row.name: row for row in self._map.classes.property_table.rows()}

    def _last_seen(self, entity: Entity) -> str:
        """Return a sentence on when an entity was last seen or placed, or an empty text."""
        if self._sightings.is_missing(entity):
            return ""
        text = self._sightings.describe_present(entity).text
        return f"It was {text}." if text.startswith(("placed", "last", "never")) else f"It is {text}."


def describe_past(
    query: Tell, past: HistoryReader, make: Callable[[Sequence[Entity]], _Writer]
) -> language.Account:
    """Return a description of the map as of `query.as_of`, by the present TBox. For any thread.

    Raises UnknownName; BadRequest for an ambiguous word or an invalid time; Refused if there was no map.
    """
    if query.as_of is None:
        raise errors.InternalError("the query has no time")
    seq = past.commit_at(query.as_of)
    entities = past.entities(seq)
    writer = make(entities)
    entity = None if query.name is None else writer.find(resolve_single(entities, query.name))
    return _account(writer.describe(entity, query.words), query.words, seq)


def _account(description: Summary, most_words: int, seq: int) -> language.Account:
    words = description.text.split()  # quoted labels may contain line breaks
    if len(words) > most_words:  # class labels may be that long
        words[most_words - 1 :] = [f"{words[most_words - 1]}…"]
    return language.Account(text=" ".join(words), words=len(words), left_out=description.left_out, commit=seq)


class _Writer:
    """Writes the description of a map, present or past."""

    def __init__(
        self,
        state: MapState,
        nouns: Nouns,
        rows: Mapping[str, PropertyInfo],
        *,
        denied: Callable[[], Collection[Relation]],
        suppressed: Callable[[], Iterable[str]],
        last_seen: Callable[[Entity], str],
    ) -> None:
        """Set up; `rows` are the properties of the TBox by name."""
        self.inventories = Inventories(state, nouns)
        self._state = state
        self._rows = rows
        self._denied = denied
        self._suppressed = suppressed
        self._last_seen = last_seen

    def find(self, name: str) -> Entity | None:
        """Return the entity of that name, or None."""
        return self._state.find(name)

    def describe(self, entity: Entity | None, most_words: int) -> Summary:
        """Return a description of an entity, or of the whole map."""
        if entity is None:
            if len(self._state.entities()) <= LARGEST:
                return self.describe_map(self.inventories.whole(), most_words)
            numbers = self.inventories.numbers()
            return summary.summarize_large_map(numbers, list(self._problems(None)), most_words)
        name, inventory = entity.name, self.inventories.around(entity)
        if entity.place:
            inside = {thing.name for part in inventory.parts_of(name) for thing in inventory.in_place(part)}
            return summary.summarize_place(inventory, name, list(self._problems({*inside, name})), most_words)
        first, last = self._thing_sentences(entity, inventory), self._last_sentences(entity)
        return summary.summarize_thing(inventory, name, first, last, most_words)

    def describe_map(self, inventory: Inventory, most_words: int) -> Summary:
        """Return a description of the whole map by its inventory."""
        return summary.summarize_map(inventory, list(self._problems(None)), most_words)

    def _problems(self, about: Set[str] | None) -> Iterator[str]:
        """Yield a clause on each problem of these entities, or of all."""
        for entity in self._state.entities():
            if entity.conflict and (about is None or entity.name in about):
                yield f"{entity.name}, {entity.conflict}"
        for relation in self._denied():
            if about is None or relation.subject in about:
                yield relation.text
        if about is None:
            yield from self._suppressed()

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
            yield f"It is called {' or '.join(f'“{_shortened(text)}”' for text in called[:_MOST_LABELS])}."
        if troubles := list(self._problems({entity.name})):
            yield f"Problems: {'; '.join(troubles).removeprefix(f'{entity.name}, ')}."
        wrong = {(r.subject, r.relation, r.object) for r in self._denied()}
        properties = {**entity.properties, **self._state.nameless(entity)}
        for property_, stated in properties.items():
            for_programs = property_ in (JOINT_POSITIONS, SWITCH_POSITIONS)
            if not for_programs and (row := self._rows.get(property_)) is not None:
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
        if text := self._last_seen(entity):
            yield text


def _shortened(label: str) -> str:
    """Return the first words of a label, with an ellipsis if there are more."""
    words = label.split()
    if len(words) <= _LONGEST_LABEL and len(label) <= _LONGEST_LABEL * 10:
        return label
    return f"{' '.join(words[:_LONGEST_LABEL])[: _LONGEST_LABEL * 10]}…"


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
