"""The scene, computed from the simulator's last snapshot and the poses published since."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from msgspec import structs
from numpy.typing import NDArray

from semmap.schemas.entities import Pose
from semmap.schemas.scenes import Body, Poses, Scene

_STIR = 2e-4
"""A change of a coordinate [m] or quaternion component below this is ignored."""
_UNIT_TOLERANCE = 1e-3
_LAST_STAMP_NS = (1 << 63) - 1
_JOINT_STIR = 1e-3
"""The same for a joint [rad, m]."""


class SceneState:
    """The bodies by name. `known` is false before the first snapshot."""

    def __init__(self) -> None:
        self.known = False
        self.bodies: dict[str, Body] = {}
        self.sim_time_s: float | None = None
        self._run = ""
        self._version = -1
        self._names: tuple[str, ...] = ()
        self._rows: NDArray[np.float64] = np.empty((0, 7))

    def take(self, scene: Scene) -> None:
        """Replace the state by a snapshot."""
        self.known = True
        self.bodies = {body.name: body for body in scene.bodies}
        self._run, self._version, self.sim_time_s = scene.run, scene.version, scene.sim_time_s
        self._names, self._rows = (), np.empty((0, 7))

    def matches(self, poses: Poses) -> bool:
        """Return whether `poses` refers to the bodies of the last snapshot; if not, a new one is needed."""
        return self.known and (poses.run, poses.version) == (self._run, self._version)

    def find_problem(self, poses: Poses) -> str:
        """Return why poses that match the snapshot cannot be applied to it, or "" if they can."""
        rows = np.array(poses.poses, dtype=float)
        joints = np.array(poses.joints, dtype=float)
        expected = sum(len(body.joints) for name in poses.names if (body := self.bodies.get(name)))
        if len(rows) != 7 * len(poses.names):
            return f"{len(rows)} numbers for the poses of {len(poses.names)} bodies, instead of 7 for each"
        if len(joints) not in (0, expected):
            return f"{len(joints)} positions for {expected} joints"
        if not (np.isfinite(rows).all() and np.isfinite(joints).all() and math.isfinite(poses.sim_time_s)):
            return "a number is not finite"
        if not 0 <= poses.stamp_ns <= _LAST_STAMP_NS:
            return f"{poses.stamp_ns} is not a time in nanoseconds since 1970"
        lengths = np.linalg.norm(rows.reshape(-1, 7)[:, 3:], axis=1)
        if (np.abs(lengths - 1.0) > _UNIT_TOLERANCE).any():
            return "a quaternion is not of unit length"
        return ""

    def follow(self, poses: Poses) -> Iterator[tuple[str, Pose]]:
        """Apply poses to known bodies, and yield those that moved, also in their joints.

        The poses match the snapshot and have no problem.
        """
        self.sim_time_s = poses.sim_time_s
        rows = np.array(poses.poses, dtype=float).reshape(-1, 7)
        if poses.names != self._names:
            changed = np.arange(len(rows))
            self._names, self._rows = poses.names, rows
        else:
            changed = np.flatnonzero((np.abs(rows - self._rows) > _STIR).any(axis=1))
            self._rows[changed] = rows[changed]
        for i in changed.tolist():
            body = self.bodies.get(poses.names[i])
            if body is not None:
                x, y, z, *wxyz = rows[i].tolist()
                pose = Pose(position_m=(x, y, z), orientation_wxyz=(wxyz[0], wxyz[1], wxyz[2], wxyz[3]))
                self.bodies[body.name] = structs.replace(body, pose=pose)
        moved = {poses.names[i] for i in changed.tolist()} | set(self._follow_joints(poses))
        for name in poses.names:
            if name in moved and name in self.bodies:
                yield name, self.bodies[name].pose

    def _follow_joints(self, poses: Poses) -> Iterator[str]:
        """Apply joint positions, and yield the bodies of which a joint moved."""
        first = 0
        for name in poses.names if poses.joints else ():
            body = self.bodies.get(name)
            if body is None or not body.joints:
                continue
            now = poses.joints[first : first + len(body.joints)]
            first += len(now)
            joints = list(zip(body.joints, now, strict=False))
            if any(abs(joint.position - at) > _JOINT_STIR for joint, at in joints):
                placed = tuple(structs.replace(joint, position=at) for joint, at in joints)
                self.bodies[name] = structs.replace(body, joints=placed)
                yield name
