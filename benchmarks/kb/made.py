"""Made-up entities of the usual shape over the household TBox: a star of 20 triples, coordinates its own."""

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
    """Somewhere within 1.5 km, 3 m from any other place: things of up to 2 m do not stand in one another."""
    x, y = (_APART_M * random_.randrange(-500, 500) + _number(random_, 0, 0.9) for _ in range(2))
    return Pose(position_m=(round(x, 4), round(y, 4), 0.0))


def star(name: str, class_name: str, random_: random.Random) -> list[Triple]:
    """One entity with position, size, a preferred and an alternative reference."""
    return entity_triples.describe(
        name,
        v.dm(class_name),
        pose=pose(random_),
        size_m=(_number(random_, 0.1, 2), _number(random_, 0.1, 2), _number(random_, 0.1, 2)),
        preferred=class_name.lower(),
        alternatives=(f"the {class_name.lower()}",),
    )


def entities(count: int, random_: random.Random, prefix: str = "e") -> Iterator[list[Triple]]:
    """So many stars; the i-th is of class `CLASSES[i % 8]` and named `<prefix><i>`."""
    return (star(f"{prefix}{i}", CLASSES[i % len(CLASSES)], random_) for i in range(count))


def timed(act: Callable[[], object]) -> float:
    """How long it takes [s]."""
    started = perf_counter()
    act()
    return perf_counter() - started


class Cost(NamedTuple):
    """What one long act took: by the clock on the wall, and of this process's CPU time, in seconds."""

    wall_s: float
    cpu_s: float


def cost(act: Callable[[], object]) -> Cost:
    """What it takes."""
    cpu = process_time()
    wall_s = timed(act)
    return Cost(wall_s, process_time() - cpu)


def percentiles(times_s: list[float]) -> Figures:
    """Median and 99th percentile [ms]; of a single time, that time."""
    p99 = quantiles(times_s, n=100, method="inclusive")[98] if len(times_s) > 1 else times_s[0]
    return {"p50_ms": median(times_s) * 1e3, "p99_ms": p99 * 1e3}


def each(items: Iterable[Any], act: Callable[[Any], object]) -> Figures:
    """`percentiles` of `act(item)`: as the clock on the wall has it, and of this thread's own CPU time.

    On a machine that is busy with other things the two differ, most of all in the 99th percentile.
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
