"""Where things have come to be, as a change of the map that takes its turn among the others."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple

from schemas.commits import Edit, Statement
from schemas.entities import Entity, Pose, Source
from schemas.joints import IS_OPEN, JOINT_POSITIONS, OPEN_FROM, OPENNESS, Joint, openness, positions_text

_DIGITS = 3


class Settled(NamedTuple):
    """The map is to take over where bodies rest (several, if a hand carried them), and how joints stand."""

    poses: Mapping[str, Pose]
    """By name; map frame, metres."""
    after: Mapping[str, tuple[int, int]]
    """By name, the commits that the entity's pose and joints were from when it was looked at; -1 for none.

    An entity of which they are from others by now stays as it is."""
    joints: Mapping[str, tuple[Joint, ...]] = MappingProxyType({})
    """By name, the joints of a body as they stand."""

    source: Source = "scene"
    reason: str = ""
    """Why the map takes them over; without one they came to rest, or a hand put them there."""

    @classmethod
    def of(
        cls,
        entities: Mapping[str, Entity],
        poses: Mapping[str, Pose],
        joints: Mapping[str, tuple[Joint, ...]] = MappingProxyType({}),
        source: Source = "scene",
        reason: str = "",
    ) -> Settled:
        """These entities are at `poses`, and `joints` stand as they do."""
        after = {name: said_by(entities[name]) for name in {**poses, **joints}}
        return cls(poses, after, joints, source, reason)

    @property
    def names(self) -> tuple[str, ...]:
        """The entities that it is about."""
        return tuple({**self.poses, **self.joints})

    def edits(self, entities: Mapping[str, Entity]) -> list[Edit]:
        """What is to change of the entities that nobody has moved, opened or removed meanwhile."""
        return [
            self._edit(name)
            for name in self.names
            if name in entities and said_by(entities[name]) == self.after[name]
        ]

    def _edit(self, name: str) -> Edit:
        pose, joints = self.poses.get(name), self.joints.get(name, ())
        return Edit(
            name=name,
            at=None if pose is None else pose.position_m,
            orientation=None if pose is None else pose.orientation_wxyz,
            set=statements(joints),
        )


def statements(joints: tuple[Joint, ...]) -> tuple[Statement, ...]:
    """What a map states of how joints stand."""
    if not joints:
        return ()
    positions = Statement(property=JOINT_POSITIONS, values=(positions_text(joints),))
    share = openness(joints)
    if share is None:
        return (positions,)
    is_open = str(share > OPEN_FROM).lower()
    return (
        Statement(property=IS_OPEN, values=(is_open,)),
        Statement(property=OPENNESS, values=(f"{round(share, _DIGITS):g}",)),
        positions,
    )


def said_by(entity: Entity) -> tuple[int, int]:
    """The commits that an entity's pose and its joints are from; -1 for what it has not."""
    joints = entity.joint_provenance
    return (
        -1 if entity.pose is None else entity.pose_provenance.commit,
        -1 if joints is None else joints.commit,
    )


def doing(joints: tuple[Joint, ...]) -> str:
    """What has become of a thing whose joints came to stand so: `was closed`, `was opened to 40%`."""
    share = openness(joints)
    if share is None:
        return f"stands at {positions_text(joints)}"
    return f"was opened to {share:.0%}" if share > OPEN_FROM else "was closed"
