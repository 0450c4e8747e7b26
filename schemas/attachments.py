"""Attachments: the properties of an entity that is attached to another one."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from msgspec import ValidationError, convert

from semmap.schemas.entities import Entity, Pose, rounded

IS_GRASPED_BY: Final = "isGraspedBy"
GRASP_POSE: Final = "graspPose"
"""The properties of an attachment: the parent entity, and the pose in its frame."""
GRASPING: Final = (IS_GRASPED_BY, GRASP_POSE)
_PART_OF: Final = "isDirectPartOf"
_NUMBERS = 7


def holder_of(entity: Entity) -> str:
    """Return the name of the entity that this one is attached to, or ""."""
    holder = entity.properties.get(IS_GRASPED_BY, "")
    if isinstance(holder, tuple):  # in a custom TBox, the property may not be functional
        holder = holder[0] if holder else ""
    return holder if isinstance(holder, str) else ""


def grip_of(entity: Entity) -> Pose | None:
    """Return the pose in the frame of the parent entity, or None if it is not set or invalid."""
    text = entity.properties.get(GRASP_POSE)
    return pose_of_text(text) if isinstance(text, str) else None


def pose_text(grip: Pose) -> str:
    """Return a pose as a property value: `x y z qw qx qy qz`, metres and a quaternion."""
    pose = rounded(grip)
    return " ".join(f"{value:g}" for value in (*pose.position_m, *pose.orientation_wxyz))


def pose_of_text(text: str) -> Pose | None:
    """Parse a pose in a property value; None for an invalid text."""
    words = text.split()
    if len(words) != _NUMBERS:
        return None
    try:
        x, y, z, *turn = map(float, words)
        return convert({"position_m": (x, y, z), "orientation_wxyz": tuple(turn)}, Pose)
    except (ValueError, ValidationError):
        return None


def wholes_of(entity: Entity | None) -> tuple[str, ...]:
    """Return the names of the entities that this one is asserted to be a direct part of."""
    whole = () if entity is None else entity.properties.get(_PART_OF, ())
    wholes = (whole,) if isinstance(whole, str) else whole if isinstance(whole, tuple) else ()
    return tuple(name for name in wholes if isinstance(name, str))


def carriers(name: str, entities: Mapping[str, Entity]) -> list[str]:
    """Return all entities that a thing is attached to or part of, directly or indirectly, nearest first."""
    found: list[str] = []
    waiting = [name]
    while waiting:
        entity = entities.get(waiting.pop())
        if entity is None:
            continue
        for above in (holder_of(entity), *wholes_of(entity)):
            if above and above not in found:
                found.append(above)
                waiting.append(above)
    return found
