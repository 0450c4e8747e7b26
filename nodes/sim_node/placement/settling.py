"""Settling: adds, removes and sets down bodies; one without room is a ghost until there is room."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence

import numpy as np

from semmap.nodes.sim_node.bodies import pose_of
from semmap.nodes.sim_node.order_validation import Newcomer
from semmap.nodes.sim_node.physics.engine import Engine
from semmap.nodes.sim_node.placement.clearance import place
from semmap.schemas.entities import Pose

_NEAR_M = 0.02


class Settling:
    """Changes an engine's bodies so that nobody stands in another, and all that a change touches wakes.

    `version` grows with each change of who is there, and of who is a ghost.
    """

    def __init__(self, engine: Engine) -> None:
        self.version = 0
        self._engine = engine
        self._ghosts_to_check: set[str] = set()  # where ghosts are to be looked at again once all is at rest

    def add(self, newcomers: Mapping[str, Newcomer]) -> None:
        """Bodies come, each to where its record says, all in one go."""
        self._engine.add(list(newcomers.values()))
        self._find_room(newcomers)
        self.version += 1

    def remove(self, names: Sequence[str]) -> None:
        """Bodies go, all in one go."""
        disturbed = self._neighbours(names)
        self._engine.remove(names)
        self._engine.wake(disturbed)
        self._free_ghosts(disturbed)
        self.version += 1

    def put(self, poses: Mapping[str, Pose]) -> None:
        """Bodies are set down, with no speed; all that touches them at either place takes notice."""
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
        """Bodies are held from now on, or let go, as their records say; what they touched takes notice."""
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

    def step(self, duration_s: float) -> None:
        """Let time pass; ghosts near whom something moved are looked at again when all rests."""
        engine, rested = self._engine, self._engine.resting
        engine.step(duration_s)
        if not engine.index.ghost.any():
            return
        woken = np.flatnonzero(rested & ~engine.resting)
        if len(woken):
            self._ghosts_to_check |= self._neighbours(engine.index.names[row] for row in woken)
        if self._ghosts_to_check and engine.resting.all() and not engine.compiling:
            to_check, self._ghosts_to_check = self._ghosts_to_check, set()
            self._free_ghosts(to_check)

    def _find_room(self, names: Iterable[str]) -> None:
        """Lift those of these bodies that can be lifted; what has no room is a ghost, all else solid."""
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
        """Of these bodies the ghosts for which there is room now turn solid, the earlier before the later."""
        engine = self._engine
        ghosts = [name for name in names if name in engine.records and engine.records[name].ghost]
        if ghosts:
            self._find_room(sorted(ghosts, key=engine.index.row.__getitem__))

    def _neighbours(self, names: Iterable[str]) -> set[str]:
        """These bodies and all that touch them."""
        obstacles, index = self._engine.obstacles(), self._engine.index
        return {index.names[row] for name in names for row in obstacles.touched(index.row[name], _NEAR_M)}
