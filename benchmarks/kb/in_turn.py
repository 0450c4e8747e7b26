"""Measures another version and this one in turn: on a shared machine, gains show only side by side."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from itertools import chain
from pathlib import Path
from statistics import mean, median
from typing import Any, NamedTuple

from benchmarks.kb import floor, university

CORE = ("add", "move", "refuse", "remove")
WIRE = ("add", "move", "reference", "remove")
SUSTAINED = "sustained"
_HERE = Path(__file__).parents[2]
_ROUNDS = 6
_SHORT_ROUNDS = 30
"""Over Zenoh, where other load changes from second to second."""


class Pair(NamedTuple):
    """The medians of a figure for both versions."""

    before: float
    now: float

    @property
    def ratio(self) -> float:
        """The ratio of this version to the previous one."""
        return self.now / self.before


class Sides:
    """The processes of both versions, queried in turn.

    The order alternates, because the last queried process has warm caches.
    """

    def __init__(self, sides: Sequence[subprocess.Popen[str]]) -> None:
        self._sides = sides

    def ask(self, word: str, count: int, round_: int = 0) -> tuple[Any, Any]:
        """Return the replies of the previous version and of this one."""
        answers: dict[int, Any] = {}
        for i in (round_ % 2, 1 - round_ % 2):
            side = self._sides[i]
            assert side.stdin is not None
            assert side.stdout is not None
            print(word, count, file=side.stdin, flush=True)
            answers[i] = json.loads(side.stdout.readline())
        return answers[0], answers[1]


def core(before: Path, size: int, count: int) -> dict[str, Pair]:
    """Measure the engine alone; medians of the rounds' medians [ms]."""
    with _sides(before, ["core", str(size)], ["core", str(size)]) as sides:
        sides.ask("warm", count // 5)
        rounds = [sides.ask(f"n{i}_", count, i) for i in range(_ROUNDS)]
    return {what: _pair([(old[what], new[what]) for old, new in rounds]) for what in CORE}


class Least(NamedTuple):
    """The median duration of a chain of bare processes, and its CPU time [ms]."""

    took_ms: float
    cpu_ms: float


class Wired(NamedTuple):
    """The duration and CPU time of commands by name [ms]."""

    took: dict[str, Pair]
    """Medians [ms]; for `sustained`, moves per second."""
    floor: dict[str, Least]
    """The lower bounds on this machine for some commands (`floor.py`)."""
    cpu: dict[str, Pair]
    """Mean CPU times in all processes including the client [ms], which depend less on other load."""


def wire(before: Path, folder: Path, size: int, count: int, tbox: Path | None = None) -> Wired:
    """Measure two whole systems with one client each; `tbox` replaces the TBox of this version."""
    words = [["wire", str(folder / side), str(size)] for side in ("before", "now")]
    words[1] += [] if tbox is None else [str(tbox)]
    took: dict[str, tuple[list[float], list[float]]] = {what: ([], []) for what in WIRE}
    cpu: dict[str, list[tuple[float, float]]] = {what: [] for what in (*WIRE, SUSTAINED)}
    least: dict[str, list[tuple[list[float], float]]] = {what: [] for what in floor.SIZES}
    with _sides(before, *words) as sides, floor.chain(str(folder)) as bare:
        for i in range(_SHORT_ROUNDS + 1):
            for what in WIRE:
                old, new = sides.ask(what, count // _SHORT_ROUNDS if i else 20, i)
                if what in least:
                    found = bare(what, count // _SHORT_ROUNDS)
                    least[what] += [(found.took_ms, found.cpu_ms)] if i else []
                if i:
                    took[what][0].extend(old["found"])
                    took[what][1].extend(new["found"])
                    cpu[what].append((old["cpu_ms"], new["cpu_ms"]))
        rounds = [sides.ask(SUSTAINED, count, i) for i in range(6)]
    cpu[SUSTAINED] = [(old["cpu_ms"], new["cpu_ms"]) for old, new in rounds]
    rates = _pair([(old["found"], new["found"]) for old, new in rounds])
    pairs = {what: Pair(*map(median, both)) for what, both in took.items()}
    spent = {what: Pair(*map(mean, zip(*rows, strict=True))) for what, rows in cpu.items()}
    bottom = {
        what: Least(median(chain.from_iterable(one for one, _ in rows)), mean(spent for _, spent in rows))
        for what, rows in least.items()
    }
    return Wired({**pairs, SUSTAINED: rates}, bottom, spent)


def of_university(before: Path, triples: int, turns: int) -> Pair:
    """Measure the CPU time for all inferences of university data [s]."""
    words = ["university", str(triples), str(Path(university.__file__))]
    rounds = []
    for _ in range(turns):
        with _sides(before, words, words) as sides:
            rounds.append(sides.ask("once", 1))
    return _pair([(_whole_s(old), _whole_s(new)) for old, new in rounds])


def _whole_s(found: dict[str, float]) -> float:
    return found["load_cpu_s"] + found["enumerate_cpu_s"]


def _pair(rounds: Sequence[tuple[float, float]]) -> Pair:
    old, new = zip(*rounds, strict=True)
    return Pair(median(old), median(new))


@contextmanager
def _sides(before: Path, *words: Sequence[str]) -> Iterator[Sides]:
    """Start a process of each version and wait until both are ready."""
    with ExitStack() as stack:
        sides = []
        for root, said in zip((before.resolve(), _HERE), words, strict=True):
            command = [sys.executable, "-P", str(Path(__file__).with_name("one_side.py")), *said]
            if said[0] == "wire":
                Path(said[1]).mkdir(parents=True)
            side = stack.enter_context(
                subprocess.Popen(
                    command,
                    cwd=root,
                    env={**os.environ, "PYTHONPATH": str(root)},
                    stdin=subprocess.PIPE,
                    stdout=subprocess.PIPE,
                    text=True,
                )
            )
            sides.append(side)
        for side in sides:
            assert side.stdout is not None
            if side.stdout.readline() != "ready\n":
                raise RuntimeError(f"{' '.join(map(str, side.args))} did not start")  # type: ignore[arg-type]
        yield Sides(sides)
        for side in sides:
            assert side.stdin is not None
            side.stdin.close()
