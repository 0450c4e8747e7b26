"""Whether something whose poses come one by one stands still."""

from __future__ import annotations

from semmap.schemas.entities import Pose, angle_rad, distance_m

STILL_S = 1.0
"""So long within a small distance is at rest."""
_STILL_M = 0.02
_STILL_RAD = 0.035


class Rest:
    """A thing is at rest when it has stayed close to one pose, its anchor, for a second.

    Close is 2 cm and 2 degrees: localisation is never quite still.
    """

    def __init__(self, pose: Pose, now_s: float) -> None:
        """It has come to be at `pose`."""
        self.anchor = pose
        self._since_s = now_s

    def take(self, pose: Pose, now_s: float) -> None:
        """It is at `pose` now; times are of one clock [s]."""
        if distance_m(self.anchor, pose) > _STILL_M or angle_rad(self.anchor, pose) > _STILL_RAD:
            self.anchor, self._since_s = pose, now_s

    def holds(self, now_s: float) -> bool:
        """Whether it is at rest."""
        return now_s - self._since_s >= STILL_S
