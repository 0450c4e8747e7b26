"""Random spawns, moves and deletes for an hour of simulated time."""

from __future__ import annotations

import gc
from time import perf_counter

import numpy as np
import psutil

from benchmarks.sim.generated_scenes import MODELS, order
from benchmarks.table import Row
from semmap.nodes.sim_node.world import World
from semmap.schemas.entities import Pose
from semmap.schemas.scenes import Placement

_SETTLED = 12
"""The first measurement of memory is after this fraction of the time: 5 minutes of 60."""


def endure(minutes: float) -> list[Row]:
    """Make one change per simulated second, with 20 to 60 bodies on 10 m by 10 m."""
    world, rng = World(), np.random.default_rng(0)
    process, baseline = psutil.Process(), 0
    rounds, started = int(60 * minutes), perf_counter()
    for turn in range(rounds):
        _change(world, rng, turn)
        world.step(1.0)
        if turn == rounds // _SETTLED:
            gc.collect()
            baseline = process.memory_info().rss
    gc.collect()
    end = process.memory_info().rss
    what = f"{minutes:g} simulated minutes of spawn, move, delete"
    return [
        Row(f"{what}: growth of memory", 100.0 * (end / baseline - 1.0), "%", 10.0),
        Row(f"{what}: memory at the end", end / 2**20, "MB"),
        Row(f"{what}: took", perf_counter() - started, "s"),
    ]


def _change(world: World, rng: np.random.Generator, turn: int) -> None:
    names = list(world.poses().names)
    x, y = (float(v) for v in rng.uniform(-5.0, 5.0, 2))
    choice = rng.integers(3)
    if choice == 0 or len(names) < 20:
        world.spawn([order(f"b{turn}", str(rng.choice(MODELS)), x, y)])
    elif choice == 1 or len(names) > 60:
        world.delete([str(rng.choice(names))])
    else:
        world.move([Placement(name=str(rng.choice(names)), pose=Pose(position_m=(x, y, 0.5)))])
