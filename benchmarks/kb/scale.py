"""Very many entities in one system: loading, memory, start, first and later queries, lists, adds."""

from __future__ import annotations

import math
import random
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from statistics import median
from typing import NamedTuple

import psutil

from benchmarks.kb import big_files, limits
from benchmarks.kb.made import timed
from semmap.nodes.extern.client import Client
from semmap.nodes.extern.testing import own_system
from semmap.nodes.supervisor.ports import free_endpoint
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.replies import NodeStatus

_UP = ("--abox", "none", "--no-sim", "--no-record", "--world", "empty")
_COUNTED = "Cup"
_REPEAT = 100
_LARGE = 100_000
_QUIET_S = 10.0
_CHECKED_UP_TO = 100_000
_JSON_UP_TO = 100_000
"""The maximum number of entities for JSON scenes; larger ones are measured as Turtle only."""
_IDLE_S = 0.2
"""CPU time per second of an idle node that only sends heartbeats."""


class Scale(NamedTuple):
    """Figures of a map with 14 triples per entity: times in seconds, memory of all processes in MB."""

    entities: int
    load_turtle_s: float
    load_json_s: float | None
    memory_loaded_mb: float
    cpu_of_load_s: dict[str, float]
    """CPU time of loading Turtle in each node, which depends less on other load than wall time."""
    first_sparql_after_load_s: float
    memory_queried_mb: float
    """Including the SPARQL store."""
    memory_of_nodes_mb: dict[str, float]
    start_s: float
    """From `semmap up` until the reply to `get`."""
    cpu_of_start_s: dict[str, float]
    first_sparql_s: float
    """The first query after that start: a count."""
    sparql_s: float
    sparql_by_command_line_s: float
    list_class_s: float
    """Listing one percent of the entities, by the client."""
    early_add_ms: float
    """While the knowledge base still computes the spatial relations."""
    add_ms: float
    update_ms: float
    check_s: float | None
    """`check` without a cache, by the client."""
    limits: limits.Limits
    """The limits of the loads, in the same run."""


def measure(folder: Path, size: int) -> Scale:
    """Measure a system in `folder` that is filled from a file, stopped and started again."""
    turtle, scene = folder / "things.ttl", folder / "things.json"
    load_json_s = None
    if size <= _JSON_UP_TO:
        big_files.write_json(scene, size)
        with _running(folder / "json") as (client, _):
            load_json_s = timed(lambda: client.load(scene))
        shutil.rmtree(folder / "json")
    big_files.write_turtle(turtle, size)
    least = limits.measure(folder, size, turtle, scene if scene.exists() else None)
    scene.unlink(missing_ok=True)
    data = folder / "turtle"
    with _running(data) as (client, _):
        load_turtle_s = timed(lambda: client.load(turtle))
        cpu_of_load_s = _cpu_s(client)
        memory_loaded = sum(_memory_mb(client).values())
        counted = big_files.count_of(_COUNTED, size)
        first_after_load_s = timed(lambda: _require_count(client, counted))
        memory_of_nodes = _memory_mb(client)
        if size >= _LARGE:
            time.sleep(_QUIET_S)  # in which the knowledge base begins to write its checkpoint
    turtle.unlink()
    name = f"thing{size // 2}"
    began_s = time.perf_counter()
    with _running(data) as (client, endpoint):
        client.get(name)
        start_s = time.perf_counter() - began_s
        cpu_of_start_s = _cpu_s(client)
        first_sparql_s = timed(lambda: _require_count(client, counted))
        random_ = random.Random(size)
        early = [timed(lambda i=i: _add(client, i, random_)) for i in range(_REPEAT)]  # type: ignore[misc]
        rare = [timed(lambda: client.list(big_files.RARE_CLASS)) for _ in range(10)]
        later = [timed(lambda: _require_count(client, counted)) for _ in range(10)]
        spoken = [timed(lambda: _count_by_command_line(endpoint, counted)) for _ in range(5)]
        check_s = timed(client.check) if size <= _CHECKED_UP_TO else None
        _wait_until_quiet(client)
        more = range(_REPEAT, 2 * _REPEAT)
        adds = [timed(lambda i=i: _add(client, i, random_)) for i in more]  # type: ignore[misc]
        names = [f"thing{random_.randrange(size)}" for _ in range(_REPEAT)]
        updates = [timed(lambda n=n: client.update(n, at=_place(random_))) for n in names]  # type: ignore[misc]
    return Scale(
        entities=size,
        load_turtle_s=load_turtle_s,
        load_json_s=load_json_s,
        memory_loaded_mb=memory_loaded,
        cpu_of_load_s=cpu_of_load_s,
        first_sparql_after_load_s=first_after_load_s,
        memory_queried_mb=sum(memory_of_nodes.values()),
        memory_of_nodes_mb=memory_of_nodes,
        start_s=start_s,
        cpu_of_start_s=cpu_of_start_s,
        first_sparql_s=first_sparql_s,
        sparql_s=median(later),
        sparql_by_command_line_s=median(spoken),
        list_class_s=median(rare),
        early_add_ms=median(early) * 1e3,
        add_ms=median(adds) * 1e3,
        update_ms=median(updates) * 1e3,
        check_s=check_s,
        limits=least,
    )


