"""Settling: adds, removes and moves bodies; one without free space is a ghost until there is space."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence

import numpy as np

from semmap.nodes.sim_node.bodies import StoredBody, pose_of
from semmap.nodes.sim_node.order_validation import Newcomer
from semmap.nodes.sim_node.physics.engine import Engine
from semmap.nodes.sim_node.placement.clearance import place
from semmap.schemas.entities import Pose

_NEAR_M = 0.02


class Settling:
    """Changes an engine's bodies so that none overlap, and wakes all bodies that a change affects.

    `version` increases with each change of bodies, and of ghosts.
    """

    def __init__(self, engine: Engine) -> None:
        self.version = 0
        self._engine = engine
        self._ghosts_to_check: set[str] = set()  # bodies to be checked again once all bodies rest

    def add(self, newcomers: Mapping[str, Newcomer]) -> None:
        """Add bodies at their ordered poses, in one step."""
        self._engine.add(list(newcomers.values()))
        self._find_room(newcomers)
        self.version += 1

    def remove(self, names: Sequence[str]) -> None:
        """Remove bodies in one step."""
        disturbed = self._neighbours(names)
        self._engine.remove(names)
        self._engine.wake(disturbed)
        self._free_ghosts(disturbed)
        self.version += 1

    def put(self, poses: Mapping[str, Pose]) -> None:
        """Set bodies to poses without speed, and wake bodies that touch them at either place."""
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
        engine.carry(poses)
        self._find_room(poses)
        engine.carry(poses)
        engine.wake({*disturbed, *poses})
        self._free_ghosts(disturbed)

    def grip(self, names: Collection[str]) -> None:
        """Attach or detach bodies as in their records, and wake bodies that they touched."""
        engine = self._engine
        disturbed = self._neighbours(names)
        for name in names:
            engine.records[name].ghost = False
        engine.grip(names)
        self._find_room(name for name in names if not engine.records[name].held_by)
        engine.disturb([engine.index.row[name] for name in names])
        engine.wake({*disturbed, *names, *(engine.records[name].held_by for name in names)})
        self._free_ghosts(disturbed)
        self.version += 1

    def restore(self, states: Mapping[str, StoredBody]) -> None:
        """Put bodies into states of an earlier run, in which they had room."""
        if states:
            self._engine.restore(states)
            self._engine.disturb([self._engine.index.row[name] for name in states])
            self.version += 1

    def step(self, duration_s: float) -> None:
        """Advance the time; ghosts near moved bodies are checked again when all bodies rest."""
        engine, rested, unstable = self._engine, self._engine.resting, len(self._engine.unstable)
        engine.step(duration_s)
        self.version += len(engine.unstable) > unstable
        if not engine.index.ghost.any():
            return
        woken = np.flatnonzero(rested & ~engine.resting)
        if len(woken):
            self._ghosts_to_check |= self._neighbours(engine.index.names[row] for row in woken)
        if self._ghosts_to_check and engine.resting.all() and not engine.compiling:
            to_check, self._ghosts_to_check = self._ghosts_to_check, set()
            self._free_ghosts(to_check)

    def _find_room(self, names: Iterable[str]) -> None:
        """Lift bodies that can be lifted; bodies without free space become ghosts, all others collide."""
        engine = self._engine
        rows = [engine.index.row[name] for name in names if not engine.records[name].held_by]
        obstacles, poses = engine.obstacles(), engine.poses()
        turned: dict[str, Pose] = {}
        for row, placed in place(obstacles, rows).items():
            record = engine.index.records[row]
            in_the_way = "" if placed.in_the_way is None else engine.index.names[placed.in_the_way]
            self.version += in_the_way != record.in_the_way
            record.in_the_way = in_the_way
            if placed.ghost != record.ghost:
                record.ghost = placed.ghost
                turned[record.name] = pose_of(poses[row] + (0.0, 0.0, placed.rise_m, 0.0, 0.0, 0.0, 0.0))
            elif placed.rise_m:
                engine.lift(row, placed.rise_m)
        engine.hold(turned)
        engine.disturb(rows)
        self._ghosts_to_check.update(turned)
        self.version += bool(turned)

    def _free_ghosts(self, names: Iterable[str]) -> None:
        """Make ghosts that have free space now colliding, in the order of creation."""
        engine = self._engine
        ghosts = [name for name in names if name in engine.records and engine.records[name].ghost]
        if ghosts:
            self._find_room(sorted(ghosts, key=engine.index.row.__getitem__))

    def _neighbours(self, names: Iterable[str]) -> set[str]:
        """Return these bodies and all that touch them."""
        obstacles, index = self._engine.obstacles(), self._engine.index
        return {index.names[row] for name in names for row in obstacles.touched(index.row[name], _NEAR_M)}
