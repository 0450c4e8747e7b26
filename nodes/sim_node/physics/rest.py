"""Detects which bodies are at rest."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.sim_node.bodies import Floats, Ints

STILL_M = 0.001
STILL_RAD = 0.005
STILL_S = 0.3
"""A body rests if it stayed within both tolerances for this time."""

ASLEEP_S = 0.1
"""A sleeping body rests after this time, so that subscribers see that it moved."""


class RestDetector:
    """Rest detection of N bodies: each is compared with the pose at which it last moved."""

    def __init__(self, poses: Floats, time_s: float) -> None:
        self._anchor = poses.copy()
        self._since_s = np.full(len(poses), time_s)

    def carried_over(self, poses: Floats, time_s: float, before: Ints) -> RestDetector:
        """Return a detector for other bodies at `poses`; `before` (M,) is the row of each here, or -1."""
        watch, known = RestDetector(poses, time_s), before >= 0
        watch._anchor[known], watch._since_s[known] = (
            self._anchor[before[known]],
            self._since_s[before[known]],
        )
        return watch

    def update(self, poses: Floats, time_s: float, asleep: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Return (N,) which bodies rest at `time_s`, given their poses (N, 7) and which are asleep."""
        step = np.linalg.norm(poses[:, :3] - self._anchor[:, :3], axis=1)
        cosine = np.abs(np.sum(poses[:, 3:] * self._anchor[:, 3:], axis=1))
        turn = 2.0 * np.arccos(np.minimum(1.0, cosine))
        moved = (step > STILL_M) | (turn > STILL_RAD)
        self._anchor[moved] = poses[moved]
        self._since_s[moved] = time_s
        return np.asarray(time_s - self._since_s >= np.where(asleep, ASLEEP_S, STILL_S))

    def disturb(self, rows: list[int], time_s: float) -> None:
        """Restart the detection of these bodies, which were moved."""
        self._since_s[rows] = time_s


class JointRestDetector:
    """Rest detection of J joints: each is compared with the position at which it last moved."""

    def __init__(self, positions: Floats, time_s: float) -> None:
        """Start at `positions` (J,) [rad, m]."""
        self._anchor = positions.copy()
        self._since_s = np.full(len(positions), time_s)

    def update(self, positions: Floats, time_s: float) -> NDArray[np.bool_]:
        """Return (J,) which joints rest at `time_s`."""
        moved = np.abs(positions - self._anchor) > STILL_M
        self._anchor[moved] = positions[moved]
        self._since_s[moved] = time_s
        return np.asarray(time_s - self._since_s >= ASLEEP_S)

    def arrive(self, rows: list[int], positions: Floats, time_s: float) -> None:
        """Mark joints that reached their target as resting."""
        self._anchor[rows] = positions[rows]
        self._since_s[rows] = time_s - ASLEEP_S

    def disturb(self, rows: list[int], time_s: float) -> None:
        """Restart the detection of these joints, which were moved."""
        self._since_s[rows] = time_s
