"""The coordinator's view of the map: a snapshot, and the commits since."""

from __future__ import annotations

from collections import ChainMap
from collections.abc import Callable, Collection, Mapping
from operator import attrgetter
from typing import Any, Final, TypeVar

from msgspec import Struct, structs

from semmap.nodes.coordinator.commands.attachment_rules import PoseLookup
from semmap.nodes.coordinator.free_names import FreeNames
from semmap.nodes.coordinator.free_places import FreePlaces
from semmap.nodes.runtime import map_replica
from semmap.nodes.runtime.class_names import ClassNames
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.attachments import holder_of
from semmap.schemas.commands import Add, Batch, Explain
from semmap.schemas.commits import Effects, Snapshot, Transaction
from semmap.schemas.entities import SAME_AS, Entity, Pose, Size, Vector
from semmap.schemas.scenes import Body

_PLACES: Final = ("on", "in_", "next_to", "near", "frame", "place", "from_", "to")
_NAMED: Final = frozenset(("name", "names", "entity", "other", "leave", "viewer", "asker", *_PLACES))
"""The fields of commands that name entities."""
_FEW: Final = 3
"""The maximum number of suggested names."""
C = TypeVar("C", bound=Struct)


class MapView(map_replica.MapReplica[Effects]):
    """The entities and classes of the map by name, with indexes of places, tracked and attached entities."""

    def __init__(self) -> None:
        super().__init__()
        self.classes = ClassNames()
        self.touched: set[str] = set()
        """The names of entities that commits have changed; the reconciler takes them from here."""
        self._places: dict[str, Entity] | None = None
        self.tracked: dict[str, Entity] = {}
        """The tracked entities, by name."""
        self.held: dict[str, Entity] = {}
        """The attached entities, by name."""
        self.primary_names: dict[str, str] = {}
        """The names of entities by their other names, for entities that have several."""
        self.pose_of: PoseLookup = self._committed_pose
        """Returns the current pose of an entity; set to a function that also uses bodies and live poses."""
        self.bodies: Callable[[], Mapping[str, Body]] = dict
        """Returns the bodies of the scene, by name."""
        self.reserve: Callable[[Transaction], Transaction] = lambda transaction: transaction
        """Adds to a transaction the properties that only the scene changes."""
        self._names = FreeNames()
        self._floor: FreePlaces | None = None
        """Created at the first request for a free place."""

    def _committed_pose(self, name: str) -> Pose | None:
        entity = self.entities.get(name)
        return None if entity is None else entity.pose

    def free_name(self, class_name: str) -> str:
        """Return the first free name for an entity of a class."""
        return self._names.name(class_name, ChainMap[str, Any](self.entities, self.primary_names))

    def free_place(self, size_m: Size | None) -> Vector:
        """Return the place nearest to a default position where an object of `size_m` touches nothing."""
        if self._floor is None:
            self._floor = FreePlaces()
            self._floor.touch(self.entities)
        return self._floor.find(self.entities, size_m)

    @property
    def places(self) -> Collection[Entity]:
        """The entities that are places, in no order."""
        if self._places is None:
            self._places = {name: entity for name, entity in self.entities.items() if entity.place}
        return self._places.values()

    def entity(self, name: str) -> Entity:
        """Return the entity of that name. Raises UnknownName with names of that label, or similar ones."""
        if name in self.entities:
            return self.entities[name]
        if labelled := self._labelled(name):
            hint = f"; did you mean {errors.enumerated(labelled[:_FEW])}?"
        else:
            hint = errors.suggestion(name, self.entities, "list")
        raise errors.UnknownName(f"no entity is named '{name}'{hint}")

    def _labelled(self, label: str) -> list[str]:
        """Return the names of the entities with a label or alias, in order; case is ignored."""
        folded = label.casefold()
        return sorted(
            entity.name
            for entity in self.entities.values()
            if any(
                folded == text.casefold()
                for text in (entity.preferred_reference or "", *entity.alternative_references)
            )
        )

    def entities_of(self, class_name: str | None) -> tuple[Entity, ...]:
        """Return the entities, or those of a class (inferred ones included), sorted by name."""
        there = self.entities.values()
        found = list(there) if class_name is None else [e for e in there if class_name in e.types]
        return tuple(sorted(found, key=attrgetter("name")))

    def begin(self, snapshot: Snapshot) -> bool:
        """See `MapReplica.begin`."""
        self._places = None
        self._names, self._floor = FreeNames(), None
        begun = super().begin(snapshot)
        self.tracked = {name: entity for name, entity in self.entities.items() if entity.tracked}
        self.held = {name: entity for name, entity in self.entities.items() if holder_of(entity)}
        self.primary_names = {}
        for entity in self.entities.values():
            self._note_names(entity)
        return begun

    def _note_names(self, entity: Entity) -> None:
        if SAME_AS in entity.properties:
            self.primary_names.update(dict.fromkeys(entity.other_names, entity.name))

    def with_primary_names(self, command: C) -> C:
        """Return a command in which other names and IRIs of entities are replaced by their names in the map.

        `explain` keeps them, because its proof is about the individual that has the name.
        """
        if isinstance(command, Explain):
            return command
        changed: dict[str, object] = {}
        for field in _NAMED.intersection(command.__struct_fields__):
            value = getattr(command, field)
            now: object = value
            if isinstance(value, str):
                now = self._primary_name(value)
            elif isinstance(value, tuple):
                now = tuple(self._primary_name(word) if isinstance(word, str) else word for word in value)
            if now != value:
                changed[field] = now
        if isinstance(command, Batch):
            changed["changes"] = tuple(map(self.with_primary_names, command.changes))
        if isinstance(command, Add):
            changed.pop("name", None)  # the name of a new entity
        return structs.replace(command, **changed) if changed else command

    def _primary_name(self, word: str) -> str:
        if word in self.entities:
            return word
        if ":" in word:
            bare = word.removeprefix("<").removesuffix(">")
            term = v.entity_iri(word[1:]) if word.startswith(":") else v.iri(bare)
            found = self.entities.get(v.entity_name(term))
            if found is not None and found.iri == v.bare(term):
                return found.name
        return self.primary_names.get(word, word)

    def _apply(self, commit: Effects) -> None:
        """See `MapReplica._apply`."""
        super()._apply(commit)
        names = commit.names
        self.touched.update(names)
        if self.primary_names:
            self.primary_names = {n: of for n, of in self.primary_names.items() if of not in names}
        for gone in commit.removed:
            self._names.release(gone.name)
            self.tracked.pop(gone.name, None)
            self.held.pop(gone.name, None)
        for changed in commit.changed:
            self._note_names(changed)
            if changed.tracked:
                self.tracked[changed.name] = changed
            elif changed.name in self.tracked:
                del self.tracked[changed.name]
            if changed.grip_provenance is not None and holder_of(changed):
                self.held[changed.name] = changed
            elif changed.name in self.held:
                del self.held[changed.name]
        if self._floor is not None:
            self._floor.touch(names)
        if self._places is not None:
            for name in names:
                entity = self.entities.get(name)
                if entity is not None and entity.place:
                    self._places[name] = entity
                else:
                    self._places.pop(name, None)
