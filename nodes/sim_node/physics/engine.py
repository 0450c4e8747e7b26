"""The MuJoCo engine: a compiled model with spare body slots, and state that survives recompiling."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from typing import Final

import mujoco
import numpy as np
from numpy.typing import NDArray

from semmap.nodes.sim_node.bodies import BodyIndex, BodyRecord, Floats, StoredBody, frame_of, pose_of
from semmap.nodes.sim_node.body_classes import BodyClasses
from semmap.nodes.sim_node.models.library import Model
from semmap.nodes.sim_node.physics import attachments, base_scene, body_slots, build, sleep
from semmap.nodes.sim_node.physics.body_slots import BodySlot
from semmap.nodes.sim_node.physics.drives import STEPS_A_PUSH, Drives
from semmap.nodes.sim_node.physics.rest import JointRestDetector, RestDetector
from semmap.nodes.sim_node.placement.obstacles import Obstacles
from semmap.nodes.sim_node.robots.base_controller import BaseController
from semmap.nodes.sim_node.vision.view import View
from semmap.schemas.entities import Pose, angle_rad, compose, distance_m

_STEPS_A_CHECK = 25
_MOST: Final = 1e10
"""A larger acceleration is not simulated by MuJoCo."""
_HOLDING: Final = 1e12
"""An inertia [kg, kg m²] that no force moves."""
_MOVED: Final = 1e-6
"""A static body farther from its pose than this [m, rad] is compiled there."""


class Engine:
    """Simulates the bodies, and recompiles the model if no slot is free for a new or changed body.

    `records` has every body, in the order of `index`; `resting` (N,) marks resting bodies. `revision`
    increases with every change of the model. During compilation (`compiling`), bodies may only be queried and
    stepped.
    """

    def __init__(
        self,
        ground: mujoco.MjSpec,
        while_waiting: Callable[[], None],
        classes: BodyClasses | None = None,
    ) -> None:
        """Compile the ground without bodies. `while_waiting` is called repeatedly, and may call `step`.

        `classes` finds the classes of the world's bodies, and which of their parts are separate bodies.
        """
        world = build.run_in_background(lambda: base_scene.prepare(ground), while_waiting)
        self._while_waiting = while_waiting
        self._ground = ground
        self._shapes: dict[str, Model] = {}
        self._slots: dict[str, BodySlot] = {}
        self._free_slots: list[BodySlot] = []
        self.records = base_scene.bodies_of(ground, world, classes)
        self.left_out = base_scene.left_out(world.model, {record.body for record in self.records.values()})
        """Bodies of the world file that are only parts of others, by name or by their parent."""
        self.unstable: set[str] = set()
        """Bodies whose state was no longer finite, so that they were stopped."""
        self.revision = 0
        self.compiling = False
        self.model: mujoco.MjModel
        self.data: mujoco.MjData
        self.index: BodyIndex
        self._compile({name: record.ordered for name, record in self.records.items()})
        self._rest = RestDetector(self.poses(), self.data.time)
        self._joint_rest = JointRestDetector(self.positions(), self.data.time)
        self._drives = Drives()
        self.base_controller = BaseController()
        self.resting: NDArray[np.bool_] = self.index.tree < 0

    def poses(self) -> Floats:
        """Return (N, 7) bottom centre [m] and quaternion wxyz of each body, map frame."""
        return self.index.poses(self.data)

    def positions(self) -> Floats:
        """Return (J,) the position of each body joint [rad, m], in the order of the index."""
        return self.index.positions(self.data)

    def obstacles(self) -> Obstacles:
        """Return the current collision geometry."""
        mujoco.mj_kinematics(self.model, self.data)
        return Obstacles(self.model, self.data, self.index, self.records)

    def has(self, name: str) -> bool:
        """Return whether a body of this name exists, or a part of one of the world's own."""
        return name in self.records or self._ground.body(name) is not None

    def shape(self, name: str) -> Model | None:
        """Return the model of a body; None for the world's own and for unknown bodies."""
        return self._shapes.get(name)

    # Changes of bodies

    def add(self, newcomers: Sequence[tuple[BodyRecord, Model]]) -> None:
        """Add bodies at their ordered poses."""
        for record, shape in newcomers:
            self.records[record.name], self._shapes[record.name] = record, shape
        self._arrange({record.name: record.ordered for record, _ in newcomers})

    def remove(self, names: Sequence[str]) -> None:
        """Remove bodies."""
        own = [self.records[name].body for name in names if name not in self._shapes]
        jointed = any(self._shapes[name].leaves for name in names if name in self._shapes)
        jointed = attachments.involves_attachment(names, self.records) or jointed
        for record in self.records.values():
            if record.held_by in names:
                record.held_by, record.grip, record.grip_commit = "", None, -1
        for name in names:
            self._drives.stop(self.records[name].joint_names)
            self._release_slot(name)
            self._shapes.pop(name, None)
            del self.records[name]
        for in_mujoco in own:
            if (body := self._ground.body(in_mujoco)) is not None:  # else it was removed with its parent
                self._ground.delete(body)
        if own or jointed:
            self._recompile({})
        else:
            self._reindex()

    def hold(self, poses: Mapping[str, Pose]) -> None:
        """Set bodies at these poses static or free, and colliding or not, as in their records."""
        if poses:
            self._arrange(poses)

    def put(self, poses: Mapping[str, Pose]) -> None:
        """Set free bodies to these poses, without speed."""
        for name, pose in poses.items():
            row = self.index.row[name]
            address, dof = self.index.qpos[row], self.index.dof[row]
            self.data.qpos[address : address + 7] = np.concatenate(
                frame_of(pose, self.records[name].origin_m)
            )
            self.data.qvel[dof : dof + 6] = 0.0
            self.data.qacc_warmstart[dof : dof + 6] = 0.0

    def grip(self, names: Collection[str]) -> None:
        """Attach or detach bodies as in their records; an attached body moves to its attach pose."""
        poses = self.poses()
        self._recompile({name: pose_of(poses[self.index.row[name]]) for name in names})
        self.carry(names)

    def restore(self, states: Mapping[str, StoredBody]) -> None:
        """Set bodies to these states, without speed."""
        for name, state in states.items():
            record = self.records[name]
            is_held = state.held_by in self.records
            record.held_by, record.grip = (state.held_by, state.grip) if is_held else ("", None)
            for joint, at in self.index.joint_coordinates(name).items():
                if len(coordinates := state.joints.get(joint, ())) == at.stop - at.start:
                    self.data.qpos[at] = coordinates
        own = {name: state.pose for name, state in states.items() if not self.records[name].anchored}
        self.put({name: pose for name, pose in own.items() if not self.records[name].static})
        here = dict(zip(self.index.names, map(pose_of, self.poses()), strict=True))
        stand = {name: pose for name, pose in own.items() if not is_at(pose, here[name])}
        if stand or any(self.records[name].held_by for name in states):
            self._recompile(stand)
        mujoco.mj_kinematics(self.model, self.data)

    def carry(self, names: Collection[str]) -> None:
        """Move attached bodies, and those attached to them, to their attach poses."""
        for record in attachments.attached_records(self.records):
            above = attachments.holders_of(record.name, self.records)
            if record.static or record.grip is None or not {record.name, *above} & set(names):
                continue
            mujoco.mj_kinematics(self.model, self.data)
            holder = pose_of(self.poses()[self.index.row[record.held_by]])
            self.put({record.name: compose(holder, record.grip)})
        mujoco.mj_kinematics(self.model, self.data)

    def drive(self, name: str, targets: Mapping[str, float]) -> None:
        """Start to move joints of a body, by name, to these positions [rad, m]."""
        record = self.records[name]
        of = {
            joint.name: in_mujoco for joint, in_mujoco in zip(record.joints, record.joint_names, strict=True)
        }
        self._drives.begin({of[joint]: position for joint, position in targets.items()}, self.data.time)
        rows = [self.index.joint_row[of[joint]] for joint in targets]
        for row in rows:
            sleep.wake(self.data, int(self.model.dof_treeid[self.index.joint_dof[row]]))
        self._joint_rest.disturb(rows, self.data.time)
        self.resting[self.index.row[name]] = False

    def drive_base(
        self, name: str, points: Sequence[tuple[float, float]], yaw_rad: float | None, speed_m_s: float
    ) -> None:
        """Start to drive a robot's base through these points [m], finally facing `yaw_rad`."""
        self.base_controller.begin(name, points, yaw_rad, speed_m_s)
        sleep.wake(self.data, int(self.index.tree[self.index.row[name]]))
        self._keep_awake((name,))

    def set_joints(self, names: Iterable[str]) -> None:
        """Set the joints of these bodies to the positions in their records, without speed or force."""
        for name in names:
            record = self.records[name]
            self._drives.stop(record.joint_names)
            for joint, in_mujoco in zip(record.joints, record.joint_names, strict=True):
                row = self.index.joint_row[in_mujoco]
                if joint.kind != "ball":
                    self.data.qpos[self.index.joint_qpos[row]] = joint.position
                    self.data.qvel[self.index.joint_dof[row]] = 0.0
                    # else the last force of a drive remains
                    self.data.qfrc_applied[self.index.joint_dof[row]] = 0.0

    def lift(self, row: int, rise_m: float) -> None:
        """Raise a free body."""
        self.data.qpos[self.index.qpos[row] + 2] += rise_m

    def _arrange(self, poses: Mapping[str, Pose]) -> None:
        """Assign a slot to each of these bodies at its pose; recompile if there are not enough."""
        for name in poses:
            self._release_slot(name)
        enough = len(poses) <= len(self._free_slots) and not attachments.involves_attachment(
            poses, self.records
        )
        if enough and all(self._assign_slot(name, pose) for name, pose in poses.items()):
            self._reindex()
        else:
            self._recompile(poses)

    def _release_slot(self, name: str) -> None:
        slot = self._slots.pop(name, None)
        if slot is not None:
            body_slots.clear_slot(self.model, self.data, slot)
            self._free_slots.append(slot)

    def _assign_slot(self, name: str, pose: Pose) -> bool:
        """Assign the smallest slot that fits; return False if there is none."""
        record, shape = self.records[name], self._shapes.get(name)
        alone = body_slots.compiled_alone(shape) if shape is not None else None
        if alone is None:
            return False
        fitting = [slot for slot in self._free_slots if slot.has_room_for(alone, static=record.static)]
        if not fitting:
            return False
        slot = min(fitting, key=lambda slot: slot.geoms)
        self._free_slots.remove(slot)
        self._slots[name] = slot
        body_slots.fill_slot(self.model, self.data, slot, (record, alone), pose)
        return True

    def _recompile(self, poses: Mapping[str, Pose]) -> None:
        """Recompile the model with these bodies at new poses, and the others in their current state."""
        model, data, index = self.model, self.data, self.index
        now = {name: pose_of(row) for name, row in zip(index.names, self.poses(), strict=True)}
        now.update(poses)
        self._compile(now)
        slept = sleep.asleep_or_ready(data, index.tree)
        self.data.time = data.time
        joints = [name for record in self.records.values() for name in record.joint_names]
        kept = dict.fromkeys([*(joint.name for joint in self._ground.joints), *joints])
        build.carry_joints(model, data, self.model, self.data, kept)
        before, names, free = self._rows_in(index), self.index.names, self.index.qpos >= 0
        stays = free & np.append(index.qpos >= 0, False)[before] & ~np.isin(names, list(poses))
        self.put({names[row]: now[names[row]] for row in np.flatnonzero(free & ~stays)})
        for field, width, address in (("qpos", 7, "qpos"), ("qvel", 6, "dof"), ("qacc_warmstart", 6, "dof")):
            to, of = getattr(self.index, address)[stays], getattr(index, address)[before[stays]]
            offsets = np.arange(width)
            getattr(self.data, field)[to[:, None] + offsets] = getattr(data, field)[of[:, None] + offsets]
        self.set_joints(name for name in poses if name not in index.row and self.records[name].joints)
        mujoco.mj_kinematics(self.model, self.data)
        sleep.let_sleep(self.data, self.index.tree[stays & np.append(slept, False)[before]])
        self._carry_rest_state(before)

    def _compile(self, poses: Mapping[str, Pose]) -> None:
        """Compile a model of all bodies, each at its pose, with some spare slots."""
        self.compiling = True
        try:
            self.model, spares = build.run_in_background(lambda: self._compiled(poses), self._while_waiting)
        finally:
            self.compiling = False
        self.data = mujoco.MjData(self.model)
        slotted = [name for name, shape in self._shapes.items() if not shape.leaves]
        self._slots = {name: BodySlot.of(self.model, name) for name in slotted}
        self._free_slots = [BodySlot.of(self.model, name) for name in spares]
        for slot in self._free_slots:
            body_slots.clear_slot(self.model, self.data, slot)
        mujoco.mj_kinematics(self.model, self.data)
        self.index = self._indexed()
        self.revision += 1

    def _compiled(self, poses: Mapping[str, Pose]) -> tuple[mujoco.MjModel, list[str]]:
        """Return that model, and the names of the spare slots."""
        spec = self._ground.copy()
        made = [(self.records[name], shape, poses[name]) for name, shape in self._shapes.items()]
        build.add_bodies(spec, made)
        spares = build.add_spare_bodies(spec, body_slots.spare_slots(len(made)))
        for name, record in self.records.items():
            if record.static and not record.anchored and name not in self._shapes:
                build.set_standing(spec, record, poses[name])
        attachments.add_welds(spec, self.records)
        build.set_memory(spec, len(self.records) + len(spares))
        return spec.compile(), spares

    def _indexed(self) -> BodyIndex:
        numbers = {
            name: self._slots[name].body if name in self._slots else self.model.body(record.body).id
            for name, record in self.records.items()
        }
        return BodyIndex.of(self.model, self.records, numbers)

    def _rows_in(self, index: BodyIndex) -> NDArray[np.int64]:
        """Return (N,) the row of each body in another index, -1 if none."""
        return np.array([index.row.get(name, -1) for name in self.index.names], dtype=np.int64)

    def _reindex(self) -> None:
        """Update the index after a change of bodies in the same model."""
        index = self.index
        self.index = self._indexed()
        self.revision += 1
        self._carry_rest_state(self._rows_in(index))

    def _carry_rest_state(self, before: NDArray[np.int64]) -> None:
        """Keep the rest state of bodies that existed before, in the rows `before`."""
        self._rest = self._rest.carried_over(self.poses(), self.data.time, before)
        rested = np.append(self.resting, False)[before]
        self._joint_rest = JointRestDetector(self.positions(), self.data.time)
        self.resting = (self.index.tree < 0) | rested

    def aim(self, camera: str, view: View) -> None:
        """Set a camera of the ground to the pose of a view."""
        base_scene.aim(self._ground.camera(camera), view)
        self._recompile({})

    # Simulation

    def step(self, duration_s: float) -> None:
        """Advance the simulated time by `duration_s`; this takes no time while everything sleeps."""
        end = self.data.time + duration_s
        timestep = self.model.opt.timestep
        while (left := round((end - self.data.time) / timestep)) > 0:
            if self.asleep:
                self.data.time = end
            else:
                before, most = (self.data.qpos.copy(), self.data.qvel.copy()), _STEPS_A_CHECK
                if self._drives:
                    arrived = self._drives.push(self.model, self.data, self.index)
                    self._joint_rest.arrive(arrived, self.positions(), self.data.time)
                    most = STEPS_A_PUSH
                if self.base_controller:
                    self.base_controller.steer(self.model, self.data, self.index)
                    most = STEPS_A_PUSH
                mujoco.mj_step(self.model, self.data, nstep=min(left, most))
                if not np.isfinite(self.data.qpos).all():
                    self._stop_diverged(before, min(left, most))
            asleep = sleep.sleeping(self.data, self.index.tree)
            self.resting = self._rest.update(self.poses(), self.data.time, asleep)
            if len(self.index.joint):
                still = self._joint_rest.update(self.positions(), self.data.time)
                still[self._drives.rows(self.index)] = False
                self.resting[self.index.joint_body[~still]] = False
            self._keep_awake(self.base_controller.names)

    def _keep_awake(self, names: Iterable[str]) -> None:
        """Mark driving robots as not resting, also while they are blocked."""
        for name in names:
            if (row := self.index.row.get(name)) is not None:
                self.resting[row] = False

    @property
    def asleep(self) -> bool:
        """Return whether every body sleeps and none is about to wake."""
        return not self._drives and not self.base_controller and sleep.all_asleep(self.data)

    @property
    def awake(self) -> int:
        """Return the number of awake bodies, including spare slots."""
        return sleep.awake(self.data)

    def wake(self, names: Iterable[str]) -> None:
        """Wake bodies, each with the island that it sleeps in."""
        for name in names:
            if name in self.records:
                sleep.wake(self.data, self.index.tree[self.index.row[name]])

    def disturb(self, rows: Sequence[int]) -> None:
        """Restart rest detection of these bodies, and of bodies in the same kinematic tree."""
        tree = self.index.tree
        along = np.flatnonzero((tree >= 0) & np.isin(tree, tree[list(rows)]))
        taken = [*rows, *along.tolist()]
        self._rest.disturb(taken, self.data.time)
        self.resting[taken] = tree[taken] < 0

    def _stop_diverged(self, before: tuple[Floats, Floats], steps: int) -> None:
        """Return to the state before these steps, and hold the bodies whose state became infinite there.

        They are found by single steps, because their state soon spreads to all others. A very large inertia
        holds them until the model is recompiled.
        """
        data = self.data
        self._set_state(before)
        bad = np.zeros(self.model.nv, dtype=bool)
        for _ in range(steps):
            mujoco.mj_step(self.model, data)
            bad = ~(np.abs(data.qacc) < _MOST) | ~np.isfinite(data.qvel)
            if bad.any():
                break
        trees = np.unique(self.model.dof_treeid[bad])
        self._set_state(before)
        held = np.isin(self.model.dof_treeid, trees)
        data.qvel[held], self.model.dof_armature[held] = 0.0, _HOLDING
        mujoco.mj_kinematics(self.model, data)
        root = self.model.tree_bodyadr[trees]
        names = dict(zip(self.index.body.tolist(), self.index.names, strict=True))
        roots = self.model.body_rootid[root].tolist()
        self.unstable.update(names[body] for body in (*root.tolist(), *roots) if body in names)

    def _set_state(self, state: tuple[Floats, Floats]) -> None:
        self.data.qpos[:], self.data.qvel[:] = state
        self.data.qacc_warmstart[:] = 0.0


def is_at(pose: Pose, here: Pose) -> bool:
    """Return whether a body is at a pose, so that it need not be moved there."""
    return max(distance_m(pose, here), angle_rad(pose, here)) <= _MOVED
