"""What fitting its class's model told of a thing that is tracked. Pure."""

from __future__ import annotations

import math
from dataclasses import dataclass

from semmap.schemas.entities import Pose, Quaternion

_TURNED_RAD = math.radians(8.0)
"""A fitted yaw that differs from the map's by more is told."""


@dataclass(frozen=True)
class KnownFit:
    """Of which class the model was, how well it fits, and what its frame is turned by, if that is known.

    It holds while the thing rests. `fold` turns of the model about its own z look the same.
    """

    class_: str
    score: float
    orientation_wxyz: Quaternion | None
    fold: int

    def turned_from(self, pose: Pose) -> bool:
        """Whether a pose has the thing turned by more than what a fit is off by."""
        if self.orientation_wxyz is None or self.fold == 0:
            return False
        fitted = Pose(position_m=pose.position_m, orientation_wxyz=self.orientation_wxyz)
        turn = math.remainder(fitted.yaw_rad - pose.yaw_rad, 2.0 * math.pi / self.fold)
        return abs(turn) > _TURNED_RAD
