"""The result of fitting a class's model to a tracked thing. Pure."""

from __future__ import annotations

import math
from dataclasses import dataclass

from semmap.schemas.entities import Pose, Quaternion

_TURNED_RAD = math.radians(8.0)
"""The map is updated if the fitted yaw differs by more."""


@dataclass(frozen=True)
class KnownFit:
    """The class of the fitted model, its score, and the orientation of its frame, if known.

    It is valid while the thing rests. `fold`: rotational symmetry of the model about z.
    """

    class_: str
    score: float
    orientation_wxyz: Quaternion | None
    fold: int

    def turned_from(self, pose: Pose) -> bool:
        """Return whether a pose differs from the fitted yaw by more than the error of a fit."""
        if self.orientation_wxyz is None or self.fold == 0:
            return False
        fitted = Pose(position_m=pose.position_m, orientation_wxyz=self.orientation_wxyz)
        turn = math.remainder(fitted.yaw_rad - pose.yaw_rad, 2.0 * math.pi / self.fold)
        return abs(turn) > _TURNED_RAD
