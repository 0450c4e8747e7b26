"""The simulated world: bodies that are spawned, deleted, moved by hand, and fall, rest and sleep between."""

from __future__ import annotations

import copy
import time
import uuid
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path

import mujoco
import numpy as np

from nodes.sim_node import build, groundwork
from nodes.sim_node.bodies import BodyRecord, Floats, Ints, pose_of
from nodes.sim_node.engine import Engine
from nodes.sim_node.models.facets import surface_of
from nodes.sim_node.models.library import Model, ModelError
from nodes.sim_node.models.library import build as library_model
from nodes.sim_node.models.parts import Vec3
from nodes.sim_node.placing import place
from nodes.sim_node.vision.view import bulk, overview
from schemas.entities import Pose
from schemas.scenes import BodiesMoved, Body, BodyOrder, Deleted, Placement, Poses, Scene, Spawned, Surfaces

REACH_M = 1000.0
"""No body is put farther than this from the origin."""

_NEAR_M = 0.02
ModelSource = Callable[[str, Vec3 | None], Model]


class World:
    """A MuJoCo scene whose bodies come and go.

    Positions are bottom centres in the map frame, which is MuJoCo's world frame. One thread owns a World.
    """

    def __init__(
        self,
        mjcf: Path | None = None,
        *,
        models: ModelSource = library_model,
        meanwhile: Callable[[], None] = lambda: None,
    ) -> None:
        """Start from an MJCF file, or from a bare floor. Raises BadFile for a file that does not compile.

        `meanwhile` is called again and again while models are read and compiled. It may let time pass
        (`step`), and ask for `poses` and a `snapshot`: newcomers are not yet there.
        """
        ground = groundwork.read_mjcf(mjcf) if mjcf else groundwork.bare_floor()
        self._engine = Engine(ground, meanwhile)
        self._models, self._meanwhile = models, meanwhile
        self.name = mjcf.name if mjcf else "empty"
        self.run = uuid.uuid4().hex[:12]
        self.version = 0
        self._copied, self._copy = self._engine.revision, (copy.copy(self.model), self.body_names())
        self._haunted: set[str] = set()  # where ghosts are to be looked at again once all is at rest

    @property
    def model(self) -> mujoco.MjModel:
        """The compiled model; spawn and delete change it, or put another in its place."""
        return self._engine.model

    @property
    def data(self) -> mujoco.MjData:
        """The state that goes with `model`."""
        return self._engine.data

    @property
    def asleep(self) -> bool:
        """Nothing moves: every body sleeps, and none is about to be woken."""
        return self._engine.asleep

    # what is asked

    def spawn(self, orders: Sequence[BodyOrder]) -> Spawned:
        """Make bodies, all in one go; what cannot be made is told in `failed`, name by name."""
        newcomers, failed = build.aside(lambda: self._newcomers(orders), self._meanwhile)
        if newcomers:
            self._engine.add(list(newcomers.values()))
            self._settle(newcomers)
            self.version += 1
        return Spawned(bodies=self._bodies(newcomers), failed=failed)

    def delete(self, names: Sequence[str]) -> Deleted:
        """Take bodies away, all in one go; names that are not there are passed over."""
        gone = [name for name in dict.fromkeys(names) if name in self._engine.records]
        if gone:
            disturbed = self._neighbours(gone)
            self._engine.remove(gone)
            self._engine.wake(disturbed)
            self._free_ghosts(disturbed)
            self.version += 1
        return Deleted(names=tuple(gone))

    def move(self, placements: Sequence[Placement]) -> BodiesMoved:
        """Put bodies elsewhere as a hand would: there at once, with no speed, then left to physics."""
        moved: dict[str, Pose] = {}
        failed: dict[str, str] = {}
        for placement in placements:
            try:
                record = self._record(placement.name)
                _check_reach(placement.pose)
            except ModelError as error:
                failed[placement.name] = str(error)
                continue
            moved[placement.name] = placement.pose
            if placement.commit is not None:
                record.commit, record.ordered = placement.commit, placement.pose
        self._put(moved)
        return BodiesMoved(bodies=self._bodies(moved), failed=failed)

    def step(self, duration_s: float) -> None:
        """Let `duration_s` of simulated time pass; it costs nothing while everything sleeps."""
        engine, rested = self._engine, self._engine.resting
        engine.step(duration_s)
        if not engine.index.ghost.any():
            return
        woken = np.flatnonzero(rested & ~engine.resting)
        if len(woken):
            self._haunted |= self._neighbours(engine.index.names[row] for row in woken)
        if self._haunted and engine.resting.all() and not engine.compiling:
            haunted, self._haunted = self._haunted, set()
            self._free_ghosts(haunted)

    def reset(self) -> int:
        """Back to the map: each body goes where it was last ordered to be; answers how many there are."""
        self._put({name: record.ordered for name, record in self._engine.records.items()})
        return len(self)

    def look_over(self) -> None:
        """Let the bare floor's camera see all bodies from as near as can be."""
        view = overview(*self.extent(), 4, 3, fovy_rad=groundwork.OVERVIEW_FOVY_RAD)
        self._engine.aim(groundwork.OVERVIEW, view)

    # what is told

    def __len__(self) -> int:
        """How many bodies there are."""
        return len(self._engine.records)

    def extent(self) -> tuple[Floats, Floats]:
        """Lowest and highest corner, each (3,) [m], of the box around all bodies but those far off."""
        stage = self._engine.stage()
        felt = np.isfinite(stage.body_low).all(axis=1)
        return bulk(stage.body_low[felt], stage.body_high[felt])

    def poses(self) -> Poses:
        """Where all bodies are."""
        engine = self._engine
        return Poses(
            run=self.run,
            version=self.version,
            stamp_ns=time.time_ns(),
            sim_time_s=float(engine.data.time),
            names=engine.index.names,
            poses=tuple(engine.poses().ravel().tolist()),
            resting=tuple(engine.resting.tolist()),
            commits=tuple(record.commit for record in engine.index.records),
        )

    def scene(self) -> Scene:
        """Every body as it is now."""
        return Scene(
            run=self.run,
            version=self.version,
            stamp_ns=time.time_ns(),
            sim_time_s=float(self.data.time),
            world=self.name,
            bodies=self._bodies(self._engine.records),
        )

    def surfaces(self, names: Iterable[str]) -> Surfaces:
        """What bodies that were made from a model look like."""
        shapes = {name: self._engine.shape(name) for name in names}
        return Surfaces(surfaces={name: surface_of(shape) for name, shape in shapes.items() if shape})

    def snapshot(self) -> tuple[mujoco.MjModel, mujoco.MjData, list[str]]:
        """Copies of the model and its state, and `body_names`; the model is shared until it changes."""
        if self._copied != self._engine.revision:
            self._copied, self._copy = self._engine.revision, (copy.copy(self.model), self.body_names())
        model, names = self._copy
        return model, copy.copy(self.data), names

    def body_names(self) -> list[str]:
        """(ngeom,) for each geom of `model` the name of the body that it belongs to, or ""."""
        return self.names_of(self.model.geom_bodyid)

    def names_of(self, numbers: Ints) -> list[str]:
        """For each of these bodies of `model` the name of the body that it is, or is a part of, or ""."""
        names = np.full(self.model.nbody, "", dtype=object)
        names[self._engine.index.body] = self._engine.index.names
        return names[self.model.body_rootid[numbers]].tolist()  # type: ignore[no-any-return]

    # how it is done

    def _newcomers(
        self, orders: Iterable[BodyOrder]
    ) -> tuple[dict[str, tuple[BodyRecord, Model]], dict[str, str]]:
        """What is to be made, by name, and why the rest cannot be; files may take their time."""
        newcomers: dict[str, tuple[BodyRecord, Model]] = {}
        failed: dict[str, str] = {}
        for order in orders:
            try:
                if order.name in newcomers:
                    raise ModelError(f"a body named {order.name} is ordered twice")
                newcomers[order.name] = self._newcomer(order)
            except ModelError as error:
                failed[order.name] = str(error)
        return newcomers, failed

    def _newcomer(self, order: BodyOrder) -> tuple[BodyRecord, Model]:
        if self._engine.has(order.name):
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

    def _record(self, name: str) -> BodyRecord:
        if name not in self._engine.records:
            raise ModelError(f"the scene has no body named {name}")
        return self._engine.records[name]

    def _put(self, poses: Mapping[str, Pose]) -> None:
        """Bodies are set down, and all that touches them at either place takes notice."""
        if not poses:
            return
        engine = self._engine
        disturbed = self._neighbours(poses)
        ghosts = [name for name in poses if engine.records[name].ghost]
        for name in ghosts:
            engine.records[name].ghost = False
        self.version += bool(ghosts)
        engine.hold({name: poses[name] for name in poses if name in ghosts or engine.records[name].fixed})
        engine.put({name: pose for name, pose in poses.items() if not engine.records[name].static})
        self._settle(poses)
        engine.wake({*disturbed, *poses})
        self._free_ghosts(disturbed)

    def _settle(self, names: Iterable[str]) -> None:
        """Find room for these bodies: lift what can be lifted; what has none is a ghost, all else solid."""
        engine = self._engine
        rows = [engine.index.row[name] for name in names]
        stage, poses = engine.stage(), engine.poses()
        turned: dict[str, Pose] = {}
        for row, placed in place(stage, rows).items():
            record = engine.index.records[row]
            if placed.ghost != record.ghost:
                record.ghost = placed.ghost
                turned[record.name] = pose_of(poses[row] + (0.0, 0.0, placed.rise_m, 0.0, 0.0, 0.0, 0.0))
            elif placed.rise_m:
                engine.lift(row, placed.rise_m)
        engine.hold(turned)
        engine.disturb(rows)
        self._haunted.update(turned)
        self.version += bool(turned)

    def _free_ghosts(self, names: Iterable[str]) -> None:
        """Of these bodies the ghosts for which there is room now turn solid."""
        records = self._engine.records
        ghosts = [name for name in names if name in records and records[name].ghost]
        if ghosts:
            self._settle(ghosts)

    def _neighbours(self, names: Iterable[str]) -> set[str]:
        """These bodies and all that touch them."""
        stage, index = self._engine.stage(), self._engine.index
        return {index.names[row] for name in names for row in stage.touched(index.row[name], _NEAR_M)}

    def _bodies(self, names: Iterable[str]) -> tuple[Body, ...]:
        engine = self._engine
        poses, resting = engine.poses(), engine.resting
        rows = [(engine.records[name], engine.index.row[name]) for name in names]
        return tuple(record.message(pose_of(poses[row]), resting=bool(resting[row])) for record, row in rows)


def _check_reach(pose: Pose) -> None:
    distance = float(np.linalg.norm(pose.position_m))
    if distance > REACH_M:
        raise ModelError(f"{distance:.0f} m from the origin is too far; bodies stand within {REACH_M:.0f} m")
