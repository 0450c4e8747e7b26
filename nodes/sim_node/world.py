"""The simulated world: bodies are spawned, deleted and moved; they fall, come to rest and sleep."""

from __future__ import annotations

import copy
import math
import uuid
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

import mujoco
import numpy as np
from msgspec import structs

from semmap.nodes.sim_node import order_validation
from semmap.nodes.sim_node.bodies import Floats, Ints, StoredBody, pose_of
from semmap.nodes.sim_node.body_classes import BodyClasses
from semmap.nodes.sim_node.models.facets import surface_of
from semmap.nodes.sim_node.models.library import build as library_model
from semmap.nodes.sim_node.models.world_surface import body_surface, close_joints, digest_of, world_surface
from semmap.nodes.sim_node.order_validation import ModelSource
from semmap.nodes.sim_node.physics import base_scene, build
from semmap.nodes.sim_node.physics.engine import Engine
from semmap.nodes.sim_node.physics.walls import walls
from semmap.nodes.sim_node.placement.settling import Settling
from semmap.nodes.sim_node.robots.base_controller import ACTUATORS, Outcome, actuators
from semmap.nodes.sim_node.scene_clock import SceneClock
from semmap.nodes.sim_node.vision.labels import find_tops
from semmap.nodes.sim_node.vision.view import bulk, camera_names, optical_pose, overview
from semmap.schemas import wording
from semmap.schemas.entities import Pose, relative
from semmap.schemas.errors import Refused
from semmap.schemas.plans import Outline
from semmap.schemas.scenes import (
    UPRIGHT,
    BodiesMoved,
    Body,
    BodyOrder,
    CameraPose,
    Deleted,
    DriveBase,
    GripOrder,
    Gripped,
    JointOrder,
    JointsMoving,
    Placement,
    Poses,
    Scene,
    Spawned,
    Surface,
    Surfaces,
)


