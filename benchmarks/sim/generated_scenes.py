"""Generated scenes and timing functions."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from statistics import median, quantiles
from time import perf_counter

import numpy as np

from semmap.nodes.sim_node.bodies import Ints
from semmap.nodes.sim_node.world import World
from semmap.schemas.entities import Pose
from semmap.schemas.scenes import BodyOrder

MODELS = ("chair", "table", "can", "book", "cup", "bottle", "box", "lamp", "apple", "plate")


def order(name: str, model: str, x: float, y: float, z: float = 0.0) -> BodyOrder:
    """Return a body order."""
    return BodyOrder(name=name, class_=model.title(), model=model, pose=Pose(position_m=(x, y, z)), commit=1)


def grid(count: int, pitch_m: float) -> Iterable[tuple[int, float, float]]:
    """Yield positions in a square: number, x and y [m]."""
    side = math.isqrt(count - 1) + 1
    return ((i, pitch_m * (i % side), pitch_m * (i // side)) for i in range(count))


def furnished(count: int, pitch_m: float = 1.5) -> World:
    """Return a world with `count` bodies at rest."""
    world = World()
    world.spawn([order(f"b{i}", MODELS[i % len(MODELS)], x, y) for i, x, y in grid(count, pitch_m)])
    world.step(2.0)
    return world


def timed(act: Callable[[], object]) -> float:
    """Return the duration [s]."""
    started = perf_counter()
    act()
    return perf_counter() - started


def p50_p95_ms(times_s: Sequence[float]) -> tuple[float, float]:
    """Median and 95th percentile [ms]."""
    return 1e3 * median(times_s), 1e3 * quantiles(times_s, n=20, method="inclusive")[18]


def free_dofs(world: World) -> Ints:
    """(F, 6) the addresses in `qvel` of each free body's speeds."""
    model = world.model
    bodies = np.unique([model.geom_bodyid[geom] for geom, name in enumerate(world.body_names()) if name])
    free = bodies[model.body_dofnum[bodies] == 6]
    return np.asarray(model.body_dofadr[free, None] + np.arange(6))
