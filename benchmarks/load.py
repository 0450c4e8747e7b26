"""Many clients at once: `python -m benchmarks.load [--parts mixed,sessions,puts] [--seconds S]`.

*mixed*: clients in separate processes add, move, remove, get, list and query a map of many entities.
*sessions*: so many clients are connected at a time, and each asks. *puts*: two processes put commands as fast
as they can, while `status` is asked twenty times a second.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import tempfile
import time
from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from multiprocessing import get_context
from multiprocessing.pool import Pool
from pathlib import Path
from threading import Thread
from typing import Any

import psutil
import zenoh

from semmap.nodes import bus
from semmap.nodes.extern.client import Client, connect
from semmap.nodes.extern.testing import own_system
from semmap.nodes.supervisor.ports import free_endpoint
from semmap.schemas import codec, errors, keys
from semmap.schemas.replies import Ack

_UP = ("--abox", "none", "--no-sim", "--no-record", "--world", "empty")
_CLIENTS_A_PROCESS = 5
_OWN = 10
"""The maximum number of entities of a client; it removes the oldest before it adds another."""
_LOOK_S = 0.05
_LOOKS = 100
_LAST_ACK_S = 60.0

Times = dict[str, list[float]]
"""Durations by command [s]."""


def arguments() -> argparse.Namespace:
    """Parse the command line."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.load", description="Many clients at once.")
    parser.add_argument("--parts", default="mixed,sessions,puts")
    parser.add_argument("--entities", type=int, default=10_000)
    parser.add_argument("--clients", type=int, default=20)
    parser.add_argument(
        "--pause-ms", type=float, default=50.0, help="mean pause of a client after each reply"
    )
    parser.add_argument("--seconds", type=float, default=600.0)
    parser.add_argument("--sessions", type=int, default=500)
    parser.add_argument("--puts", type=int, default=50_000)
    parser.add_argument("--json", type=Path, metavar="FILE", dest="json_file")
    return parser.parse_args()