class World:
    """A MuJoCo scene whose bodies are created and deleted at run time.

    Positions are bottom centres in the map frame, which is MuJoCo's world frame. One thread owns a World.
    """

    def __init__(
        self,
        ground: mujoco.MjSpec | None = None,
        *,
        name: str = "empty",
        models: ModelSource = library_model,
        while_waiting: Callable[[], None] = lambda: None,
        classes: BodyClasses | None = None,
        clock: SceneClock | None = None,
    ) -> None:
        """Start from a scene that compiles, or from a bare floor.

        `while_waiting` is called repeatedly while models are read and compiled. It may call `step`, `poses`
        and `snapshot`, which do not include new bodies yet. `classes` finds the classes of the
        world's bodies, and which of their parts are separate bodies.
        """
        ground = ground or base_scene.bare_floor()
        self.ignored = base_scene.ignored(ground)
        """Declarations of the world file without effect, each with the reason."""
        self._engine = Engine(ground, while_waiting, classes)
        self.left_out = self._engine.left_out
        """Bodies of the world file that are only parts of others, by name or by their parent."""
        self.notes = base_scene.describe_names(self._engine.records.values())
        """Notes on the names and classes of the bodies of the world file."""
        build.run_in_background(self._set_digests, while_waiting)
        self._settling = Settling(self._engine)
        self._models, self._while_waiting = models, while_waiting
        self.name = name
        self.clock = clock or SceneClock()
        self.run = uuid.uuid4().hex[:12]
        self._copied, self._copy = self._engine.revision, (copy.copy(self.model), self.body_names())

    @property
    def model(self) -> mujoco.MjModel:
        """Return the compiled model. Spawning and deleting change or replace it."""
        return self._engine.model

    @property
    def data(self) -> mujoco.MjData:
        """Return the state of `model`."""
        return self._engine.data

    @property
    def compiling(self) -> bool:
        """Return whether bodies are being added or changed, which takes long in a large world."""
        return self._engine.compiling

    @property
    def asleep(self) -> bool:
        """Return whether every body sleeps and none is about to wake."""
        return self._engine.asleep

    @property
    def awake(self) -> int:
        """Return the approximate number of awake bodies; the time of a step is proportional to it."""
        return self._engine.awake

    @property
    def joints_at_rest(self) -> int:
        """Return the number of joints of resting bodies."""
        engine = self._engine
        return int(np.count_nonzero(engine.resting[engine.index.joint_body]))

    # Commands

    def spawn(self, ordered: Sequence[BodyOrder]) -> Spawned:
        """Create bodies in one step; rejected ones are in `failed`, by name."""
        newcomers, failed = build.run_in_background(
            lambda: order_validation.validate_spawn(ordered, self._models, self._engine.has),
            self._while_waiting,
        )
        if newcomers:
            self._settling.add(newcomers)
        return Spawned(bodies=self._bodies(newcomers), failed=failed)

    def delete(self, names: Sequence[str]) -> Deleted:
        """Delete bodies in one step; unknown names are ignored."""
        gone = [name for name in dict.fromkeys(names) if name in self._engine.records]
        if gone:
            self._settling.remove(gone)
        return Deleted(names=tuple(gone))

    def move(self, placements: Sequence[Placement]) -> BodiesMoved:
        """Move bodies instantly and without speed, and leave them to physics."""
        accepted, failed = order_validation.validate_moves(placements, self._engine.records)
        records = self._engine.records
        for placement in placements:
            if placement.commit is not None and placement.name in records:
                records[placement.name].commit = placement.commit
        for placement in accepted:
            if placement.commit is not None:
                records[placement.name].ordered = placement.pose
            self._mark_used(placement.name)
            self._engine.base_controller.stop(self.model, self.data, placement.name, "stopped")
        moved = {placement.name: placement.pose for placement in accepted}
        self._settling.put(moved)
        return BodiesMoved(bodies=self._bodies(moved), failed=failed)

    def move_joints(self, ordered: Sequence[JointOrder]) -> JointsMoving:
        """Start to move joints; they arrive after some simulated time."""
        targets, failed = order_validation.joint_targets(ordered, self._engine.records)
        for order in ordered:
            if order.name in targets and order.commit is not None:
                self._engine.records[order.name].joint_commit = order.commit
        for name, to in targets.items():
            self._engine.drive(name, to)
        return JointsMoving(bodies=self._bodies(targets), failed=failed)

    def grip(self, ordered: Sequence[GripOrder]) -> Gripped:
        """Attach bodies to others, or detach them."""
        records = self._engine.records
        accepted, failed = order_validation.validate_grips(ordered, records)
        changed = []
        for order in accepted:
            record = records[order.name]
            record.grip_commit = max(0, record.grip_commit) if order.commit is None else order.commit
            grip = order.grip
            if order.holder and grip is None:
                is_held = record.held_by == order.holder
                here, there = self.pose(order.name), self.pose(order.holder)
                grip = record.grip if is_held else relative(here, there)
            if (order.holder, grip) != (record.held_by, record.grip):
                record.held_by, record.grip = order.holder, grip
                changed.append(order.name)
        if changed:
            self._settling.grip(changed)
        return Gripped(bodies=self._bodies(order.name for order in accepted), failed=failed)

    def mark_robot(self, name: str) -> None:
        """Mark a body and its parts as a robot, whose joints do not open anything.

        The robot has no pose from the map yet.
        """
        records = self._engine.records
        for record in records.values():  # wholes come before their parts
            above = records.get(record.part_of)
            if record.name == name or (above is not None and above.robot):
                record.robot, record.commit = True, -1
                record.joints = tuple(structs.replace(joint, closed=None) for joint in record.joints)

    def _mark_used(self, name: str) -> None:
        """Record that a body was placed, moved or driven; for a robot, also its parts."""
        records = self._engine.records
        records[name].commit = max(0, records[name].commit)
        if records[name].robot:
            for record in records.values():
                if record.robot and record.part_of and records[record.part_of].commit >= 0:
                    record.commit = max(0, record.commit)

    def drive(self, order: DriveBase) -> None:
        """Start a drive command, or stop the robot if there are no points.

        Raises Refused for an unknown body, or one that cannot drive.
        """
        engine, name = self._engine, order.name
        if name not in engine.records:
            raise Refused(f"the scene has no body named {name}")
        if not actuators(engine.model, name):
            wanted = ", ".join(ACTUATORS)
            raise Refused(f"{name} cannot drive: its model has no velocity actuators named {wanted}")
        if engine.records[name].static:
            raise Refused(f"{name} cannot drive: another body occupies its place")
        if order.to and self.pose(name).upright < UPRIGHT:
            raise Refused(f"{name} {wording.fallen(name, self.pose(name))}")
        if not order.to:
            engine.base_controller.stop(engine.model, engine.data, name, "stopped")
            return
        for x, y in order.to:
            if math.hypot(x, y) > order_validation.REACH_M:
                raise Refused(f"({x:g}, {y:g}) is too far; the limit is {order_validation.REACH_M:.0f} m")
        self._mark_used(name)
        engine.drive_base(name, order.to, order.yaw, order.speed)

    def ended(self) -> dict[str, Outcome]:
        """Return the outcomes of drive commands that ended since the last call, by robot."""
        ended = dict(self._engine.base_controller.ended)
        self._engine.base_controller.ended.clear()
        return ended

    def pose(self, name: str) -> Pose:
        """Return the pose of a body."""
        return pose_of(self._engine.poses()[self._engine.index.row[name]])

    def step(self, duration_s: float) -> None:
        """Advance the simulated time by `duration_s`; this takes no time while everything sleeps."""
        self._settling.step(duration_s)

    def reset(self) -> int:
        """Move each body to its last ordered pose; return the number of bodies."""
        self._engine.set_joints([name for name, record in self._engine.records.items() if record.joints])
        self._settling.put(
            {
                name: record.ordered
                for name, record in self._engine.records.items()
                if not (record.anchored or record.held_by)
            }
        )
        return len(self)

    def stored_bodies(self, names: Iterable[str]) -> dict[str, StoredBody]:
        """Return the states of those of these bodies that exist."""
        index, poses, qpos = self._engine.index, self._engine.poses(), self.data.qpos
        return {
            name: StoredBody(
                pose_of(poses[index.row[name]]),
                {joint: tuple(qpos[at].tolist()) for joint, at in index.joint_coordinates(name).items()},
                record.held_by,
                record.grip,
            )
            for name in names
            if (record := self._engine.records.get(name)) is not None
        }

    def restore(self, states: Mapping[str, StoredBody]) -> None:
        """Put bodies and their joints into states of an earlier run of the same world, without speed."""
        self._settling.restore(states)

    def aim_overview_camera(self) -> None:
        """Aim the bare floor's camera so that all bodies just fit."""
        view = overview(*self.extent(), 4, 3, fovy_rad=base_scene.OVERVIEW_FOVY_RAD)
        self._engine.aim(base_scene.OVERVIEW, view)

    # Queries

    def __len__(self) -> int:
        """Return the number of bodies."""
        return len(self._engine.records)

    def extent(self) -> tuple[Floats, Floats]:
        """Return lowest and highest corner, each (3,) [m], of the box around all bodies but outliers."""
        obstacles = self._engine.obstacles()
        colliding = np.isfinite(obstacles.body_low).all(axis=1)
        return bulk(obstacles.body_low[colliding], obstacles.body_high[colliding])

    def walls(self) -> tuple[Outline, ...]:
        """Return the outlines of the world's static geometry, seen from above."""
        return walls(self.model, self.data, set(self._engine.index.body.tolist()))

    def tops(self, box: tuple[Floats, Floats] | None = None) -> dict[str, Floats]:
        """Return the centre of the top (3,) [m] of each body whose centre is in the box."""
        return find_tops(self.model, self.data, self.body_names(), box)

    def poses(self) -> Poses:
        """Return the poses of all bodies."""
        engine = self._engine
        return Poses(
            run=self.run,
            version=self._settling.version,
            stamp_ns=self.clock.stamp_ns(),
            sim_time_s=float(engine.data.time),
            names=engine.index.names,
            poses=tuple(engine.poses().ravel().tolist()),
            resting=tuple(engine.resting.tolist()),
            commits=tuple(record.commit for record in engine.index.records),
            joints=tuple(engine.positions().tolist()),
            joint_commits=tuple(record.joint_commit for record in engine.index.records if record.joints),
            drives=engine.base_controller.paths,
        )

    def scene(self) -> Scene:
        """Return the current state of every body."""
        return Scene(
            run=self.run,
            version=self._settling.version,
            stamp_ns=self.clock.stamp_ns(),
            sim_time_s=float(self.data.time),
            world=self.name,
            bodies=self._bodies(self._engine.records),
            left_out=self.left_out,
            unstable=tuple(sorted(self._engine.unstable)),
        )

    def surfaces(self, names: Iterable[str]) -> Surfaces:
        """Return the surfaces of bodies, with all joints at 0."""
        found: dict[str, Surface] = {}
        own = []
        for name in names:
            if (shape := self._engine.shape(name)) is not None:
                found[name] = surface_of(shape)
            elif name in self._engine.records:
                own.append(name)
        return Surfaces(surfaces={**found, **dict(self._own_surfaces(own))})

    def _set_digests(self) -> None:
        for name, surface in self._own_surfaces(self._engine.records):
            self._engine.records[name].surface = digest_of(surface)

    def _own_surfaces(self, names: Iterable[str]) -> Iterator[tuple[str, Surface]]:
        """Yield the surfaces of visible bodies of the world file."""
        model, index = self.model, self._engine.index
        data = close_joints(model, self.data)
        poses, geoms = index.poses(data), dict[str, list[int]]()
        for geom, whose in enumerate(self.body_names()):
            geoms.setdefault(whose, []).append(geom)
        for name in names:
            row = index.row[name]
            own = geoms.get(name, [])
            if (surface := body_surface(model, data, own, int(index.body[row]), poses[row])) is not None:
                yield name, surface

    def surface(self) -> Surface:
        """Return the surface of the world without bodies."""
        return world_surface(self.model, self.data, self.body_names())

    def snapshot(self) -> tuple[mujoco.MjModel, mujoco.MjData, list[str]]:
        """Return copies of the model and its state, and `body_names`.

        The copy of the model is shared until the model changes.
        """
        if self._copied != self._engine.revision:
            self._copied, self._copy = self._engine.revision, (copy.copy(self.model), self.body_names())
        model, names = self._copy
        return model, copy.copy(self.data), names

    def cameras(self) -> tuple[CameraPose, ...]:
        """Return the poses of the world's cameras, and the bodies that carry them."""
        model, data = self.model, self.data
        carriers = self.names_of(model.cam_bodyid)
        return tuple(
            CameraPose(camera=name, part_of=carrier, pose=optical_pose(data, number))
            for number, (name, carrier) in enumerate(zip(camera_names(model), carriers, strict=True))
        )

    def body_names(self) -> list[str]:
        """Return (ngeom,) for each geom of `model` the name of its body, or ""."""
        return self.names_of(self.model.geom_bodyid)

    def names_of(self, numbers: Ints) -> list[str]:
        """Return for each of these bodies of `model` the name of its body or parent, or ""."""
        return self._engine.index.owners(self.model)[numbers].tolist()  # type: ignore[no-any-return]

    def _bodies(self, names: Iterable[str]) -> tuple[Body, ...]:
        engine = self._engine
        poses, resting, positions = engine.poses(), engine.resting, engine.positions()
        rows = [(engine.records[name], engine.index.row[name]) for name in names]
        return tuple(
            record.message(
                pose_of(poses[row]),
                resting=bool(resting[row]),
                positions=[float(positions[engine.index.joint_row[joint]]) for joint in record.joint_names],
            )
            for record, row in rows
        )
