"""The whole system live: the latency from a new thing in view to its entity in the map."""

from __future__ import annotations

import math
import random
import signal
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from statistics import median
from typing import NamedTuple

from benchmarks.perception.table import Row
from semmap.nodes import bus
from semmap.nodes.extern.client import Client, connect
from semmap.schemas import keys
from semmap.schemas.commits import Commit
from semmap.schemas.entities import Entity, Pose
from semmap.schemas.scenes import BodyOrder, Delete, Deleted, Spawn, Spawned

_TABLE_Z = 0.74
_PATIENCE_S = 30.0
_THINGS = ("bottle", "cup", "box", "can", "vase", "bowl")
_WORLD = f"""<mujoco>
<visual><quality shadowsize="0" offsamples="0"/><headlight ambient=".4 .4 .4" diffuse=".5 .5 .5"/></visual>
<worldbody>
<light pos="0 0 3" dir="0 0 -1"/>
<geom name="floor" type="plane" size="4 4 .1" rgba=".8 .78 .72 1"/>
<geom name="top" type="box" size=".6 .4 .02" pos="0 0 {_TABLE_Z - 0.02}" rgba=".55 .4 .3 1"/>
<camera name="left" pos="-.9 -.9 1.6" xyaxes=".707 -.707 0 .4 .4 .82" fovy="45"/>
<camera name="right" pos=".9 -.9 1.6" xyaxes=".707 .707 0 -.4 .4 .82" fovy="45"/>
</worldbody></mujoco>"""


class Latency(NamedTuple):
    """Latencies from the placement of each new body [s]; `missed` bodies never became an entity."""

    seconds: tuple[float, ...]
    missed: int
    look_ms: float
    """The duration of one observation with two cameras at the end."""


def measure() -> list[Row]:
    """The rows of the table."""
    with tempfile.TemporaryDirectory() as folder:
        latency = new_things(Path(folder))
    return [
        Row(
            "new object in view to entity in the map, median",
            median(latency.seconds),
            "s",
            1.5,
            1.0,
            less=True,
        ),
        Row("new object in view to entity in the map, worst", max(latency.seconds), "s"),
        Row("new objects that never became entities", latency.missed, "of 10"),
        Row("a look of two cameras, live", latency.look_ms, "ms"),
    ]


def new_things(folder: Path, things: int = 10) -> Latency:
    """Place one thing after another on a table of a running system, and remove it again."""
    random_ = random.Random(3)
    seconds: list[float | None] = []
    with _running(folder) as client:
        known: dict[str, Entity] = {}

        def on_commit(_: str, commit: Commit) -> None:
            known.update({entity.name: entity for entity in commit.changed})
            for gone in commit.removed:
                known.pop(gone.name, None)

        bus.follow(client.session, keys.COMMIT, on_commit)
        _until(lambda: " seen, " in _detail(client), every_s=0.5)
        for n in range(things):
            at = (random_.uniform(-0.4, 0.4), random_.uniform(-0.25, 0.25))
            model = _THINGS[n % len(_THINGS)]
            pose = Pose(position_m=(*at, _TABLE_Z + 0.002))
            body = BodyOrder(name=f"body{n}", class_="Object", model=model, pose=pose, commit=0)
            bus.ask(client.session, keys.SIM, "spawn", Spawn(bodies=(body,)), Spawned)
            seconds.append(_until(partial(_is_there, known, at)))
            bus.ask(client.session, keys.SIM, "delete", Delete(names=(body.name,)), Deleted)
            _until(partial(_is_gone, known, at))
        look_ms = float(_detail(client).rpartition("seen, ")[2].split(" ")[0])
    return Latency(tuple(s for s in seconds if s is not None), seconds.count(None), look_ms)


def _is_there(known: dict[str, Entity], at: tuple[float, float]) -> bool:
    """Return whether the map has a small thing there."""
    return any(
        math.dist(e.pose.position_m[:2], at) < 0.08
        for e in list(known.values())
        if e.pose is not None and e.pose.position_m[2] > _TABLE_Z / 2.0
    )


def _detail(client: Client) -> str:
    return next((n.detail for n in client.status().nodes if n.node == "perception_node"), "")


def _is_gone(known: dict[str, Entity], at: tuple[float, float]) -> bool:
    return not _is_there(known, at)


def _until(condition: Callable[[], bool], every_s: float = 0.01) -> float | None:
    """Return the time until a condition holds [s], or None after the timeout."""
    started = time.monotonic()
    while not condition():
        if time.monotonic() - started > _PATIENCE_S:
            return None
        time.sleep(every_s)
    return time.monotonic() - started


@contextmanager
def _running(folder: Path) -> Iterator[Client]:
    """Start a system with a table, two cameras, and perception as the source of truth."""
    world = folder / "world.xml"
    world.write_text(_WORLD)
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        endpoint = f"tcp/127.0.0.1:{probe.getsockname()[1]}"
    words = ["up", "--data", str(folder / "data"), "--listen", endpoint, "--abox", "none", "--no-record"]
    words += ["--world", str(world), "--truth", "perceived", "--perception"]
    command = [str(Path(sys.executable).with_name("semmap")), *words]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as process:
        try:
            assert process.stdout is not None
            for line in process.stdout:
                if line.startswith("stop "):
                    break
            with connect(endpoint) as client:
                yield client
        finally:
            process.send_signal(signal.SIGINT)
            process.wait(30)
