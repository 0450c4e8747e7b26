"""How fast the simulator is by itself: `python -m benchmarks.sim [--json FILE] [--minutes N]`."""

from __future__ import annotations

import gc
import json
import math
import time
from collections.abc import Callable
from pathlib import Path
from statistics import median
from typing import Annotated

import mujoco
import numpy as np
import psutil
import typer

from nodes.sim_node.vision.camera import Eye
from nodes.sim_node.world import World
from schemas.entities import Pose
from schemas.scenes import BodyOrder, Placement

MODELS = ("chair", "table", "can", "book", "cup", "bottle", "box", "lamp", "apple", "plate")
STEP_S = 0.05

Row = tuple[str, float, str, float]
"""What, the number, its unit, what is to be reached."""


def order(name: str, model: str, x: float, y: float, z: float = 0.0) -> BodyOrder:
    """A body to be made."""
    return BodyOrder(name=name, class_=model.title(), model=model, pose=Pose(position_m=(x, y, z)), commit=1)


def furnished(count: int, pitch_m: float = 1.5) -> tuple[World, float]:
    """A world with `count` bodies on a grid, in one spawn, and how long that took [s]."""
    world, side = World(), math.isqrt(count) + 1
    orders = [
        order(f"b{i}", MODELS[i % len(MODELS)], pitch_m * (i % side), pitch_m * (i // side))
        for i in range(count)
    ]
    took = timed(lambda: world.spawn(orders))
    world.step(2.0)
    return world, took


def timed(act: Callable[[], object]) -> float:
    """How long it takes [s]."""
    started = time.perf_counter()
    act()
    return time.perf_counter() - started


def spawn_and_delete(count: int, reach_ms: float, trials: int = 15) -> list[Row]:
    """One body more and one less, beside `count` others at rest."""
    world, _ = furnished(count)
    spawns, deletes = [], []
    for trial in range(trials):
        newcomer = order(f"new{trial}", "chair", -2.0, -2.0)
        spawns.append(timed(lambda newcomer=newcomer: world.spawn([newcomer])))
        world.step(STEP_S)
        deletes.append(timed(lambda newcomer=newcomer: world.delete([newcomer.name])))
        world.step(STEP_S)
    return [
        (f"spawn beside {count} bodies, p50", 1e3 * median(spawns), "ms", reach_ms),
        (f"delete beside {count} bodies, p50", 1e3 * median(deletes), "ms", reach_ms),
    ]


def real_time_factors() -> list[Row]:
    """A hundred bodies asleep, and a hundred that are pushed ten times a second."""
    world, _ = furnished(100, pitch_m=0.8)
    steps = round(10.0 / world.model.opt.timestep)
    engine = 10.0 / timed(lambda: mujoco.mj_step(world.model, world.data, nstep=steps))
    asleep = 1000.0 / timed(lambda: world.step(1000.0))
    rng = np.random.default_rng(0)
    took = 0.0
    for _ in range(20):
        for address in range(0, world.model.nv, 6):
            world.data.qvel[address : address + 3] += rng.normal(0.0, 0.4, 3)
        took += timed(lambda: world.step(0.1))
    return [
        ("real-time factor, 100 bodies at rest", asleep, "x", 100.0),
        ("real-time factor, 100 bodies at rest, engine alone", engine, "x", 100.0),
        ("real-time factor, 100 bodies being shaken", 2.0 / took, "x", 4.0),
    ]


def frames() -> list[Row]:
    """One RGB-D frame, with graphics and without."""
    world, _ = furnished(50)
    rows: list[Row] = []
    for eye in (Eye(), Eye(graphics=False)):
        trials = [
            timed(lambda eye=eye: eye.frame(world.model, world.data, "overview", 640, 480)) for _ in range(12)
        ]
        kind = "OpenGL" if eye.has_graphics else "rays"
        rows.append((f"RGB-D frame 640x480, 50 bodies, {kind}", 1e3 * median(trials[2:]), "ms", 20.0))
    return rows


def loads() -> list[Row]:
    """A whole map at once."""
    return [
        (f"spawn {count} bodies at once", furnished(count)[1], "s", reach)
        for count, reach in ((200, 3.0), (2000, 30.0))
    ]


def endurance(minutes: float) -> list[Row]:
    """Random spawns, moves and deletes, once a simulated second; memory after a twelfth is the measure."""
    world, rng = World(), np.random.default_rng(0)
    process, baseline = psutil.Process(), 0
    rounds = int(60 * minutes)
    for turn in range(rounds):
        names = list(world.poses().names)
        x, y = (float(v) for v in rng.uniform(-5.0, 5.0, 2))
        choice = rng.integers(3)
        if choice == 0 or len(names) < 20:
            world.spawn([order(f"b{turn}", str(rng.choice(MODELS)), x, y)])
        elif choice == 1 or len(names) > 60:
            world.delete([str(rng.choice(names))])
        else:
            world.move([Placement(name=str(rng.choice(names)), pose=Pose(position_m=(x, y, 0.5)))])
        world.step(1.0)
        if turn == rounds // 12:
            gc.collect()
            baseline = process.memory_info().rss
    gc.collect()
    growth = 100.0 * (process.memory_info().rss / baseline - 1.0)
    return [(f"growth of memory over {minutes:g} simulated minutes", growth, "%", 10.0)]


def main(
    json_file: Annotated[Path | None, typer.Option("--json")] = None,
    minutes: Annotated[float, typer.Option(help="simulated minutes of random spawn, move and delete")] = 60.0,
) -> None:
    """Measure, print a table, and write it as JSON too if asked."""
    rows: list[Row] = []
    for count, reach_ms in ((10, 2.0), (100, 5.0), (500, 35.0)):
        rows += spawn_and_delete(count, reach_ms)
    rows += real_time_factors() + frames() + loads() + endurance(minutes)
    for what, value, unit, reach in rows:
        print(f"{what:55} {value:10.2f} {unit:3} (to reach: {reach:g})")
    if json_file:
        table = [
            {"what": what, "value": value, "unit": unit, "reach": reach} for what, value, unit, reach in rows
        ]
        json_file.write_text(json.dumps(table, indent=1) + "\n")


if __name__ == "__main__":
    typer.run(main)
