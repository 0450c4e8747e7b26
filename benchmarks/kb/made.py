"""Generated household entities of the usual shape: 20 triples each, with individual coordinates."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from statistics import median, quantiles
from time import perf_counter, process_time, thread_time
from typing import Any, NamedTuple

from semmap.nodes.kb_node.documents import rdf
from semmap.ontology import HOUSEHOLD_TTL, entity_triples
from semmap.ontology import vocabulary as v
from semmap.schemas.entities import Pose
from semmap.schemas.explanations import Triple

CLASSES = ("Chair", "Table", "Bottle", "Book", "Lamp", "Cup", "Fridge", "Window")
Figures = dict[str, float]
_APART_M = 3.0


def tbox() -> list[Triple]:
    """The household TBox."""
    return rdf.parse(Path(HOUSEHOLD_TTL).read_bytes(), str(HOUSEHOLD_TTL))


def pose(random_: random.Random) -> Pose:
    """Return a position within 1.5 km, 3 m from all others, so that things of up to 2 m do not overlap."""
    x, y = (_APART_M * random_.randrange(-500, 500) + _number(random_, 0, 0.9) for _ in range(2))
    return Pose(position_m=(round(x, 4), round(y, 4), 0.0))


def star(name: str, class_name: str, random_: random.Random) -> list[Triple]:
    """Return the triples of one entity with position, size, a label and an alias."""
    return entity_triples.describe(
        name,
        v.dm(class_name),
        pose=pose(random_),
        size_m=(_number(random_, 0.1, 2), _number(random_, 0.1, 2), _number(random_, 0.1, 2)),
        preferred=class_name.lower(),
        alternatives=(f"the {class_name.lower()}",),
    )


def entities(count: int, random_: random.Random, prefix: str = "e") -> Iterator[list[Triple]]:
    """Yield the triples of entities; the i-th is of class `CLASSES[i % 8]` and named `<prefix><i>`."""
    return (star(f"{prefix}{i}", CLASSES[i % len(CLASSES)], random_) for i in range(count))


def timed(act: Callable[[], object]) -> float:
    """Return the duration [s]."""
    started = perf_counter()
    act()
    return perf_counter() - started


class Cost(NamedTuple):
    """The wall time and this process's CPU time of one long action [s]."""

    wall_s: float
    cpu_s: float


def cost(act: Callable[[], object]) -> Cost:
    """Return the wall time and CPU time of an action."""
    cpu = process_time()
    wall_s = timed(act)
    return Cost(wall_s, process_time() - cpu)


def percentiles(times_s: list[float]) -> Figures:
    """Return median and 99th percentile [ms]."""
    p99 = quantiles(times_s, n=100, method="inclusive")[98] if len(times_s) > 1 else times_s[0]
    return {"p50_ms": median(times_s) * 1e3, "p99_ms": p99 * 1e3}


def each(items: Iterable[Any], act: Callable[[Any], object]) -> Figures:
    """Return `percentiles` of the wall time and of this thread's CPU time of `act(item)`.

    On a busy machine the two differ, mainly in the 99th percentile.
    """
    wall_s, cpu_s = [], []
    for item in items:
        cpu, wall = thread_time(), perf_counter()
        act(item)
        wall_s.append(perf_counter() - wall)
        cpu_s.append(thread_time() - cpu)
    return percentiles(wall_s) | {f"cpu_{name}": value for name, value in percentiles(cpu_s).items()}


def _number(random_: random.Random, low: float, high: float) -> float:
    return round(random_.uniform(low, high), 4)
