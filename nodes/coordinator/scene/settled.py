"""A body that came to rest elsewhere, as a change of the map that takes its turn among the others."""

from __future__ import annotations

from typing import NamedTuple

from schemas.entities import Entity, Pose


class Settled(NamedTuple):
    """The map is to take over where the body `name` rests, unless its pose has changed since `after`."""

    name: str
    pose: Pose
    """Map frame, metres."""
    after: int
    """The commit that the entity's pose was from when the body was looked at; -1 for none."""

    @classmethod
    def of(cls, entity: Entity, pose: Pose) -> Settled:
        """The body of `entity` rests at `pose`."""
        return cls(entity.name, pose, posed_by(entity))


def posed_by(entity: Entity) -> int:
    """The commit that an entity's pose is from; -1 without one."""
    return -1 if entity.pose is None else entity.pose_provenance.commit
