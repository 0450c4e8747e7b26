"""The simulated world: bodies that are spawned, deleted, moved by hand, and fall, rest and sleep between."""

from __future__ import annotations

import time
import uuid
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

import mujoco
import numpy as np
from numpy.typing import NDArray

from nodes.sim_node import build, groundwork
from nodes.sim_node.bodies import BodyIndex, BodyRecord, Floats, frame_of, pose_of
from nodes.sim_node.models.library import Model, ModelError
from nodes.sim_node.models.library import build as library_model
from nodes.sim_node.models.parts import Vec3
from nodes.sim_node.placing import Stage, place
from nodes.sim_node.rest import RestWatch
from schemas.entities import Pose
from schemas.scenes import BodiesMoved, Body, BodyOrder, Deleted, Placement, Poses, Scene, Spawned

REACH_M = 1000.0
"""No body is put farther than this from the origin."""

_AWAKE = -(1 + mujoco.mjMINAWAKE)
_READY_TO_SLEEP = -1
_NEAR_M = 0.02
_STEPS_A_LOOK = 10
_REBUILD_FROM = 16

ModelSource = Callable[[str, Vec3 | None], Model]


class World:
    """A MuJoCo scene whose bodies come and go.

    Positions are bottom centres in the map frame, which is MuJoCo's world frame. One thread owns a World.
    `model` and `data` are new objects after each spawn and delete.
    """

    def __init__(self, mjcf: Path | None = None, *, models: ModelSource = library_model) -> None:
        """Start from an MJCF file, or from a bare floor. Raises BadFile for a file that does not compile."""
        self._spec = groundwork.read_mjcf(mjcf) if mjcf else groundwork.bare_floor()
        self._models = models
        self.name = mjcf.name if mjcf else "empty"
        self.run = uuid.uuid4().hex[:12]
        self.version = 0
        groundwork.prepare(self._spec)
        build.set_memory(self._spec, 0)
        self._pristine = self._spec.copy()
        self._records = groundwork.bodies_of(self._spec)
        self._made_from: dict[str, Model] = {}
        self.model: mujoco.MjModel = self._spec.compile()
        self.data = mujoco.MjData(self.model)
        self._index = BodyIndex.of(self.model, self._records)
        self._rest = RestWatch(self._poses(), self.data.time)
        self._resting = self._index.qpos < 0

    # what is asked

    def spawn(self, orders: Sequence[BodyOrder]) -> Spawned:
        """Make bodies, all in one recompilation; what cannot be made is told in `failed`, name by name."""
        newcomers: dict[str, tuple[BodyRecord, Model]] = {}
        failed: dict[str, str] = {}
        for order in orders:
            try:
                if order.name in newcomers:
                    raise ModelError(f"a body named {order.name} is ordered twice")
                newcomers[order.name] = self._newcomer(order)
            except ModelError as error:
                failed[order.name] = str(error)
        if newcomers:
            for record, model in newcomers.values():
                build.add_body(self._spec, record, model, record.ordered)
            self._records |= {name: record for name, (record, _) in newcomers.items()}
            self._made_from |= {name: model for name, (_, model) in newcomers.items()}
            self._recompile()
            self._settle(newcomers)
            self.version += 1
        return Spawned(bodies=self._bodies(newcomers), failed=failed)

    def delete(self, names: Sequence[str]) -> Deleted:
        """Take bodies away, all in one recompilation; names that are not there are passed over."""
        gone = [name for name in dict.fromkeys(names) if name in self._records]
        if not gone:
            return Deleted(names=())
        disturbed = self._neighbours(gone)
        for name in gone:
            del self._records[name]
            self._made_from.pop(name, None)
        if len(gone) < _REBUILD_FROM:
            for name in gone:
                self._spec.delete(self._spec.body(name))
            self._recompile()
        else:
            self._rebuild()
        self._wake(disturbed)
        self._free_ghosts()
        self.version += 1
        return Deleted(names=tuple(gone))

    def move(self, placements: Sequence[Placement]) -> BodiesMoved:
        """Put bodies elsewhere as a hand would: there at once, with no speed, then left to physics."""
        moved: dict[str, Placement] = {}
        failed: dict[str, str] = {}
        for placement in placements:
            reason = self._refuse_move(placement)
            if reason:
                failed[placement.name] = reason
            else:
                moved[placement.name] = placement
        if moved:
            disturbed = self._neighbours(moved)
            for name, placement in moved.items():
                record = self._records[name]
                if placement.commit is not None:
                    record.commit, record.ordered = placement.commit, placement.pose
            self._put({name: placement.pose for name, placement in moved.items()})
            self._settle(moved)
            self._wake({*disturbed, *moved})
            self._free_ghosts()
        return BodiesMoved(names=tuple(moved), failed=failed)

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
            self._resting = self._rest.update(self._poses(), self.data.time, self._sleeping())

    def reset(self) -> int:
        """Back to the map: each body goes where it was last ordered to be; answers how many there are."""
        self._put({name: record.ordered for name, record in self._records.items()})
        self._settle(self._records)
        self._wake(self._records)
        self._free_ghosts()
        return len(self)

    @property
    def asleep(self) -> bool:
        """Nothing moves: every body sleeps, and none is about to be woken."""
        return bool((self.data.tree_asleep >= 0).all()) and not self._poked()

    # what is told

    def __len__(self) -> int:
        """How many bodies there are."""
        return len(self._records)

    def extent(self) -> tuple[Floats, Floats]:
        """Lowest and highest corner, each (3,) [m], of the box around all bodies."""
        stage = Stage(self.model, self.data, self._index, self._records)
        if not len(self):
            return np.array([-1.0, -1.0, 0.0]), np.array([1.0, 1.0, 1.0])
        return stage.body_low.min(axis=0), stage.body_high.max(axis=0)

    def poses(self) -> Poses:
        """Where all bodies are."""
        index = self._index
        return Poses(
            run=self.run,
            version=self.version,
            stamp_ns=time.time_ns(),
            sim_time_s=float(self.data.time),
            names=index.names,
            poses=tuple(self._poses().ravel().tolist()),
            resting=tuple(self._resting.tolist()),
            commits=tuple(record.commit for record in self._records.values()),
        )

    def scene(self) -> Scene:
        """Every body as it is now."""
        return Scene(
            run=self.run,
            version=self.version,
            stamp_ns=time.time_ns(),
            sim_time_s=float(self.data.time),
            world=self.name,
            bodies=self._bodies(self._records),
        )

    def body_names(self) -> list[str]:
        """(ngeom,) for each geom of `model` the name of the body that it belongs to, or ""."""
        names = np.full(self.model.nbody, "", dtype=object)
        names[self._index.body] = self._index.names
        return names[self.model.body_rootid[self.model.geom_bodyid]].tolist()  # type: ignore[no-any-return]

    # how it is done

    def _newcomer(self, order: BodyOrder) -> tuple[BodyRecord, Model]:
        if order.name in self._records or self._spec.body(order.name) is not None:
            raise ModelError(f"the scene has a body named {order.name} already")
        _check_reach(order.pose)
        model = self._models(order.model, order.size_m)
        x, y, z = model.inertial.centre_m
        record = BodyRecord(
            name=order.name,
            class_=order.class_,
            model=model.name,
            size_m=model.size_m,
            origin_m=(-x, -y, -z),
            ordered=order.pose,
            fixed=order.fixed,
            entity=order.commit > 0,
            masks=[build.mask_of(part) for part in model.parts],
            commit=order.commit,
            shape_commit=order.commit,
        )
        return record, model

    def _refuse_move(self, placement: Placement) -> str | None:
        if placement.name not in self._records:
            return f"the scene has no body named {placement.name}"
        try:
            _check_reach(placement.pose)
        except ModelError as error:
            return str(error)
        return None

    def _recompile(self) -> None:
        """Compile the specification anew; the state of what stays is kept, sleep included."""
        build.set_memory(self._spec, len(self._records))
        self._renew(*self._spec.recompile(self.model, self.data))

    def _rebuild(self) -> None:
        """Make the specification anew, with the same state: to delete k of n bodies costs k times n."""
        rows = self._index.row
        poses = self._poses()
        spec = self._pristine.copy()
        for body in list(spec.worldbody.bodies):
            if body.name and body.name not in self._records:
                spec.delete(body)
        for name, record in self._records.items():
            pose = pose_of(poses[rows[name]])
            if record.entity:
                build.add_body(spec, record, self._made_from[name], pose)
            elif record.static:
                build.set_standing(spec, record, pose)
        build.set_memory(spec, len(self._records))
        model = spec.compile()
        data = mujoco.MjData(model)
        build.carry_state(self.model, self.data, model, data)
        self._spec = spec
        self._renew(model, data)

    def _renew(self, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        """Go on with a new model: what slept sleeps on, what rested rests."""
        slept = dict(zip(self._index.names, self._sleeping().tolist(), strict=True))
        rested = dict(zip(self._index.names, self._resting.tolist(), strict=True))
        self.model, self.data = model, data
        self._index = BodyIndex.of(model, self._records)
        self._rest = RestWatch(self._poses(), data.time)
        names = self._index.names
        self._resting = (self._index.qpos < 0) | np.array(
            [rested.get(name, False) for name in names], dtype=bool
        )
        sleepers = self._index.tree[[slept.get(name, False) for name in names]] if names else self._index.tree
        data.tree_asleep[sleepers[sleepers >= 0]] = _READY_TO_SLEEP

    def _put(self, poses: dict[str, Pose]) -> None:
        """Set poses, speed zero; static bodies need the specification and a recompilation."""
        held = [name for name in poses if self._records[name].static]
        for name in held:
            self._records[name].ghost = False
            build.set_standing(self._spec, self._records[name], poses[name])
        if held:
            self._recompile()
        for name, pose in poses.items():
            row = self._index.row[name]
            if (address := self._index.qpos[row]) >= 0:
                position, quaternion = frame_of(pose, self._records[name].origin_m)
                self.data.qpos[address : address + 3] = position
                self.data.qpos[address + 3 : address + 7] = quaternion
                dof = self._index.dof[row]
                self.data.qvel[dof : dof + 6] = 0.0
                self.data.qacc_warmstart[dof : dof + 6] = 0.0

    def _settle(self, names: Iterable[str]) -> None:
        """Find room for bodies that were just put down: lift what can be lifted, make ghosts of the rest."""
        mujoco.mj_kinematics(self.model, self.data)
        stage = Stage(self.model, self.data, self._index, self._records)
        poses = self._poses()
        verdicts = place(stage, [self._index.row[name] for name in names])
        ghosts: dict[str, Pose] = {}
        for row, placed in verdicts.items():
            name = self._index.names[row]
            if placed.ghost:
                ghosts[name] = pose_of(poses[row])
            elif (address := self._index.qpos[row]) >= 0:
                self.data.qpos[address + 2] += placed.rise_m
        self._turn(ghosts, ghost=True)
        mujoco.mj_kinematics(self.model, self.data)
        rows = [self._index.row[name] for name in names]
        self._rest.disturb(rows, self.data.time)
        self._resting[rows] = self._index.qpos[rows] < 0

    def _turn(self, poses: dict[str, Pose], *, ghost: bool) -> None:
        """Make ghosts of solid bodies, or solid bodies of ghosts, where they are."""
        for name, pose in poses.items():
            self._records[name].ghost = ghost
            build.set_standing(self._spec, self._records[name], pose)
        if poses:
            self._recompile()
            self.version += 1

    def _free_ghosts(self) -> None:
        """Ghosts whose place has become free turn solid."""
        if not any(record.ghost for record in self._records.values()):
            return
        mujoco.mj_kinematics(self.model, self.data)
        stage = Stage(self.model, self.data, self._index, self._records)
        poses = self._poses()
        freed: dict[str, Pose] = {}
        for row, name in enumerate(self._index.names):
            if self._records[name].ghost and not stage.hits(row):
                stage.standing[row] = True
                freed[name] = pose_of(poses[row])
        self._turn(freed, ghost=False)

    def _neighbours(self, names: Iterable[str]) -> set[str]:
        """Bodies that touch any of `names` or sleep in a heap with it."""
        mujoco.mj_kinematics(self.model, self.data)
        stage = Stage(self.model, self.data, self._index, self._records)
        return {
            self._index.names[row] for name in names for row in stage.touched(self._index.row[name], _NEAR_M)
        }

    def _wake(self, names: Iterable[str]) -> None:
        """Wake bodies, and with each the heap that it sleeps in."""
        asleep = self.data.tree_asleep
        for name in names:
            if name not in self._records:
                continue
            tree = self._index.tree[self._index.row[name]]
            while tree >= 0 and asleep[tree] != _AWAKE:
                following = asleep[tree]
                asleep[tree] = _AWAKE
                tree = following

    def _calm(self, before: Floats) -> None:
        """A body whose motion ran out of bounds stops where it was a step ago."""
        bad = ~np.isfinite(self.data.qpos)
        self.data.qpos[bad] = before[bad]
        self.data.qvel[~np.isfinite(self.data.qvel)] = 0.0
        self.data.qacc_warmstart[:] = 0.0

    def _poses(self) -> Floats:
        return self._index.poses(self.data)

    def _sleeping(self) -> NDArray[np.bool_]:
        tree = self._index.tree
        if not len(self.data.tree_asleep):
            return tree < 0
        return np.where(tree >= 0, self.data.tree_asleep[np.maximum(tree, 0)] >= 0, True)

    def _poked(self) -> bool:
        return bool(self.data.xfrc_applied.any() or self.data.qvel.any())

    def _bodies(self, names: Iterable[str]) -> tuple[Body, ...]:
        poses, resting = self._poses(), self._resting
        bodies = []
        for name in names:
            record, row = self._records[name], self._index.row[name]
            bodies.append(
                Body(
                    name=name,
                    class_=record.class_,
                    model=record.model,
                    pose=pose_of(poses[row]),
                    size_m=record.size_m,
                    fixed=record.fixed,
                    entity=record.entity,
                    ghost=record.ghost,
                    resting=bool(resting[row]),
                    commit=record.commit,
                    shape_commit=record.shape_commit,
                )
            )
        return tuple(bodies)


def _check_reach(pose: Pose) -> None:
    distance = float(np.linalg.norm(pose.position_m))
    if distance > REACH_M:
        raise ModelError(f"{distance:.0f} m from the origin is too far; bodies stand within {REACH_M:.0f} m")
