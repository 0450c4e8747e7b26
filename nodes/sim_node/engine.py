"""MuJoCo's side of the world: one specification, its compiled model, and state that outlives both."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import mujoco
import numpy as np
from numpy.typing import NDArray

from nodes.sim_node import build, groundwork
from nodes.sim_node.bodies import BodyIndex, BodyRecord, Floats, frame_of, pose_of
from nodes.sim_node.models.library import Model
from nodes.sim_node.placing import Stage
from nodes.sim_node.rest import RestWatch
from schemas.entities import Pose

_AWAKE = -(1 + mujoco.mjMINAWAKE)
_READY_TO_SLEEP = -1
_STEPS_A_LOOK = 10
_REBUILD_FROM = 16


class Engine:
    """Steps the bodies, and compiles anew when they come, go, or change between held and free.

    `records` has every body, in the order of `index`; `resting` (N,) says which rest.
    """

    def __init__(self, spec: mujoco.MjSpec) -> None:
        groundwork.prepare(spec)
        build.set_memory(spec, 0)
        self._spec = spec
        self._pristine = spec.copy()
        self._made_from: dict[str, Model] = {}
        self.records = groundwork.bodies_of(spec)
        self.model: mujoco.MjModel = spec.compile()
        self.data = mujoco.MjData(self.model)
        self.index = BodyIndex.of(self.model, self.records)
        self._rest = RestWatch(self.poses(), self.data.time)
        self.resting: NDArray[np.bool_] = self.index.qpos < 0

    def poses(self) -> Floats:
        """(N, 7): bottom centre [m] and quaternion wxyz of each body, map frame."""
        return self.index.poses(self.data)

    def stage(self) -> Stage:
        """The scene as it is now, for questions of who is in whose way."""
        mujoco.mj_kinematics(self.model, self.data)
        return Stage(self.model, self.data, self.index, self.records)

    def has(self, name: str) -> bool:
        """Whether the specification has a body of this name, of its own or a part of one."""
        return self._spec.body(name) is not None

    # bodies come, go and change

    def add(self, newcomers: Sequence[tuple[BodyRecord, Model]]) -> None:
        """Put bodies where their records say."""
        build.add_bodies(self._spec, [(record, model, record.ordered) for record, model in newcomers])
        for record, model in newcomers:
            self.records[record.name] = record
            self._made_from[record.name] = model
        self._recompile()

    def remove(self, names: Sequence[str]) -> None:
        """Take bodies out."""
        for name in names:
            del self.records[name]
            self._made_from.pop(name, None)
        if len(names) < _REBUILD_FROM:
            for name in names:
                self._spec.delete(self._spec.body(name))
            self._recompile()
        else:
            self._rebuild()

    def hold(self, poses: Mapping[str, Pose]) -> None:
        """Fix bodies at these poses or set them free there, solid or ghost, as their records say now."""
        for name, pose in poses.items():
            build.set_standing(self._spec, self.records[name], pose)
        if poses:
            self._recompile()

    def put(self, poses: Mapping[str, Pose]) -> None:
        """Set free bodies down at these poses, with no speed."""
        for name, pose in poses.items():
            row = self.index.row[name]
            address, dof = self.index.qpos[row], self.index.dof[row]
            position, quaternion = frame_of(pose, self.records[name].origin_m)
            self.data.qpos[address : address + 3] = position
            self.data.qpos[address + 3 : address + 7] = quaternion
            self.data.qvel[dof : dof + 6] = 0.0
            self.data.qacc_warmstart[dof : dof + 6] = 0.0

    def lift(self, row: int, rise_m: float) -> None:
        """Raise a free body."""
        self.data.qpos[self.index.qpos[row] + 2] += rise_m

    def _recompile(self) -> None:
        """Compile the specification anew; the state of what stays is kept, sleep included."""
        build.set_memory(self._spec, len(self.records))
        self._renew(*self._spec.recompile(self.model, self.data))

    def _rebuild(self) -> None:
        """Make the specification anew, with the same state: to delete k of n bodies costs k times n."""
        rows = self.index.row
        poses = self.poses()
        spec = self._pristine.copy()
        for body in list(spec.worldbody.bodies):
            if body.name and body.name not in self.records:
                spec.delete(body)
        now = {name: pose_of(poses[rows[name]]) for name in self.records}
        entities = [(self.records[name], model, now[name]) for name, model in self._made_from.items()]
        build.add_bodies(spec, entities)
        for name, record in self.records.items():
            if record.static and name not in self._made_from:
                build.set_standing(spec, record, now[name])
        build.set_memory(spec, len(self.records))
        model = spec.compile()
        data = mujoco.MjData(model)
        build.carry_state(self.model, self.data, model, data)
        self._spec = spec
        self._renew(model, data)

    def _renew(self, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        """Go on with a new model: what slept sleeps on, what rested rests."""
        slept = dict(zip(self.index.names, self._drowsy().tolist(), strict=True))
        rested = dict(zip(self.index.names, self.resting.tolist(), strict=True))
        self.model, self.data = model, data
        self.index = BodyIndex.of(model, self.records)
        self._rest = RestWatch(self.poses(), data.time)
        names = self.index.names
        self.resting = (self.index.qpos < 0) | np.array(
            [rested.get(name, False) for name in names], dtype=bool
        )
        sleepers = self.index.tree[[slept.get(name, False) for name in names]] if names else self.index.tree
        data.tree_asleep[sleepers[sleepers >= 0]] = _READY_TO_SLEEP

    # time goes on

    def step(self, duration_s: float) -> None:
        """Let `duration_s` of simulated time pass; it costs nothing while everything sleeps."""
        end = self.data.time + duration_s
        timestep = self.model.opt.timestep
        while (left := round((end - self.data.time) / timestep)) > 0:
            if self.asleep:
                self.data.time = end
            else:
                before = self.data.qpos.copy()
                mujoco.mj_step(self.model, self.data, nstep=min(left, _STEPS_A_LOOK))
                if not np.isfinite(self.data.qpos).all():
                    self._calm(before)
            self.resting = self._rest.update(self.poses(), self.data.time, self._sleeping())

    @property
    def asleep(self) -> bool:
        """Nothing moves: every body sleeps, and none is about to be woken."""
        return bool((self.data.tree_asleep >= 0).all()) and not self._poked()

    def _poked(self) -> bool:
        return bool(self.data.xfrc_applied.any() or self.data.qvel.any())

    def _sleeping(self) -> NDArray[np.bool_]:
        return self._deeper_than(_READY_TO_SLEEP)

    def _drowsy(self) -> NDArray[np.bool_]:
        """Asleep, or about to be: what a compilation wakes says so until the next step."""
        return self._deeper_than(_READY_TO_SLEEP - 1)

    def _deeper_than(self, depth: int) -> NDArray[np.bool_]:
        """(N,) whose tree's counter, which rises towards sleep, is above `depth`."""
        tree = self.index.tree
        if not len(self.data.tree_asleep):
            return np.asarray(tree < 0)
        return np.where(tree >= 0, self.data.tree_asleep[np.maximum(tree, 0)] > depth, True)

    def wake(self, names: Iterable[str]) -> None:
        """Wake bodies, and with each the heap that it sleeps in."""
        asleep = self.data.tree_asleep
        for name in names:
            if name not in self.records:
                continue
            tree = self.index.tree[self.index.row[name]]
            while tree >= 0 and asleep[tree] != _AWAKE:
                following = asleep[tree]
                asleep[tree] = _AWAKE
                tree = following

    def disturb(self, rows: Sequence[int]) -> None:
        """These bodies were taken in hand: those that are free do not rest before they were still anew."""
        self._rest.disturb(list(rows), self.data.time)
        self.resting[list(rows)] = self.index.qpos[list(rows)] < 0

    def _calm(self, before: Floats) -> None:
        """A body whose motion ran out of bounds stops where it was a step ago."""
        bad = ~np.isfinite(self.data.qpos)
        self.data.qpos[bad] = before[bad]
        self.data.qvel[~np.isfinite(self.data.qvel)] = 0.0
        self.data.qacc_warmstart[:] = 0.0
