"""Where things have come to be, as a change of the map that takes its turn among the others."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from schemas.entities import Entity, Pose, Source


class Settled(NamedTuple):
    """The map is to take over where a body rests, or where those rest that a hand carried together."""

    poses: Mapping[str, Pose]
    """By name; map frame, metres."""
    after: Mapping[str, int]
    """By name, the commit that the entity's pose was from when the body was looked at; -1 for none.

    An entity whose pose is from another one by now stays where it is."""

    source: Source = "scene"
    reason: str = ""
    """Why the map takes them over; without one they came to rest, or a hand put them there."""

    @classmethod
    def of(
        cls,
        entities: Mapping[str, Entity],
        poses: Mapping[str, Pose],
        source: Source = "scene",
        reason: str = "",
    ) -> Settled:
        """These entities are at `poses`."""
        return cls(poses, {name: posed_by(entities[name]) for name in poses}, source, reason)

    def still(self, entities: Mapping[str, Entity]) -> dict[str, Pose]:
        """The poses of the entities that nobody has moved or removed meanwhile."""
        return {
            name: pose
            for name, pose in self.poses.items()
            if name in entities and posed_by(entities[name]) == self.after[name]
        }


def posed_by(entity: Entity) -> int:
    """The commit that an entity's pose is from; -1 without one."""
    return -1 if entity.pose is None else entity.pose_provenance.commit
