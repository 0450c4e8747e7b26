"""The table of faults. A line is what is done; what is promised is the same for all of them.

Every change that was acknowledged is there once, and the system is whole again by itself. A strike that finds
a further promise broken raises AssertionError. Add yours to one of the tuples in `FAULTS`.
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
    """What is done to a system under load; how often in `make test-faults` and how often in `make test`."""

    name: str
    strike: Callable[[Ground], None]
    often: int = 3
    in_short: int = 0
    words: tuple[str, ...] = SMALL
    """With which it is started."""
    missing: Callable[[], str] = field(default=_nothing)
    """Why it cannot be done here; nothing where it can."""


@dataclass
class Row:
    """What came of one line of the table."""

    name: str
    done: int = 0
    lost: int = 0
    doubled: int = 0
    whole_s: float = 0.0
    """The longest that it took."""
    skipped: str = ""
    failed: str = ""


def outcome(fault: Fault, data: Path, times: int) -> Row:
    """Do it so many times, to one system."""
    if missing := fault.missing():
        return Row(fault.name, skipped=missing)
    with contextlib.closing(Ground(data, fault.words)) as ground:
        return done_to(ground, fault, times)


def done_to(ground: Ground, fault: Fault, times: int) -> Row:
    """Do it so many times to a system under load, and stop the load."""
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
