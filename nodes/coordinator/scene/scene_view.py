"""The coordinator's view of the scene: the last snapshot, updated by the poses."""

from __future__ import annotations

from collections.abc import Iterable

from msgspec import structs

from semmap.schemas.entities import Pose
from semmap.schemas.joints import Joint
from semmap.schemas.scenes import Body, Poses, Scene

_STRANGE_NS = 10_000_000_000
"""Nanoseconds. If a stamp differs by more, a clock was set, and a new snapshot is requested."""


class SceneView:
    """The last known bodies. `known` is false until the first snapshot, and after the simulator ends."""

    def __init__(self) -> None:
        self.known = False
        self.bodies: dict[str, Body] = {}
        self.left_out: tuple[str, ...] = ()
        """Named bodies of the world that are only parts of others."""
        self.unstable: tuple[str, ...] = ()
        """Bodies that were stopped because their simulated state was no longer finite."""
        self.sim_time_s = 0.0
        """Simulated time of the newest poses; it stands still while the simulation is paused."""
        self._run = ""
        self._version = -1
        self._stamp_ns = 0

    def take(self, scene: Scene) -> None:
        """Take a snapshot, unless it is older than the current state."""
        if scene.run == self._run and -_STRANGE_NS < scene.stamp_ns - self._stamp_ns < 0:
            return
        self.known = True
        self.bodies = {body.name: body for body in scene.bodies}
        self.left_out, self.unstable, self.sim_time_s = scene.left_out, scene.unstable, scene.sim_time_s
        self._run, self._version, self._stamp_ns = scene.run, scene.version, scene.stamp_ns

    def add(self, bodies: Iterable[Body]) -> None:
        """Add bodies that were created since the last snapshot."""
        self.bodies.update((body.name, body) for body in bodies)

    def update(self, poses: Poses) -> set[str] | None:
        """Take new poses and return the names of the bodies that changed.

        Returns None if a new snapshot is needed: bodies were added or removed, or a clock was set.
        """
        changed: set[str] = set()
        if poses.run == self._run and abs(poses.stamp_ns - self._stamp_ns) > _STRANGE_NS:
            return None
        if poses.run == self._run and poses.stamp_ns <= self._stamp_ns:
            return changed
        if (poses.run, poses.version) != (self._run, self._version):
            return None
        self._stamp_ns, self.sim_time_s = poses.stamp_ns, poses.sim_time_s
        joint, jointed = 0, 0
        for i, name in enumerate(poses.names):
            body = self.bodies.get(name)
            resting = poses.resting[i]
            joints: tuple[float, ...] = ()
            joint_commit = 0
            if body is not None and body.joints:
                joints = poses.joints[joint : joint + len(body.joints)]
                joint_commit = poses.joint_commits[jointed]
                joint, jointed = joint + len(body.joints), jointed + 1
            if body is None or (
                resting
                and body.resting
                and body.commit == poses.commits[i]
                and body.joint_commit == joint_commit
            ):
                continue
            x, y, z, *orientation = poses.poses[7 * i : 7 * i + 7]
            pose = Pose(position_m=(x, y, z), orientation_wxyz=tuple(orientation))  # type: ignore[arg-type]
            self.bodies[name] = structs.replace(
                body,
                pose=pose,
                resting=resting,
                commit=poses.commits[i],
                joints=_at(body.joints, joints) if joints else (),
                joint_commit=joint_commit,
            )
            changed.add(name)
        return changed

    @property
    def run(self) -> str:
        """The id of the simulator's process; a restarted simulator has another one."""
        return self._run

    @property
    def stamp_ns(self) -> int:
        """The stamp of the newest poses."""
        return self._stamp_ns

    def forget(self) -> None:
        """Forget the scene of a simulator that has ended."""
        self.known = False
        self.bodies, self.left_out, self.unstable, self.sim_time_s = {}, (), (), 0.0
        self._run, self._version, self._stamp_ns = "", -1, 0


def _at(joints: tuple[Joint, ...], positions: tuple[float, ...]) -> tuple[Joint, ...]:
    """Return the joints at their new positions."""
    return tuple(structs.replace(j, position=p) for j, p in zip(joints, positions, strict=True))
