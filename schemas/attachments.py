"""Who holds what: how a map states that one thing is held by another, and where."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from msgspec import ValidationError, convert

from semmap.schemas.entities import Entity, Pose, rounded

IS_GRASPED_BY: Final = "isGraspedBy"
GRASP_POSE: Final = "graspPose"
"""The properties by which a map states it: by what, and where in the frame of that."""
GRASPING: Final = (IS_GRASPED_BY, GRASP_POSE)
_PART_OF: Final = "isDirectPartOf"
_NUMBERS = 7


def holder_of(entity: Entity) -> str:
    """The name of what holds a thing; "" for nothing."""
    said = entity.properties.get(IS_GRASPED_BY, "")
    if isinstance(said, tuple):  # a TBox of one's own may not call it functional
        said = said[0] if said else ""
    return said if isinstance(said, str) else ""


def grip_of(entity: Entity) -> Pose | None:
    """Where a thing is held, in the frame of its holder; None where that is not stated, or makes no sense."""
    said = entity.properties.get(GRASP_POSE)
    return pose_of_text(said) if isinstance(said, str) else None


def pose_text(grip: Pose) -> str:
    """A pose as a map states it: `x y z qw qx qy qz`, metres and a quaternion."""
    pose = rounded(grip)
    return " ".join(f"{value:g}" for value in (*pose.position_m, *pose.orientation_wxyz))


def pose_of_text(text: str) -> Pose | None:
    """The other way round; None for what is no pose."""
    words = text.split()
    if len(words) != _NUMBERS:
        return None
    try:
        x, y, z, *turn = map(float, words)
        return convert({"position_m": (x, y, z), "orientation_wxyz": tuple(turn)}, Pose)
    except (ValueError, ValidationError):
        return None


def carriers(name: str, entities: Mapping[str, Entity]) -> list[str]:
    """What a thing is held by or part of, and what that is, and so on, the nearest first; never twice."""
    found: list[str] = []
    waiting = [name]
    while waiting:
        entity = entities.get(waiting.pop())
        if entity is None:
            continue
        whole = entity.properties.get(_PART_OF, ())
        wholes = (whole,) if isinstance(whole, str) else whole if isinstance(whole, tuple) else ()
        for above in (holder_of(entity), *(w for w in wholes if isinstance(w, str))):
            if above and above not in found:
                found.append(above)
                waiting.append(above)
    return found
