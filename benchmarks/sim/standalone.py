"""The simulator alone, in this process."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from statistics import median
from time import perf_counter, thread_time

import mujoco
import numpy as np

from benchmarks.sim.generated_scenes import free_dofs, furnished, order, p50_p95_ms, timed
from benchmarks.table import Row
from semmap.nodes.sim_node.bodies import Ints
from semmap.nodes.sim_node.vision.camera import Eye
from semmap.nodes.sim_node.world import World

_STEP_S = 0.05
_PAIRS = 30
_REACH_MS = {10: 2.0, 100: 5.0, 500: 35.0}


def spawn_and_delete(count: int, trials: int = 40) -> list[Row]:
    """Measure adding and removing a body beside `count` others at rest, compared with a bare compilation."""
    world = furnished(count)
    spawns, deletes = [], []
    for trial in range(trials):
        newcomer = order(f"new{trial}", "chair", -2.0, -2.0)
        spawns.append(timed(partial(world.spawn, [newcomer])))
        world.step(_STEP_S)
        deletes.append(timed(partial(world.delete, [newcomer.name])))
        world.step(_STEP_S)
    rows = []
    for what, times in (("spawn", spawns), ("delete", deletes)):
        p50, p95 = p50_p95_ms(times)
        rows.append(Row(f"{what} beside {count} bodies, p50", p50, "ms", _REACH_MS[count]))
        rows.append(Row(f"{what} beside {count} bodies, p95", p95, "ms"))
    rows.append(Row(f"bare recompile of {count} free boxes", 1e3 * _bare_recompile(count), "ms"))
    return [*rows, _growing(world, count)]


def _growing(world: World, count: int) -> Row:
    """Measure adding bodies without deleting any; sometimes no prepared slot is left."""
    orders = [order(f"more{i}", "chair", -2.0 - i, -2.0) for i in range(max(10, count // 4))]
    took = [timed(partial(world.spawn, [o])) for o in orders]
    return Row(f"spawn ever more from {count} bodies, mean", 1e3 * sum(took) / len(took), "ms")


def _boxes(count: int) -> mujoco.MjSpec:
    """Free boxes on a floor, with MuJoCo's own defaults."""
    spec = mujoco.MjSpec()
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0, 0, 0.1])
    for i in range(count):
        body = spec.worldbody.add_body(pos=[1.5 * (i % 20), 1.5 * (i // 20), 0.1])
        body.add_freejoint()
        body.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=[0.1] * 3)
    return spec


def _bare_recompile(count: int) -> float:
    spec = _boxes(count)
    model = spec.compile()
    data = mujoco.MjData(model)
    times = []
    for _ in range(5):
        started = perf_counter()
        model, data = spec.recompile(model, data)
        times.append(perf_counter() - started)
    return median(times)


def real_time_factors() -> list[Row]:
    """Measure a hundred sleeping bodies, and a hundred that are pushed ten times a second."""
    world = furnished(100, pitch_m=1.2)
    steps = round(10.0 / world.model.opt.timestep)
    engine = 10.0 / timed(lambda: mujoco.mj_step(world.model, world.data, nstep=steps))
    asleep = 1000.0 / timed(lambda: world.step(1000.0))
    took, own, bare_took, bare_own = _shaken_in_turn(world, 100)
    return [
        Row("real-time factor, 100 bodies at rest", asleep, "times", 100.0, more=True),
        Row("the same, MuJoCo alone", engine, "times"),
        Row("real-time factor, 100 bodies being shaken", 0.1 / median(took), "times", 4.0, more=True),
        Row("the same, by its own CPU time", 0.1 / median(own), "times"),
        Row("contacts of these", float(world.data.ncon), ""),
        Row("100 plain boxes being shaken, MuJoCo alone", 0.1 / median(bare_took), "times"),
        Row("the same, by its own CPU time", 0.1 / median(bare_own), "times"),
        Row(
            "ratio of the two, by CPU time, median of pairs", _ratio(bare_own, own), "", 0.7, 0.85, more=True
        ),
    ]


def _ratio(one: list[float], other: list[float]) -> float:
    return median(a / b for a, b in zip(one, other, strict=True))


def _shaken_in_turn(world: World, count: int) -> tuple[list[float], list[float], list[float], list[float]]:
    """Shake the bodies of a world and as many plain boxes in turn, so that both share the machine's load.

    Return wall and CPU time of each interval of 0.1 s of both [s].
    """
    model = _boxes(count).compile()
    data = mujoco.MjData(model)
    steps = round(0.1 / model.opt.timestep)
    ours = _shaking(world.data, free_dofs(world), lambda: world.step(0.1))
    plain = _shaking(
        data, np.arange(model.nv).reshape(-1, 6), lambda: mujoco.mj_step(model, data, nstep=steps)
    )
    times = [(*ours(), *plain()) for _ in range(_PAIRS)]
    took, own, bare_took, bare_own = map(list, zip(*times, strict=True))
    return took, own, bare_took, bare_own


def _shaking(data: mujoco.MjData, free: Ints, step: Callable[[], None]) -> Callable[[], tuple[float, float]]:
    """Return a function that pushes every free body, and measures wall and CPU time of a step [s]."""
    rng = np.random.default_rng(0)

    def shake() -> tuple[float, float]:
        data.qvel[free[:, :3]] += rng.normal(0.0, 0.4, (len(free), 3))
        started = thread_time()
        took = timed(step)
        return took, thread_time() - started

    return shake


def frames() -> list[Row]:
    """Measure one RGB-D frame, with and without graphics."""
    world = furnished(50)
    rows = []
    for eye in (Eye(), Eye(graphics=False)):
        see = partial(eye.frame, world.model, world.data, "overview", 640, 480)
        times = [timed(see) for _ in range(20)]
        kind = "OpenGL" if eye.has_graphics else "rays"
        reach = 20.0 if eye.has_graphics else None
        rows.append(Row(f"RGB-D frame 640x480, 50 bodies, {kind}, p50", 1e3 * median(times[2:]), "ms", reach))
        rows.append(Row(f"RGB-D frame 640x480, 50 bodies, {kind}, fastest", 1e3 * min(times), "ms"))
    return rows
