"""The cost of live poses: many tracked things at 50 Hz each, published from another process."""

from __future__ import annotations

import json
import math
import multiprocessing
import time
from multiprocessing.sharedctypes import Synchronized
from pathlib import Path

import psutil

from benchmarks.kb.wire import running
from benchmarks.table import Row
from semmap.nodes.extern.client import Client, connect

_RADIUS_M = 3.0
_TURN_RAD_S = 0.3
_SETTLE_S = 3.0


def measure(folder: Path, things: int = 100, rate_hz: float = 50.0, seconds: float = 15.0) -> list[Row]:
    """The CPU shares of coordinator and knowledge base, the commits, and the age of poses."""
    with running(folder, "--no-sim") as (client, _):
        client.clear()
        _load(client, folder, things)
        nodes = {status.node: psutil.Process(status.pid) for status in client.status().nodes}
        idle = _shares(nodes, seconds / 3)
        endpoint = json.loads((folder / "settings.json").read_text())["listen"]
        spawning = multiprocessing.get_context("spawn")
        rounds = spawning.Value("i", 0)
        publishing = spawning.Process(
            target=publish, args=(endpoint, things, rate_hz, seconds + 2 * _SETTLE_S, rounds)
        )
        publishing.start()
        try:
            time.sleep(_SETTLE_S)
            commits, published = client.status().commit, rounds.value
            busy = _shares(nodes, seconds)
            published = (rounds.value - published) * things
            commits = client.status().commit - commits
            ages = [_age_s(client, f"e{i}") for i in range(min(20, things))]
            took_ms = [_asked_ms(client) for _ in range(20)]
        finally:
            publishing.join()
    of = f"{things} tracked things at {rate_hz:g} Hz"
    return [
        Row(f"{of}: share of one core, coordinator", busy["coordinator"], "", 0.12, 0.07),
        Row("  of that at rest, without them", idle["coordinator"], ""),
        Row("  share of one core, knowledge base", busy["kb_node"], ""),
        Row("  live poses that were published", published / seconds, "/s"),
        Row("  commits", float(commits), "", 0.0, 0.0),
        Row("  age of a pose that is asked for, most of 20", max(ages), "s"),
        Row("  list --nearest 3 --to one of them, p50", sorted(took_ms)[10], "ms"),
    ]


def publish(endpoint: str, things: int, rate_hz: float, seconds: float, rounds: Synchronized[int]) -> None:
    """Publish poses on circles; `rounds` counts the publications of each."""
    with connect(endpoint) as client:
        started = time.monotonic()
        while (now_s := time.monotonic() - started) < seconds:
            turned = _TURN_RAD_S * now_s
            for i in range(things):
                at = (3.0 * i + _RADIUS_M * math.cos(turned), _RADIUS_M * math.sin(turned), 0.0)
                client.publish_pose(f"e{i}", at, yaw=turned)
            rounds.value += 1
            time.sleep(max(0.0, started + rounds.value / rate_hz - time.monotonic()))


def _load(client: Client, folder: Path, things: int) -> None:
    described = [{"class": "Robot", "name": f"e{i}", "at": [3.0 * i, 0.0, 0.0]} for i in range(things)]
    path = folder / "scene.json"
    path.write_text(json.dumps({"entities": described}))
    client.load(path)
    for i in range(things):
        client.track(f"e{i}")


def _shares(nodes: dict[str, psutil.Process], seconds: float) -> dict[str, float]:
    """Return each node's share of one core over a duration."""
    before = {name: sum(process.cpu_times()[:2]) for name, process in nodes.items()}
    started = time.monotonic()
    time.sleep(seconds)
    passed_s = time.monotonic() - started
    return {name: (sum(p.cpu_times()[:2]) - before[name]) / passed_s for name, p in nodes.items()}


def _age_s(client: Client, name: str) -> float:
    live = client.get(name).live
    return math.inf if live is None else live.age_s


def _asked_ms(client: Client) -> float:
    started = time.perf_counter()
    client.list(nearest=3, to="e1")
    return (time.perf_counter() - started) * 1e3
