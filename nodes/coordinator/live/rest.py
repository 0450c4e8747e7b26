"""Detects whether an entity rests, from a sequence of its poses."""

from __future__ import annotations

from semmap.schemas.entities import Pose, angle_rad, distance_m

STILL_S = 1.0
"""An entity within a small distance for this time is at rest."""
_STILL_M = 0.02
_STILL_RAD = 0.035


class Rest:
    """An entity is at rest when it has stayed close to one pose, its anchor, for a second.

    Close means 2 cm and 2 degrees, because localisation is noisy.
    """

    def __init__(self, pose: Pose, now_s: float) -> None:
        """Start with the anchor `pose`."""
        self.anchor = pose
        self._since_s = now_s

    def take(self, pose: Pose, now_s: float) -> None:
        """Take the current pose; all times are of one clock [s]."""
        if distance_m(self.anchor, pose) > _STILL_M or angle_rad(self.anchor, pose) > _STILL_RAD:
            self.anchor, self._since_s = pose, now_s

    def holds(self, now_s: float) -> bool:
        """Return whether the entity is at rest."""
        return now_s - self._since_s >= STILL_S
