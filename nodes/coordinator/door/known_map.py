"""What the coordinator knows of the map: a snapshot, and the commits since."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from operator import attrgetter

from semmap.nodes.coordinator.free_names import FreeNames
from semmap.nodes.coordinator.free_places import FreePlaces
from semmap.nodes.coordinator.holding import Where
from semmap.nodes.runtime import map_replica
from semmap.nodes.runtime.class_names import ClassNames
from semmap.schemas import errors
from semmap.schemas.attachments import holder_of
from semmap.schemas.commits import Effects, Snapshot
from semmap.schemas.entities import Entity, Pose, Size, Vector
from semmap.schemas.scenes import Body


class KnownMap(map_replica.MapReplica[Effects]):
    """Besides the entities the classes, and both by name."""

    def __init__(self) -> None:
        super().__init__()
        self.classes = ClassNames()
        self.touched: set[str] = set()
        """The names of the entities that commits touched, for whoever looks after them to take."""
        self._places: dict[str, Entity] | None = None
        self.tracked: dict[str, Entity] = {}
        """The entities that are tracked, by name."""
        self.held: dict[str, Entity] = {}
        """The entities that others hold, by name."""
        self.where: Where = self._said
        """Where an entity is just now; whoever hears of bodies and live poses knows better than the map."""
        self.bodies: Callable[[], Mapping[str, Body]] = dict
        """The bodies of the scene, by name, if there is one."""
        self._names = FreeNames()
        self._floor: FreePlaces | None = None
        """Once somebody asked for a free place."""

    def _said(self, name: str) -> Pose | None:
        entity = self.entities.get(name)
        return None if entity is None else entity.pose

    def free_name(self, class_name: str) -> str:
        """The first name that is free for an entity of a class."""
        return self._names.name(class_name, self.entities)

    def free_place(self, size_m: Size | None) -> Vector:
        """The place nearest to a default position where a thing of `size_m` touches nothing."""
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
        """The entity of that name. Raises UnknownName with the nearest ones."""
        if name in self.entities:
            return self.entities[name]
        raise errors.UnknownName(f"no entity is named '{name}'{errors.did_you_mean(name, self.entities)}")

    def entities_of(self, class_name: str | None) -> tuple[Entity, ...]:
        """The entities, or those of a class by inference, in the order of their names."""
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
        return begun

    def _apply(self, commit: Effects) -> None:
        """See `MapReplica._apply`."""
        super()._apply(commit)
        names = commit.names
        self.touched.update(names)
        for gone in commit.removed:
            self._names.freed(gone.name)
            self.tracked.pop(gone.name, None)
            self.held.pop(gone.name, None)
        for changed in commit.changed:
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
