"""What is different between the moment shown and now."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final, Literal

from msgspec import Struct

from schemas.entities import Entity, Pose, angle_rad, distance_m

_MOVED_M: Final = 0.01
_TURNED_RAD: Final = 0.03


class Difference(Struct, frozen=True):
    """`came`: it is there now, and was not then. `went`: the other way round. `moved`: it was elsewhere."""

    kind: Literal["came", "went", "moved"]
    name: str
    then: Pose | None
    now: Pose | None
    text: str


def differences(then: Mapping[str, Entity], now: Mapping[str, Entity]) -> list[Difference]:
    """By name, of what has a position and is no place."""
    found = []
    for name in sorted(then.keys() | now.keys()):
        was, is_ = then.get(name), now.get(name)
        if any(entity is not None and (entity.place or entity.pose is None) for entity in (was, is_)):
            continue
        before, after = (entity.pose if entity is not None else None for entity in (was, is_))
        if before is None and after is not None:
            found.append(Difference("came", name, None, after, f"{name} came later"))
        elif after is None and before is not None:
            found.append(Difference("went", name, before, None, f"{name} is gone by now"))
        elif before is not None and after is not None and (text := _moved(before, after)):
            found.append(Difference("moved", name, before, after, f"{name} has {text} since"))
    return found


def _moved(before: Pose, after: Pose) -> str:
    distance, angle = distance_m(before, after), angle_rad(before, after)
    if distance > _MOVED_M:
        return f"moved {distance:.2f} m"
    return "turned" if angle > _TURNED_RAD else ""
