"""The table of entities: its rows, what is looked for among them, and what is otherwise than it was."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Final, NamedTuple

from msgspec import Struct

from semmap.nodes.extern.phrasing import pose_cells
from semmap.nodes.extern.web.views.whereabouts import Whereabouts
from semmap.schemas.entities import Entity, Pose
from semmap.schemas.scenes import Body

Cells = dict[str, str | float | None]
"""One row, by column; `name` is its key."""

LONGEST: Final = 200
"""Characters of a text that a cell has; the detail of a thing has all of them."""


class Wanted(Struct, frozen=True, kw_only=True):
    """Which entities the table shows; what is empty is no condition, and all must hold.

    `text` is looked for in names, references and classes, word by word, without regard to case. `class_` is
    meant with all that follows: a cup is dishware. `room` and `bearer` are names of entities; `things`,
    unless None, are the only ones shown.
    """

    text: str = ""
    class_: str = ""
    room: str = ""
    bearer: str = ""
    things: frozenset[str] | None = None

    @property
    def words(self) -> str:
        """It in words, empty where everything is wanted."""
        said = (
            (f"“{self.text}”", self.text),
            (f"class {self.class_}", self.class_),
            (f"in {self.room}", self.room),
            (f"on {self.bearer}", self.bearer),
            ("found by words", self.things is not None),
        )
        return ", ".join(words for words, is_said in said if is_said)


class Changes(NamedTuple):
    """From the rows that are shown to those that are to be."""

    add: list[Cells]
    update: list[Cells]
    remove: list[str]


class Table:
    """The rows of a map as it is shown, by the name of the entity."""

    def __init__(
        self,
        entities: Mapping[str, Entity],
        whereabouts: Whereabouts,
        *,
        bodies: Mapping[str, Body] | None = None,
        poses: Mapping[str, Pose] | None = None,
    ) -> None:
        """`bodies` are those of the scene, None where no simulator runs; `poses` are where they are now."""
        self._entities = entities
        self._whereabouts = whereabouts
        self._bodies = bodies
        self._poses = poses or {}
        self._places = {name: entity for name, entity in entities.items() if entity.place}

    def rows(self, wanted: Wanted, among: Collection[str] | None = None) -> dict[str, Cells]:
        """Those that are wanted, of all entities or `among` some names; what is not there has none."""
        words = wanted.text.casefold().split()
        entities = self._entities
        if among is not None:
            entities = {name: entities[name] for name in among if name in entities}
        return {
            name: self.row(entity)
            for name, entity in entities.items()
            if self._is_wanted(entity, wanted, words)
        }

    def row(self, entity: Entity) -> Cells:
        """All cells of one."""
        x, y, z, yaw = pose_cells(entity.pose)
        return {
            "name": entity.name,
            "called": (entity.preferred_reference or "")[:LONGEST],
            "class": entity.class_,
            "room": self._whereabouts.room(entity, self._places),
            "on": self._whereabouts.bearer(entity),
            "x": None if entity.pose is None else float(x),
            "y": None if entity.pose is None else float(y),
            "z": None if entity.pose is None else float(z),
            "yaw": None if entity.pose is None else float(yaw),
            "body": self._body(entity),
        }

    def _is_wanted(self, entity: Entity, wanted: Wanted, words: Collection[str]) -> bool:
        if wanted.things is not None and entity.name not in wanted.things:
            return False
        if wanted.class_ and wanted.class_ not in entity.types and wanted.class_ != entity.class_:
            return False
        if wanted.room and wanted.room not in self._whereabouts.places_of(entity, self._places):
            return False
        if wanted.bearer and wanted.bearer != self._whereabouts.bearer(entity):
            return False
        if not words:
            return True
        said = (entity.name, entity.class_, entity.preferred_reference or "", *entity.alternative_references)
        text = "\n".join(said).casefold()
        return all(word in text for word in words)

    def _body(self, entity: Entity) -> str:
        """The model that its body is made from, and what is special about that."""
        if entity.place:
            return "place"
        if self._bodies is None:
            return entity.model
        body = self._bodies.get(entity.name)
        if body is None:
            return "no body"
        model = body.model or "box"
        return f"{model} (ghost)" if body.ghost else model


def changes(shown: Mapping[str, Cells], wanted: Mapping[str, Cells]) -> Changes:
    """What turns the rows that are shown into the wanted ones."""
    return Changes(
        add=[row for name, row in wanted.items() if name not in shown],
        update=[row for name, row in wanted.items() if name in shown and shown[name] != row],
        remove=[name for name in shown if name not in wanted],
    )


def counted(shown: int, all_: int) -> str:
    """`all 80 entities`, `12 of 80 entities`."""
    if all_ == 0:
        return "the map is empty"
    what = "entity" if all_ == 1 else "entities"
    return f"{all_:,} {what}" if shown == all_ else f"{shown:,} of {all_:,} {what}"
