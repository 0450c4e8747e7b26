"""`python -m benchmarks.kb.secure`: the cost of certificates and of the router for a client.

Runs two systems, one with `--secure`, with this process as the only client of each. They are measured in
turn, so that other load affects both equally.
"""

from __future__ import annotations

import argparse
import random
import statistics
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from benchmarks.kb.made import pose
from benchmarks.table import Row, lines
from semmap.nodes.extern.client import Client
from semmap.nodes.extern.testing import own_system
from semmap.nodes.identity import authority

_QUIET = ("--no-sim", "--no-record", "--world", "empty")
_TURN = 20
"""The number of commands in a row before switching to the other system."""


def measure(turns: int) -> list[Row]:
    """Print the medians of each command, and the ratio for an add."""
    random_ = random.Random(0)

    def add(client: Client, i: int) -> None:
        client.add("Cup", f"new{i}", at=pose(random_).position_m, size=(0.1, 0.1, 0.1), ref="cup")

    def move(client: Client, i: int) -> None:
        client.update(f"new{i}", at=pose(random_).position_m)

    def get(client: Client, i: int) -> None:
        client.get(f"new{i}")

    def sparql(client: Client, i: int) -> None:
        client.sparql(f"ASK {{ :new{i} ?p ?o }}")

    sorts: dict[str, Callable[[Client, int], None]] = {"add": add, "move": move, "get": get, "sparql": sparql}
    with tempfile.TemporaryDirectory() as folder:
        keys = Path(folder, "keys")
        authority.init(keys)
        authority.add(keys, "bob", "operator")
        with (
            own_system(Path(folder, "plain"), *_QUIET) as plain,
            own_system(
                Path(folder, "secure"), "--secure", str(keys), *_QUIET, identity=str(keys / "bob")
            ) as secure,
        ):
            took: dict[tuple[str, str], list[float]] = {}
            for turn in range(turns + 1):
                for sort, command in sorts.items():
                    for which, client in (("plain", plain), ("secure", secure)):
                        each = [_timed(command, client, turn * _TURN + i) for i in range(_TURN)]
                        took.setdefault((sort, which), []).extend(each if turn else ())  # the first warms up
    rows = []
    for sort in sorts:
        plain_ms, secure_ms = (statistics.median(took[sort, which]) for which in ("plain", "secure"))
        rows.append(Row(f"{sort}, without", plain_ms, "ms"))
        rows.append(Row(f"{sort}, with --secure", secure_ms, "ms"))
        rows.append(Row(f"{sort}, ratio", secure_ms / plain_ms, "times", 1.3 if sort == "add" else None))
    return rows


def _timed(command: Callable[[Client, int], None], client: Client, i: int) -> float:
    began = time.perf_counter()
    command(client, i)
    return (time.perf_counter() - began) * 1e3


if __name__ == "__main__":
    parser = argparse.ArgumentParser(prog="python -m benchmarks.kb.secure", description=__doc__)
    parser.add_argument("--turns", type=int, default=25, help=f"of {_TURN} commands of each sort")
    print(lines(measure(parser.parse_args().turns)))
