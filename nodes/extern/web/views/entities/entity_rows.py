"""Rows of the entity table, the filter for them, and differences between two sets of rows."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Final, NamedTuple

from msgspec import Struct

from semmap.nodes.extern.phrasing import pose_cells
from semmap.nodes.extern.web.views.entities.locations import Locations
from semmap.schemas.entities import Entity
from semmap.schemas.scenes import Body

Cells = dict[str, str | float | None]
"""One row, by column; `name` is its key."""

LONGEST: Final = 200
"""Maximum number of characters in a cell; the details show the whole text."""


class EntityFilter(Struct, frozen=True, kw_only=True):
    """Conditions for the rows of the table. All must hold, and an empty one always does.

    `text` is searched in names, labels, aliases and classes, word by word and without regard to case.
    `class_` includes inferred classes. `room` and `support` are names of entities. Unless it is None,
    `things` restricts the rows to these names.
    """

    text: str = ""
    class_: str = ""
    room: str = ""
    support: str = ""
    things: frozenset[str] | None = None

    @property
    def words(self) -> str:
        """The filter in words; empty if it has no conditions."""
        conditions = (
            (f"“{self.text}”", self.text),
            (f"class {self.class_}", self.class_),
            (f"in {self.room}", self.room),
            (f"on {self.support}", self.support),
            ("search result", self.things is not None),
        )
        return ", ".join(words for words, is_set in conditions if is_set)


class RowChanges(NamedTuple):
    """The changes from the current rows of a table to other rows."""

    add: list[Cells]
    update: list[Cells]
    remove: list[str]


class Table:
    """The rows of a map, by the name of the entity."""

    def __init__(
        self,
        entities: Mapping[str, Entity],
        locations: Locations,
        *,
        bodies: Mapping[str, Body] | None = None,
    ) -> None:
        """`bodies` are those of the scene, or None without a simulator."""
        self._entities = entities
        self._locations = locations
        self._bodies = bodies
        self._places = {name: entity for name, entity in entities.items() if entity.place}

    def rows(self, condition: EntityFilter, among: Collection[str] | None = None) -> dict[str, Cells]:
        """Return the rows that match the filter, of all entities or of those `among` these names."""
        words = condition.text.casefold().split()
        entities = self._entities
        if among is not None:
            entities = {name: entities[name] for name in among if name in entities}
        return {
            name: self.row(entity)
            for name, entity in entities.items()
            if self._matches(entity, condition, words)
        }

    def row(self, entity: Entity) -> Cells:
        """Return the cells of one entity."""
        x, y, z, yaw = pose_cells(entity.pose)
        return {
            "name": entity.name,
            "label": (entity.preferred_reference or "")[:LONGEST],
            "class": entity.class_,
            "room": self._locations.find_room(entity, self._places),
            "on": self._locations.find_support(entity),
            "x": None if entity.pose is None else float(x),
            "y": None if entity.pose is None else float(y),
            "z": None if entity.pose is None else float(z),
            "yaw": None if entity.pose is None else float(yaw),
            "body": self._body(entity),
        }

    def _matches(self, entity: Entity, condition: EntityFilter, words: Collection[str]) -> bool:
        if condition.things is not None and entity.name not in condition.things:
            return False
        if condition.class_ and condition.class_ not in entity.types and condition.class_ != entity.class_:
            return False
        if condition.room and condition.room not in self._locations.find_places(entity, self._places):
            return False
        if condition.support and condition.support != self._locations.find_support(entity):
            return False
        if not words:
            return True
        fields = (
            entity.name,
            entity.class_,
            entity.preferred_reference or "",
            *entity.alternative_references,
        )
        text = "\n".join(fields).casefold()
        return all(word in text for word in words)

    def _body(self, entity: Entity) -> str:
        """Return the model of its body, marked if the body is a ghost."""
        if entity.place:
            return "place"
        if self._bodies is None:
            return entity.model
        body = self._bodies.get(entity.name)
        if body is None:
            return "no body"
        model = body.model or "box"
        return f"{model} (ghost)" if body.ghost else model


def diff_rows(shown: Mapping[str, Cells], wanted: Mapping[str, Cells]) -> RowChanges:
    """Return the changes that turn the rows `shown` into the rows `wanted`."""
    return RowChanges(
        add=[row for name, row in wanted.items() if name not in shown],
        update=[row for name, row in wanted.items() if name in shown and shown[name] != row],
        remove=[name for name in shown if name not in wanted],
    )


def format_count(shown: int, all_: int) -> str:
    """Return `80 entities` or `12 of 80 entities`."""
    if all_ == 0:
        return "the map is empty"
    what = "entity" if all_ == 1 else "entities"
    return f"{all_:,} {what}" if shown == all_ else f"{shown:,} of {all_:,} {what}"
