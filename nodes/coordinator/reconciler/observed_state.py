"""Observed states of bodies, as a change of the map that is scheduled like a command."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple

from semmap.nodes.coordinator.commands.transactions import grip_statements
from semmap.schemas.commits import Edit, Statement
from semmap.schemas.entities import Entity, Pose, Size, Source
from semmap.schemas.joints import (
    IS_OPEN,
    IS_SWITCHED_ON,
    JOINT_POSITIONS,
    OPEN_FROM,
    OPENNESS,
    SWITCH_POSITIONS,
    Joint,
    is_on,
    openness,
    positions_text,
    wanted,
)

_DIGITS = 3
_STAYED = 0.005
"""A joint that moved less than this has not changed [rad, m]."""


class ObservedState(NamedTuple):
    """Poses of bodies at rest (several if moved together), joint positions and attachments to commit."""

    poses: Mapping[str, Pose]
    """By name; map frame, metres."""
    after: Mapping[str, tuple[int, int, int]]
    """By name, the commits of pose, joints and attachment when they were compared; -1 for none.

    Entities that were changed since are not committed.
    """
    joints: Mapping[str, tuple[Joint, ...]] = MappingProxyType({})
    """By name, the joints of a body."""

    source: Source = "scene"
    grips: Mapping[str, tuple[str, Pose | None]] = MappingProxyType({})
    """By name, the holder of a body ("" for none) and the pose in the holder's frame."""
    sizes_m: Mapping[str, Size] = MappingProxyType({})
    reason: str = ""
    """The reason of the commit; by default the bodies came to rest or were moved manually."""

    @classmethod
    def of(
        cls,
        entities: Mapping[str, Entity],
        poses: Mapping[str, Pose],
        joints: Mapping[str, tuple[Joint, ...]] = MappingProxyType({}),
        source: Source = "scene",
        reason: str = "",
        grips: Mapping[str, tuple[str, Pose | None]] = MappingProxyType({}),
        sizes_m: Mapping[str, Size] = MappingProxyType({}),
    ) -> ObservedState:
        """Create it from the observed poses, joints, attachments and sizes of these entities."""
        after = {name: commits_of(entities[name]) for name in {**poses, **joints, **grips, **sizes_m}}
        return cls(poses, after, joints, source, grips, sizes_m, reason)

    @property
    def names(self) -> tuple[str, ...]:
        """The entities it is about, first those whose joints moved others."""
        return tuple({**self.joints, **self.poses, **self.grips, **self.sizes_m})

    def edits(self, entities: Mapping[str, Entity]) -> list[Edit]:
        """Return the edits of the entities that were not changed or removed since."""
        return [
            self._edit(name)
            for name in self.names
            if name in entities and commits_of(entities[name]) == self.after[name]
        ]

    def _edit(self, name: str) -> Edit:
        pose, joints = self.poses.get(name), self.joints.get(name, ())
        holder, grip = self.grips.get(name, (None, None))
        return Edit(
            name=name,
            at=None if pose is None else pose.position_m,
            orientation=None if pose is None else pose.orientation_wxyz,
            size=self.sizes_m.get(name),
            unset=grip_statements("", None) if holder == "" else (),
            set=(*joint_statements(joints), *(grip_statements(holder, grip) if holder else ())),
        )


def joint_statements(joints: tuple[Joint, ...]) -> tuple[Statement, ...]:
    """Return the statements about joint positions."""
    switches = tuple(joint for joint in joints if joint.switches)
    others = tuple(joint for joint in joints if not joint.switches)
    found = []
    if (share := openness(others)) is not None:
        found.append(Statement(property=IS_OPEN, values=(str(share > OPEN_FROM).lower(),)))
        found.append(Statement(property=OPENNESS, values=(f"{round(share, _DIGITS):g}",)))
    if others:
        found.append(Statement(property=JOINT_POSITIONS, values=(positions_text(others),)))
    if switches:
        found.append(Statement(property=IS_SWITCHED_ON, values=(str(is_on(switches)).lower(),)))
        found.append(Statement(property=SWITCH_POSITIONS, values=(positions_text(switches),)))
    return tuple(found)


def commits_of(entity: Entity) -> tuple[int, int, int]:
    """Return the commits of an entity's pose, joints and attachment; -1 for each that it does not have."""
    joints, grip = entity.joints_said, entity.grip_provenance
    return (
        -1 if entity.pose is None else entity.pose_provenance.commit,
        -1 if joints is None else joints.commit,
        -1 if grip is None else grip.commit,
    )


def describe_joint_change(
    joints: tuple[Joint, ...], before: Mapping[str, object] = MappingProxyType({})
) -> str:
    """Return in words what changed of joints: `was closed`, `was switched on`.

    `before` has the previous statements of the map; only changes are described.
    """
    was = wanted(joints, before)
    moved = [j for j in joints if abs(j.position - was.get(j.name, j.initial)) > _STAYED]
    described = moved or joints
    switched = [joint for joint in described if joint.switches]
    others = tuple(joint for joint in described if not joint.switches)
    share = openness(joints)
    words = []
    if others and share is None:
        words.append(f"stands at {positions_text(others)}")
    elif others and share is not None:
        words.append(f"was opened to {share:.0%}" if share > OPEN_FROM else "was closed")
    if switched:
        on = is_on(joints)
        turned = on == before.get(IS_SWITCHED_ON, False) and moved
        words.append(f"has {positions_text(switched)}" if turned else f"was switched {'on' if on else 'off'}")
    return " and ".join(words)
