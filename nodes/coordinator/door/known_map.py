"""What the coordinator knows of the map: a snapshot, and the commits since."""

from __future__ import annotations

from collections.abc import Collection

from nodes.runtime import map_replica
from nodes.runtime.class_names import ClassNames
from schemas import errors
from schemas.commits import Effects, Snapshot
from schemas.entities import Entity


class KnownMap(map_replica.MapReplica[Effects]):
    """Besides the entities the classes, and whether another knowledge base may know less."""

    def __init__(self) -> None:
        super().__init__()
        self.classes = ClassNames()
        self.doubted = False
        self._places: dict[str, Entity] | None = None

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
        known = sorted(self.entities.items())
        return tuple(e for _, e in known if class_name is None or class_name in e.types)

    def doubt(self) -> None:
        """Another knowledge base may know less, after a repair: its snapshot counts, whatever its number."""
        super().doubt()
        self.doubted = True

    def begin(self, snapshot: Snapshot) -> None:
        """Take over a snapshot, unless it is older than what is known and not doubted."""
        if snapshot.seq >= self.seq or self.doubted:
            self.doubted = False
            self._places = None
            super().begin(snapshot)

    def take(self, commit: Effects) -> bool:
        """Show a commit in `entities`. False when a snapshot is needed, because one before it was missed."""
        taken = super().take(commit)
        if self._places is not None:
            for name in commit.names:
                entity = self.entities.get(name)
                if entity is not None and entity.place:
                    self._places[name] = entity
                else:
                    self._places.pop(name, None)
        return taken and not self.doubted
