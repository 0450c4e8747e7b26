"""The table of faults: each row is a fault, and the guarantees are the same for all.

Every acknowledged change exists exactly once, and the system recovers by itself. A fault that violates
another guarantee raises AssertionError. To add a fault, add it to one of the tuples in `FAULTS`.
"""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from tests.faults.ground import Ground

SMALL = ("--abox", "none", "--no-sim", "--no-record")


def _nothing() -> str:
    return ""


@dataclass(frozen=True)
class Fault:
    """A fault, and how often it is done in `make test-faults` and in `make test`."""

    name: str
    strike: Callable[[Ground], None]
    often: int = 3
    in_short: int = 0
    words: tuple[str, ...] = SMALL
    """The options of the system."""
    missing: Callable[[], str] = field(default=_nothing)
    """Returns why it cannot be done here; "" if it can."""


@dataclass
class Row:
    """The result of a row."""

    name: str
    done: int = 0
    lost: int = 0
    doubled: int = 0
    whole_s: float = 0.0
    """The longest recovery."""
    skipped: str = ""
    failed: str = ""


def outcome(fault: Fault, data: Path, times: int) -> Row:
    """Run a fault repeatedly on one system."""
    if missing := fault.missing():
        return Row(fault.name, skipped=missing)
    with contextlib.closing(Ground(data, fault.words)) as ground:
        return done_to(ground, fault, times)


def done_to(ground: Ground, fault: Fault, times: int) -> Row:
    """Run a fault repeatedly on a system under load, and stop the load."""
    row = Row(fault.name)
    ground.seconds_until_whole()
    for _ in range(times):
        began_s, ground.observed_s = time.monotonic(), 0.0
        fault.strike(ground)
        ground.seconds_until_whole()
        row.whole_s = max(row.whole_s, time.monotonic() - began_s - ground.observed_s)
        row.done += 1
    row.lost, row.doubled = ground.reckon()
    return row
