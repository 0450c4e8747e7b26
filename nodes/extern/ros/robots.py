"""The entities that are robots or their parts, and the links that hold objects."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Iterable, Mapping
from typing import Final, NamedTuple

from semmap.schemas.attachments import holder_of, wholes_of
from semmap.schemas.entities import Entity
from semmap.schemas.scenes import Body

_ROBOT: Final = "Robot"


class Grasp(NamedTuple):
    """The part of a robot that holds an object, and the parts that touch it: that one and its own parts."""

    link: str
    touch_links: tuple[str, ...]


class Robots:
    """The robots of a map and their parts."""

    def __init__(self, entities: Mapping[str, Entity], bodies: Mapping[str, Body]) -> None:
        self._entities = entities
        self._parts: dict[str, list[str]] = defaultdict(list)
        for entity in entities.values():
            for whole in wholes_of(entity):
                self._parts[whole].append(entity.name)
        for body in bodies.values():
            if body.part_of and body.part_of not in wholes_of(entities.get(body.name)):
                self._parts[body.part_of].append(body.name)
        whole_robots = {entity.name for entity in entities.values() if _ROBOT in entity.types}
        whole_robots.update(body.name for body in bodies.values() if body.robot)
        self.names: Collection[str] = set(self._with_parts(whole_robots))
        """The names of the robots and their parts."""

    def grasp_of(self, entity: Entity) -> Grasp | None:
        """Return what holds an entity, or None if no robot does.

        An object on a tray that a gripper holds is held by the gripper if it is attached to the tray.
        """
        seen = {entity.name}
        while (holder := holder_of(entity)) and holder not in seen:
            if holder in self.names:
                return Grasp(holder, tuple(self._with_parts([holder])))
            seen.add(holder)
            if (above := self._entities.get(holder)) is None:
                return None
            entity = above
        return None

    def _with_parts(self, names: Iterable[str]) -> list[str]:
        """Return the names, followed by those of all parts."""
        found = dict.fromkeys(sorted(names))
        waiting = list(found)
        while waiting:
            new = [part for part in sorted(self._parts.get(waiting.pop(0), ())) if part not in found]
            found.update(dict.fromkeys(new))
            waiting += new
        return list(found)
