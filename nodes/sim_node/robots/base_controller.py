"""Controller of mobile bases, which uses the velocity actuators of their models."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, Literal

import mujoco
import numpy as np

from semmap.nodes.sim_node.bodies import BodyIndex
from semmap.schemas.scenes import UPRIGHT

Outcome = Literal["there", "blocked", "fallen", "stopped"]
ACTUATORS: Final = ("drive_x", "drive_y", "drive_yaw")
"""Velocities along and about the base's own axes; their names in the world are `NAME_drive_x` etc."""

_NEAR_M, _PASSED_M, _FAR_M = 0.015, 0.15, 0.3
_TURNED_RAD, _AHEAD_RAD = 0.02, 0.3
"""The base turns towards a far goal before it drives, so that its cameras see the path."""
_TURN_GAIN, _TURN_RAD_S, _GAIN = 2.5, 1.2, 1.6
_STUCK_S, _PROGRESS = 4.0, 0.01


@dataclass
class _DriveCommand:
    points: list[tuple[float, float]]
    yaw_rad: float | None
    speed_m_s: float
    left: float = math.inf
    """The smallest distance to the next point so far [m + rad]."""
    better_s: float = 0.0
    """The simulated time of the smallest distance."""


def actuators(model: mujoco.MjModel, name: str) -> tuple[int, ...]:
    """Return the three actuators of a robot's base; empty if one is missing."""
    found = tuple(
        mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_ACTUATOR, f"{name}_{axis}") for axis in ACTUATORS
    )
    return found if min(found) >= 0 else ()


class BaseController:
    """The active drive commands, by robot. The engine calls `steer` every few steps."""

    def __init__(self) -> None:
        """Start without commands."""
        self._active: dict[str, _DriveCommand] = {}
        self.ended: dict[str, Outcome] = {}
        """Outcomes of ended commands that were not fetched yet."""

    def __bool__(self) -> bool:
        return bool(self._active)

    @property
    def names(self) -> tuple[str, ...]:
        """Return the driving robots."""
        return tuple(self._active)

    @property
    def paths(self) -> dict[str, tuple[tuple[float, float], ...]]:
        """Return the points [m] that each driving robot still has to reach."""
        return {name: tuple(command.points) for name, command in self._active.items()}

    def begin(
        self, name: str, points: Sequence[tuple[float, float]], yaw_rad: float | None, speed_m_s: float
    ) -> None:
        """Drive through these points [m], with the final orientation `yaw_rad`; replaces another command."""
        if name in self._active:
            self.ended[name] = "stopped"
        self._active[name] = _DriveCommand(list(points), yaw_rad, speed_m_s)

    def stop(self, model: mujoco.MjModel, data: mujoco.MjData, name: str, outcome: Outcome) -> None:
        """Stop a robot, if it drives."""
        if self._active.pop(name, None) is not None:
            data.ctrl[list(actuators(model, name))] = 0.0
            self.ended[name] = outcome

    def steer(self, model: mujoco.MjModel, data: mujoco.MjData, index: BodyIndex) -> None:
        """Compute the velocities of all driving robots."""
        for name, command in list(self._active.items()):
            row = index.row.get(name)
            wheels = actuators(model, name)
            if row is None or index.qpos[row] < 0 or not wheels:
                self._active.pop(name)
                self.ended[name] = "blocked"
                continue
            outcome = self._steer(data, index, row, wheels, command)
            if outcome is not None:
                self.stop(model, data, name, outcome)

    def _steer(
        self, data: mujoco.MjData, index: BodyIndex, row: int, wheels: tuple[int, ...], command: _DriveCommand
    ) -> Outcome | None:
        address = int(index.qpos[row])
        x, y, _, qw, qx, qy, qz = data.qpos[address : address + 7].tolist()
        if 1.0 - 2.0 * (qx * qx + qy * qy) < UPRIGHT:
            return "fallen"
        yaw = math.atan2(2.0 * (qw * qz + qx * qy), 1.0 - 2.0 * (qy * qy + qz * qz))
        ox, oy = float(index.origin_m[row][0]), float(index.origin_m[row][1])
        x, y = x + math.cos(yaw) * ox - math.sin(yaw) * oy, y + math.sin(yaw) * ox + math.cos(yaw) * oy
        goal_x, goal_y = command.points[0]
        away_m, heading = math.hypot(goal_x - x, goal_y - y), math.atan2(goal_y - y, goal_x - x)
        is_last = len(command.points) == 1
        if not is_last and away_m < _PASSED_M:
            command.points.pop(0)
            command.left = math.inf
            return None
        is_far = away_m > _FAR_M
        wanted = heading if is_far else command.yaw_rad if is_last and command.yaw_rad is not None else yaw
        turn = _wrapped(wanted - yaw)
        if is_last and away_m < _NEAR_M and abs(turn) < _TURNED_RAD:
            return "there"
        if (left := away_m + abs(turn)) < command.left - _PROGRESS:
            command.left, command.better_s = left, data.time
        elif data.time - command.better_s > _STUCK_S:
            return "blocked"
        speed = 0.0 if is_far and abs(turn) > _AHEAD_RAD else min(command.speed_m_s, _GAIN * away_m)
        along = heading - yaw
        data.ctrl[list(wheels)] = (
            speed * math.cos(along),
            speed * math.sin(along),
            float(np.clip(_TURN_GAIN * turn, -_TURN_RAD_S, _TURN_RAD_S)),
        )
        return None


def _wrapped(angle_rad: float) -> float:
    """Return the angle in [-pi, pi]."""
    return math.remainder(angle_rad, 2.0 * math.pi)
