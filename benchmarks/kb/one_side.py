"""One version's side of a comparison: executes commands from stdin and prints the durations in JSON.

    PYTHONPATH=<its root> python -P <this file> core 10000
    PYTHONPATH=<its root> python -P <this file> wire FOLDER 10000 [TBOX]
    PYTHONPATH=<its root> python -P <this file> university 120000 <benchmarks/kb/university.py>

It uses only functions that both versions have.
"""

from __future__ import annotations

import importlib.util
import json
import random
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import psutil

from benchmarks.kb import disk, engine, made, wire
from semmap.nodes.extern.client import Client
from semmap.nodes.extern.testing import own_system
from semmap.nodes.kb_node.reasoner import Reasoner

_UP = ("--no-record", "--world", "empty", "--no-sim")


def core(size: int) -> Iterator[Callable[[str, int], Any]]:
    """Measure the engine alone; each round has adds, moves, rejections and removals: medians in ms."""
    random_ = random.Random(size)
    reasoner = Reasoner(made.tbox())
    for first in range(0, size, 1000):
        chunk = made.entities(min(1000, size - first), random_, f"m{first}_")
        reasoner.apply(insert=[triple for star in chunk for triple in star])

    def round_(word: str, count: int) -> dict[str, float]:
        new = list(made.entities(count, random_, word))
        moves = [engine._position(star, random_) for star in new]
        wrong = [engine._kitchen(star) for star in made.entities(count, random_, "r")]
        gone = [[t for t in s if t not in old] + now for s, (old, now) in zip(new, moves, strict=True)]
        took = {
            "add": made.each(new, lambda star: reasoner.apply(insert=star)),
            "move": made.each(moves, lambda change: reasoner.apply(delete=change[0], insert=change[1])),
            "refuse": made.each(wrong, lambda star: engine._refused(reasoner, star)),
            "remove": made.each(gone, lambda star: reasoner.apply(delete=star)),
        }
        return {what: figures["p50_ms"] for what, figures in took.items()}

    yield round_


def system(folder: Path, size: int, tbox: Path | None) -> Iterator[Callable[[str, int], Any]]:
    """Measure a whole system with one client: each duration in ms, or moves per second.

    Also measures the CPU time per command in all processes including this one [ms].
    """
    disk.prepare(folder, size, *([tbox] if tbox else []))
    random_, live = random.Random(), list[str]()
    with own_system(folder, *_UP) as client:
        processes = [psutil.Process(), *(psutil.Process(node.pid) for node in client.status().nodes)]

        def do(word: str, count: int) -> Any:
            before_s = _cpu_s(processes)
            if word == "sustained":
                names = [f"e{i % size}" for i in range(count)]
                found: Any = wire._sustained(client, names, random_)
            else:
                found = [_timed(client, word, random_, size, live) for _ in range(count)]
            return {"found": found, "cpu_ms": (_cpu_s(processes) - before_s) * 1e3 / count}

        yield do


def _cpu_s(processes: Sequence[psutil.Process]) -> float:
    times = [process.cpu_times() for process in processes]
    return float(sum(t.user + t.system for t in times))


def _timed(client: Client, word: str, random_: random.Random, size: int, live: list[str]) -> float:
    at, name = made.pose(random_).position_m, f"e{random_.randrange(size)}"
    class_name = made.CLASSES[len(live) % len(made.CLASSES)]
    if word == "add":
        live.append(f"n{time.time_ns()}")
    began_s = time.perf_counter()
    match word:
        case "add":
            client.add(class_name, live[-1], at=at, size=(0.5, 0.5, 0.5), ref=class_name.lower())
        case "move":
            client.update(name, at=at)
        case "reference":
            client.update(name, ref=f"thing {began_s}")
        case "remove":
            client.remove(live.pop())
        case _:
            raise ValueError(word)
    return (time.perf_counter() - began_s) * 1e3


def university(triples: int, module: Path) -> Iterator[Callable[[str, int], Any]]:
    """Measure university data from the generator in `module` once."""
    spec = importlib.util.spec_from_file_location("university", module)
    assert spec is not None
    assert spec.loader is not None
    found = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(found)
    yield lambda word, count: found.measure(triples)._asdict()


def main() -> None:
    """Print `ready`, then answer each line `WORD COUNT`."""
    what, *words = sys.argv[1:]
    match what:
        case "core":
            side = core(int(words[0]))
        case "wire":
            side = system(Path(words[0]), int(words[1]), Path(words[2]) if len(words) > 2 else None)
        case _:
            side = university(int(words[0]), Path(words[1]))
    do = next(side)
    print("ready", flush=True)
    for line in sys.stdin:
        word, count = line.split()
        print(json.dumps(do(word, int(count))), flush=True)
    next(side, None)


if __name__ == "__main__":
    main()