@contextmanager
def _running(data: Path) -> Iterator[tuple[Client, str]]:
    """Start a system on `data`; yield a client and its endpoint. An existing map is used."""
    endpoint = free_endpoint()
    with own_system(data, *_UP, endpoint=endpoint) as client:
        yield client, endpoint


def _query(class_name: str) -> str:
    return f"SELECT (COUNT(?thing) AS ?n) WHERE {{ ?thing a {v.dm(class_name)} }}"


def _require_count(client: Client, count: int) -> None:
    ((found,),) = client.sparql(_query(_COUNTED), timeout=60.0).rows
    if found is None or v.lexical(found) != str(count):
        raise AssertionError(f"{found} things of class {_COUNTED}, not {count}")


def _count_by_command_line(endpoint: str, count: int) -> None:
    semmap = str(Path(sys.executable).with_name("semmap"))
    command = [semmap, "sparql", _query(_COUNTED), "--connect", endpoint]
    said = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    if str(count) not in said:
        raise AssertionError(f"the command line said: {said}")


def _wait_until_quiet(client: Client) -> None:
    """Wait until the knowledge base is idle after its start."""
    before_s = math.inf
    while (now_s := _cpu_s(client)["kb_node"]) - before_s > _IDLE_S or before_s == math.inf:
        before_s = now_s
        time.sleep(1.0)


def _add(client: Client, i: int, random_: random.Random) -> None:
    client.add("Chair", f"new{i}", at=_place(random_), size=(0.5, 0.5, 1.0), ref="chair")


def _place(random_: random.Random) -> tuple[float, float, float]:
    return (random_.uniform(-100, 0), random_.uniform(-100, 0), 0.0)


def _cpu_s(client: Client) -> dict[str, float]:
    """Return the CPU time of each node since its start, without its children."""
    return {node.node: sum(psutil.Process(node.pid).cpu_times()[:2]) for node in _nodes(client)}


def _memory_mb(client: Client) -> dict[str, float]:
    """Return the proportional set size of each node with its children; shared pages count once."""
    found: dict[str, float] = {}
    for node in _nodes(client):
        process = psutil.Process(node.pid)
        family = [process, *process.children(recursive=True)]
        found[node.node] = sum(_pss_mb(p) for p in family)
    return found


def _pss_mb(process: psutil.Process) -> float:
    """Return the proportional set size, or 0 if the process has ended."""
    try:
        return float(process.memory_full_info().pss / 1e6)
    except psutil.NoSuchProcess:
        return 0.0


def _nodes(client: Client) -> Sequence[NodeStatus]:
    deadline_s = time.monotonic() + 60.0
    while True:
        try:
            return client.status().nodes
        except errors.NoAnswer:
            if time.monotonic() > deadline_s:
                raise
