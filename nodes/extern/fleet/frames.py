"""The poses of the robots' maps in the common fleet frame."""

from __future__ import annotations

import math
from collections.abc import Iterable

from msgspec import Struct

from semmap.schemas import errors
from semmap.schemas.endpoints import robot_name
from semmap.schemas.entities import Pose, Quaternion

_EXAMPLE = "robot1=12.5,3,0,1.57"


class Frame(Struct, frozen=True):
    """The pose of a robot's map frame in the fleet frame: position [m] and yaw [rad]; both have z up."""

    x: float
    y: float
    z: float
    yaw: float

    def pose(self, pose: Pose) -> Pose:
        """Transform a pose from the map frame to the fleet frame."""
        x, y, z = pose.position_m
        cos, sin = math.cos(self.yaw), math.sin(self.yaw)
        position = (self.x + cos * x - sin * y, self.y + sin * x + cos * y, self.z + z)
        return Pose(position_m=position, orientation_wxyz=self._rotate(pose.orientation_wxyz))

    def _rotate(self, q: Quaternion) -> Quaternion:
        w, x, y, z = q
        c, s = math.cos(self.yaw / 2), math.sin(self.yaw / 2)
        return (c * w - s * z, c * x - s * y, c * y + s * x, c * z + s * w)


def read(words: Iterable[str]) -> dict[str, Frame]:
    """Parse texts like `robot1=X,Y,Z,YAW` to frames by robot. Raises BadRequest."""
    return dict(map(_read, words))


def _read(word: str) -> tuple[str, Frame]:
    robot, _, numbers = word.partition("=")
    try:
        x, y, z, yaw = map(float, numbers.split(","))
    except ValueError:
        raise errors.BadRequest(
            f"'{word}' is not ROBOT=X,Y,Z,YAW with the origin in the fleet frame [m] and the yaw [rad];"
            f" example: {_EXAMPLE}"
        ) from None
    if not robot or not all(map(math.isfinite, (x, y, z, yaw))):
        raise errors.BadRequest(f"'{word}' is not ROBOT=X,Y,Z,YAW; example: {_EXAMPLE}")
    return robot_name(robot), Frame(x, y, z, yaw)