@contextmanager
def system(entities: int) -> Iterator[str]:
    """Start a system with `entities` entities; yield its endpoint."""
    endpoint = free_endpoint()
    with tempfile.TemporaryDirectory(prefix="semmap-load-") as folder:
        scene = Path(folder, "scene.json")
        side = int(entities**0.5) + 1
        cups = [
            {"name": f"cup{i}", "class": "Cup", "at": [2.0 * (i % side), 2.0 * (i // side), 0.0]}
            for i in range(entities)
        ]
        scene.write_text(json.dumps({"entities": cups}))
        with own_system(Path(folder, "data"), *_UP, endpoint=endpoint), connect(endpoint) as client:
            if entities:
                client.load(scene)
            yield endpoint


def memory_mb(client: Client) -> dict[str, float]:
    """Return the unique set size (USS) of each node with its children [MB]."""
    found = {}
    for node in client.status().nodes:
        process = psutil.Process(node.pid)
        found[node.node] = _uss_mb(process)
        if children := process.children(recursive=True):
            found[f"{node.node}'s children"] = round(sum(map(_uss_mb, children)), 1)
    return found


def _uss_mb(process: psutil.Process) -> float:
    try:
        return float(round(process.memory_full_info().uss / 1e6, 1))
    except psutil.NoSuchProcess:
        return 0.0


def figures(times: Times) -> dict[str, dict[str, float]]:
    """Return count, p50, p90, p99 and maximum [ms], by command."""
    table = {}
    for verb, took in sorted(times.items()):
        took = sorted(took)
        at = {f"p{p}": took[len(took) * p // 100] for p in (50, 90, 99)} | {"max": took[-1]}
        table[verb] = {"count": len(took), **{name: round(s * 1000, 1) for name, s in at.items()}}
    return table


def mixed(pool: Pool, endpoint: str, words: argparse.Namespace) -> dict[str, Any]:
    """Run clients with mixed commands."""
    shares = [
        min(_CLIENTS_A_PROCESS, words.clients - first)
        for first in range(0, words.clients, _CLIENTS_A_PROCESS)
    ]
    tasks = [
        pool.apply_async(
            _clients, (endpoint, count, number, words.seconds, words.pause_ms / 1000, words.entities)
        )
        for number, count in enumerate(shares)
    ]
    with connect(endpoint) as client:
        memory = []
        began_s = time.monotonic()
        while not all(task.ready() for task in tasks):
            memory.append((round(time.monotonic() - began_s), memory_mb(client)))
            time.sleep(max(2.0, words.seconds / 20))
        said = [task.get() for task in tasks]
        times: Times = defaultdict(list)
        failed: Counter[str] = Counter()
        for took, errors_ in said:
            failed.update(errors_)
            for verb, values in took.items():
                times[verb] += values
        warm = [m for s, m in memory if s > words.seconds * 0.2] or [memory[-1][1]]
        return {
            "verbs": figures(times),
            "errors": dict(failed),
            "memory_mb": {"after a fifth": warm[0], "half-way": warm[len(warm) // 2], "at the end": warm[-1]},
        }


def _clients(
    endpoint: str, count: int, number: int, seconds: float, pause_s: float, entities: int
) -> tuple[Times, dict[str, int]]:
    """Run several clients in turn in one process, each with its own session."""
    random_, times, failed = random.Random(number), defaultdict(list), Counter[str]()

    def one(client: Client, me: str) -> None:
        own: list[str] = []
        until_s, asked = time.monotonic() + seconds, 0
        while time.monotonic() < until_s:
            asked += 1
            verb, act = _act(client, random_, own, f"bowl_{me}_{asked}", entities)
            began_s = time.perf_counter()
            try:
                act()
            except errors.SemmapError as error:
                failed[f"{verb}: {error.text[:100]}"] += 1
            else:
                times[verb].append(time.perf_counter() - began_s)
            time.sleep(random_.expovariate(1.0 / pause_s) if pause_s else 0.0)

    with ExitStack() as stack:
        clients = [stack.enter_context(connect(endpoint)) for _ in range(count)]
        threads = [Thread(target=one, args=(client, f"{number}_{i}")) for i, client in enumerate(clients)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
    return dict(times), dict(failed)


def _act(client: Client, random_: random.Random, own: list[str], name: str, entities: int) -> tuple[str, Any]:
    """Return the next command of a client."""
    cup = f"cup{random_.randrange(max(1, entities))}"
    place = (random_.uniform(-500.0, -10.0), random_.uniform(-500.0, 500.0), 0.0)
    chance = random_.random()
    if chance < 0.35 and len(own) >= _OWN:
        return "remove", lambda: client.remove(own.pop(0))
    if chance < 0.35:
        return "add", lambda: own.extend(client.add("Bowl", name, at=place).names)
    if chance < 0.55 and own:
        mine = random_.choice(own)
        return "update", lambda: client.update(mine, at=place)
    if chance < 0.85:
        return "get", lambda: client.get(cup)
    if chance < 0.95:
        return "list", lambda: client.list("Bowl")
    return "sparql", lambda: client.sparql("ASK { ?s a dm:Cup }")


def sessions(endpoint: str, count: int) -> dict[str, Any]:
    """Measure many simultaneous sessions."""
    began_s, took, failed = time.monotonic(), [], Counter[str]()
    with ExitStack() as stack:
        clients = []
        for _ in range(count):
            try:
                clients.append(stack.enter_context(connect(endpoint)))
            except errors.SemmapError as error:
                failed[error.text[:100]] += 1
        open_s = time.monotonic() - began_s
        for client in clients:
            asked_s = time.perf_counter()
            try:
                client.get("cup0")
                took.append(time.perf_counter() - asked_s)
            except errors.SemmapError as error:
                failed[error.text[:100]] += 1
        memory = memory_mb(clients[0])
    return {
        "open": len(clients),
        "opened_in_s": round(open_s, 1),
        "get": figures({"get": took})["get"],
        "errors": dict(failed),
        "memory_mb": memory,
    }


def puts(pool: Pool, endpoint: str, count: int) -> dict[str, Any]:
    """Measure the outcome of each put, and the duration of `status` during and before them."""
    with connect(endpoint) as client:
        idle = [_status_s(client) for _ in range(_LOOKS)]
        before = client.status().commit
        halves = [pool.apply_async(_flood, (endpoint, who, count // 2)) for who in "ab"]
        took = []
        while not all(half.ready() for half in halves):
            took.append(_status_s(client))
        acks: Counter[str] = Counter()
        for half in halves:
            acks.update(half.get())
        commits = client.status().commit - before
        memory = memory_mb(client)
    return {
        "acknowledged": dict(acks),
        "commits": commits,
        "status": figures({"meanwhile": took, "before": idle}),
        "memory_mb": memory,
    }


def _status_s(client: Client) -> float:
    """Return the duration of a reply [s], then pause."""
    began_s = time.perf_counter()
    client.status()
    took_s = time.perf_counter() - began_s
    time.sleep(_LOOK_S)
    return took_s


def _flood(endpoint: str, who: str, count: int) -> dict[str, int]:
    """Send puts in one process; return the number of replies by outcome. The others are lost."""
    acks: dict[str, str] = {}

    def told(_: str, ack: Ack) -> None:
        if ack.id.startswith(who):
            acks[ack.id] = "done" if ack.error is None else ack.error.code

    with bus.open_session(bus.Network(connect=(endpoint,))) as session:
        bus.follow(session, keys.ACK, told)
        time.sleep(1.0)
        for number in range(count):
            session.put(
                f"{keys.CMD}/update",
                codec.encode({"id": f"{who}{number}", "name": "cup0", "ref": f"{who} {number}"}),
                congestion_control=zenoh.CongestionControl.BLOCK,
            )
        until_s = time.monotonic() + _LAST_ACK_S
        while len(acks) < count and time.monotonic() < until_s:
            time.sleep(0.1)
    return {**Counter(acks.values()), "lost": count - len(acks)}


def main(words: argparse.Namespace) -> dict[str, Any]:
    """Run the selected parts, one after another, on one system."""
    parts: Sequence[str] = words.parts.split(",")
    found: dict[str, Any] = {}
    processes = max(2, -(-words.clients // _CLIENTS_A_PROCESS))
    with get_context("spawn").Pool(processes) as pool, system(words.entities) as endpoint:
        if "mixed" in parts:
            found["mixed"] = mixed(pool, endpoint, words)
        if "sessions" in parts:
            found["sessions"] = sessions(endpoint, words.sessions)
        if "puts" in parts:
            found["puts"] = puts(pool, endpoint, words.puts)
    found["load_average"] = os.getloadavg()
    return found


if __name__ == "__main__":
    chosen = arguments()
    measured = main(chosen)
    print(json.dumps(measured, indent=1))
    if chosen.json_file is not None:
        chosen.json_file.write_text(json.dumps(measured))
