"""An entity as a file describes it."""

from __future__ import annotations

from msgspec import Struct, field

from schemas.entities import (
    Angle,
    Name,
    Pose,
    Quaternion,
    Size,
    Text,
    Vector,
    orientation_from_yaw,
)
from schemas.errors import BadRequest


class Described(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, omit_defaults=True):
    """One entity of a scene file.

    `at` is the bottom centre [m] in the map frame; `yaw` [rad] or `orientation` (unit quaternion wxyz) turns
    it; `size` is its extent along its own axes [m]; `ref` is what people call it, `alt` what they call it
    too.
    """

    class_: Text = field(name="class")
    name: Name | None = None
    at: Vector | None = None
    yaw: Angle | None = None
    orientation: Quaternion | None = None
    size: Size | None = None
    ref: Text | None = None
    alt: tuple[Text, ...] = ()
    affords: tuple[Text, ...] = ()
    """Affordances, by their names in the TBox: `containing`, `supporting`, ..."""


def pose_of(
    at: Vector, yaw: float | None, orientation: Quaternion | None, before: Pose | None = None
) -> Pose:
    """The pose that is asked for; without an angle the orientation stays as `before`. Raises BadRequest."""
    if yaw is not None and orientation is not None:
        raise BadRequest("give yaw or orientation, not both")
    if yaw is not None:
        return Pose(position_m=at, orientation_wxyz=orientation_from_yaw(yaw))
    try:
        if orientation is not None:
            return Pose(position_m=at, orientation_wxyz=orientation)
    except ValueError as error:
        raise BadRequest(str(error)) from None
    return (
        Pose(position_m=at)
        if before is None
        else Pose(position_m=at, orientation_wxyz=before.orientation_wxyz)
    )
