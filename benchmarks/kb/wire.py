"""The whole system over Zenoh: `semmap up` with this process as its only client."""

from __future__ import annotations

import queue
import random
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import psutil

from benchmarks.kb.busy_cores import awake_cores
from benchmarks.kb.made import CLASSES, Figures, each, pose
from semmap.nodes import bus
from semmap.nodes.extern.client import Client
from semmap.nodes.extern.testing import own_system
from semmap.schemas import commands, keys, replies

IN_FLIGHT = 32


class Wire(NamedTuple):
    """Client-side figures. Single commands are measured with one request in flight."""

    entities: int
    sim: bool
    start_s: float
    """From `semmap up` until the system is ready, including the start of all processes."""
    add: Figures
    move: Figures
    awake_add: Figures
    """The same while no core sleeps."""
    awake_move: Figures
    sustained_moves_per_s: float
    list_all: Figures
    sparql: Figures
    memory_kb: dict[str, float]


def measure(folder: Path, size: int, *, sim: bool, repeat: int) -> Wire:
    """Serve the journal in `folder`, of `size` entities named `e<i>`, and send it commands."""
    random_ = random.Random(size)
    with running(folder, *([] if sim else ["--no-sim"])) as (client, start_s):
        if sim:
            _settle(client)
        names = [f"e{random_.randrange(size)}" for _ in range(repeat)]
        for name in names[:20]:
            client.update(name, at=pose(random_).position_m)
        add = each(range(repeat), lambda i: _add(client, f"new{i}", i, random_))
        move = each(names, lambda name: client.update(name, at=pose(random_).position_m))
        with awake_cores():
            awake_add = each(range(repeat), lambda i: _add(client, f"newer{i}", i, random_))
            awake_move = each(names, lambda name: client.update(name, at=pose(random_).position_m))
        moves_per_s = _sustained(client, [f"e{i % size}" for i in range(4 * repeat)], random_)
        list_all = each(range(5), lambda _: client.list())
        return Wire(
            size,
            sim,
            start_s,
            add,
            move,
            awake_add,
            awake_move,
            moves_per_s,
            list_all,
            _sparql(client, repeat),
            _memory(client),
        )


def _add(client: Client, name: str, i: int, random_: random.Random) -> None:
    class_name = CLASSES[i % len(CLASSES)]
    client.add(class_name, name, at=pose(random_).position_m, size=(0.5, 0.5, 0.5), ref=class_name.lower())


def _sustained(client: Client, names: list[str], random_: random.Random) -> float:
    """Return durable moves per second, with `IN_FLIGHT` at a time and none rejected."""
    answers: queue.SimpleQueue[Callable[[], Any]] = queue.SimpleQueue()

    def send(name: str) -> None:
        command = commands.Update(name=name, at=pose(random_).position_m)
        bus.ask_later(client.session, keys.CMD, "update", command, replies.Changed, answers.put)

    def receive() -> None:
        answers.get(timeout=bus.TIMEOUT_S)()

    started = time.perf_counter()
    for i, name in enumerate(names):
        if i >= IN_FLIGHT:
            receive()
        send(name)
    for _ in names[-IN_FLIGHT:]:
        receive()
    return len(names) / (time.perf_counter() - started)


def _sparql(client: Client, repeat: int) -> Figures:
    """Query the classes of one entity by its IRI."""
    query = f"SELECT ?class WHERE {{ <{client.get('e1').iri}> a ?class }}"
    return each(range(repeat), lambda _: client.sparql(query))


def _settle(client: Client) -> None:
    """Wait until every entity has its body."""
    while (status := client.status()).in_agreement is None or status.pending:
        time.sleep(0.5)


def _memory(client: Client) -> dict[str, float]:
    """Return the resident memory of each node [kB]."""
    nodes = client.status().nodes
    return {n.node: psutil.Process(n.pid).memory_info().rss / 1024 for n in nodes}


@contextmanager
def running(folder: Path, *words: str) -> Iterator[tuple[Client, float]]:
    """A client of `semmap up` with the journal in `folder`, and how long the start took [s]."""
    started = time.perf_counter()
    with own_system(folder, "--no-record", "--world", "empty", *words) as client:
        yield client, time.perf_counter() - started
