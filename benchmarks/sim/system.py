"""The simulator in the whole system: `semmap up` with this process as its only client."""

from __future__ import annotations

import json
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from time import perf_counter, sleep, time_ns
from typing import Any

from benchmarks.kb.wire import running
from benchmarks.sim.generated_scenes import grid, p50_p95_ms
from benchmarks.table import Row
from semmap.nodes import bus
from semmap.nodes.extern.client import Client
from semmap.schemas import keys
from semmap.schemas.commits import Commit
from semmap.schemas.entities import Pose, distance_m
from semmap.schemas.scenes import Poses

CLASSES = ("Chair", "Table", "Can", "Book", "Cup", "Bottle", "Box", "Lamp", "Apple", "Plate")
_PITCH_M = 1.5
_PATIENCE_S = 120.0


class Watch:
    """Waits for conditions on published messages; it is notified of each message."""

    def __init__(self, client: Client) -> None:
        self._changed = threading.Condition()
        self.poses: Poses | None = None
        self.followed_ns: dict[str, int] = {}
        self._subscribers = [
            bus.follow(client.session, keys.POSES, self._on_poses),
            bus.follow(client.session, keys.COMMIT, self._on_commit),
        ]

    def close(self) -> None:
        """Unsubscribe."""
        for subscriber in self._subscribers:
            subscriber.undeclare()

    def wait(self, condition: Callable[[], Any]) -> None:
        """Wait until a condition holds, which is evaluated after each message."""
        with self._changed:
            if not self._changed.wait_for(condition, _PATIENCE_S):
                raise TimeoutError("the system did not get that far")

    def row(self, name: str) -> tuple[Pose, bool] | None:
        """Return the body's position, and whether it is at rest."""
        poses = self.poses
        if poses is None or name not in poses.names:
            return None
        row = poses.names.index(name)
        x, y, z, *_ = poses.poses[7 * row : 7 * row + 7]
        return Pose(position_m=(x, y, z)), poses.resting[row]

    def count(self) -> int:
        """Return the number of bodies."""
        return 0 if self.poses is None else len(self.poses.names)

    def _on_poses(self, _: str, poses: Poses) -> None:
        with self._changed:
            self.poses = poses
            self._changed.notify_all()

    def _on_commit(self, _: str, commit: Commit) -> None:
        with self._changed:
            for name in commit.names:
                self.followed_ns[name] = time_ns()
            self._changed.notify_all()


def measure(folder: Path, bodies: int, trials: int) -> list[Row]:
    """Measure the latencies from a command to its body and from a moved body to its commit."""
    with _empty_system(folder) as (client, watch):
        _load(client, folder, bodies)
        watch.wait(lambda: watch.count() == bodies)
        while (status := client.status()).in_agreement is None or status.pending:
            sleep(0.2)
        seen = [_until_seen(client, watch, f"new{i}") for i in range(trials)]
        moved = [_until_followed(client, watch, f"e{i % bodies}", i) for i in range(trials)]
    rests, hands = zip(*moved, strict=True)
    rows = []
    for what, times, reach in (
        (f"command to body in the poses, {bodies} bodies", seen, (60.0, 120.0)),
        (f"body said to rest to commit, {bodies} bodies", rests, (150.0, 300.0)),
        (f"hand's move, fall and rest to commit, {bodies} bodies", hands, (None, None)),
    ):
        rows += [
            Row(f"{what}, {name}", value, "ms", bound)
            for name, value, bound in zip(("p50", "p95"), p50_p95_ms(times), reach, strict=True)
        ]
    return rows


def load(folder: Path, entities: int, reach_s: float) -> Row:
    """Measure loading a map from a file, until its last body exists."""
    with _empty_system(folder) as (client, watch):
        started = perf_counter()
        _load(client, folder, entities)
        watch.wait(lambda: watch.count() == entities)
        took = perf_counter() - started
    return Row(f"load {entities} entities, command to all bodies", took, "s", reach_s)


@contextmanager
def _empty_system(folder: Path) -> Iterator[tuple[Client, Watch]]:
    """Yield a client of an empty system, which is created with the TBox of the shipped flat."""
    with running(folder) as (client, _):
        watch = Watch(client)
        try:
            client.clear()
            watch.wait(lambda: watch.poses is not None and not watch.poses.names)
            yield client, watch
        finally:
            watch.close()


def _load(client: Client, folder: Path, count: int) -> None:
    described = [
        {"class": CLASSES[i % len(CLASSES)], "name": f"e{i}", "at": [x, y, 0.0]}
        for i, x, y in grid(count, _PITCH_M)
    ]
    path = folder / "scene.json"
    path.write_text(json.dumps({"entities": described}))
    client.load(path)


def _until_seen(client: Client, watch: Watch, name: str) -> float:
    started = perf_counter()
    client.add("Chair", name, at=(-2.0, -2.0, 0.0))
    watch.wait(lambda: watch.row(name) is not None)
    took = perf_counter() - started
    client.remove(name)
    watch.wait(lambda: watch.row(name) is None)
    return took


def _until_followed(client: Client, watch: Watch, name: str, turn: int) -> tuple[float, float]:
    """Return the latency of the commit [s]: since the body was at rest, and since the move command.

    The first poses with the body at rest have the simulator's time stamp.
    """
    place = (-3.0 - 2.0 * (turn % 10), -3.0 - 2.0 * (turn // 10), 0.0)
    watch.followed_ns.pop(name, None)
    asked_ns, at_rest_ns = time_ns(), 0
    client.move(name, place, wait=False)

    def rests() -> bool:
        nonlocal at_rest_ns
        row = watch.row(name)
        there = row is not None and row[1] and distance_m(row[0], Pose(position_m=place)) < 0.2
        if there and not at_rest_ns and watch.poses is not None:
            at_rest_ns = watch.poses.stamp_ns
        return bool(at_rest_ns)

    watch.wait(rests)
    watch.wait(lambda: name in watch.followed_ns)
    followed_ns = watch.followed_ns[name]
    return (followed_ns - at_rest_ns) * 1e-9, (followed_ns - asked_ns) * 1e-9
