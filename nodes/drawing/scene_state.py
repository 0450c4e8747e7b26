"""The scene as it follows from the simulator's last snapshot and the poses since."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from msgspec import structs
from numpy.typing import NDArray

from semmap.schemas.entities import Pose
from semmap.schemas.scenes import Body, Poses, Scene

_STIR = 2e-4
"""A coordinate [m] or a quaternion's component that changed by less has not changed."""
_JOINT_STIR = 1e-3
"""The same of a joint [rad, m]."""


class SceneState:
    """The bodies by name. `known` is false until a first snapshot."""

    def __init__(self) -> None:
        self.known = False
        self.bodies: dict[str, Body] = {}
        self.sim_time_s: float | None = None
        self._run = ""
        self._version = -1
        self._names: tuple[str, ...] = ()
        self._rows: NDArray[np.float64] = np.empty((0, 7))

    def take(self, scene: Scene) -> None:
        """Take over a snapshot."""
        self.known = True
        self.bodies = {body.name: body for body in scene.bodies}
        self._run, self._version, self.sim_time_s = scene.run, scene.version, scene.sim_time_s
        self._names, self._rows = (), np.empty((0, 7))

    def matches(self, poses: Poses) -> bool:
        """Whether `poses` speaks of the bodies of the last snapshot; if not, another is needed."""
        return self.known and (poses.run, poses.version) == (self._run, self._version)

    def follow(self, poses: Poses) -> Iterator[tuple[str, Pose]]:
        """Take over new poses of known bodies, and tell which have moved, as a whole or in their joints."""
        self.sim_time_s = poses.sim_time_s
        rows = np.array(poses.poses, dtype=float).reshape(-1, 7)
        if poses.names != self._names:
            stirred = np.arange(len(rows))
            self._names, self._rows = poses.names, rows
        else:
            stirred = np.flatnonzero((np.abs(rows - self._rows) > _STIR).any(axis=1))
            self._rows[stirred] = rows[stirred]
        for i in stirred.tolist():
            body = self.bodies.get(poses.names[i])
            if body is not None:
                x, y, z, *wxyz = rows[i].tolist()
                pose = Pose(position_m=(x, y, z), orientation_wxyz=(wxyz[0], wxyz[1], wxyz[2], wxyz[3]))
                self.bodies[body.name] = structs.replace(body, pose=pose)
        moved = {poses.names[i] for i in stirred.tolist()} | set(self._follow_joints(poses))
        for name in poses.names:
            if name in moved and name in self.bodies:
                yield name, self.bodies[name].pose

    def _follow_joints(self, poses: Poses) -> Iterator[str]:
        """Take over where joints stand, and tell of which bodies any has moved."""
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
