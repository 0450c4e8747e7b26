"""Which colour picture and which depth picture were taken together."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from semmap.schemas.wording import counted


class Pairs(NamedTuple):
    """Numbers of (colour, depth) pictures in the order of time, and a sentence for each kind left out."""

    taken: list[tuple[int, int]]
    notes: list[str]


def pairs(colour_ns: Sequence[int], depth_ns: Sequence[int], within_s: float, every_s: float) -> Pairs:
    """Each picture with the nearest of the other kind, each once, no farther than `within_s` apart.

    Of pictures of one kind with one stamp the first counts. Between two pairs that are taken there are
    `every_s` or more.
    """
    colours, depths = _firsts(colour_ns), _firsts(depth_ns)
    nearest: list[tuple[int, int, int]] = []
    order = np.array(sorted(depths), dtype=np.int64)
    for stamp in colours:
        at = int(np.searchsorted(order, stamp))
        for other in order[max(at - 1, 0) : at + 1].tolist():
            if (apart := abs(other - stamp)) <= within_s * 1e9:
                nearest.append((apart, stamp, other))
    partner: dict[int, int] = {}
    used: set[int] = set()
    for _, stamp, other in sorted(nearest):
        if stamp not in partner and other not in used:
            partner[stamp] = other
            used.add(other)
    taken: list[tuple[int, int]] = []
    last_ns: int | None = None
    for stamp in sorted(partner):
        if last_ns is None or stamp - last_ns >= every_s * 1e9:
            taken.append((colours[stamp], depths[partner[stamp]]))
            last_ns = stamp
    return Pairs(taken, _notes(len(colour_ns) + len(depth_ns), colours, depths, partner, within_s))


def _firsts(stamps_ns: Sequence[int]) -> dict[int, int]:
    """From each stamp to the number of the first picture that has it."""
    found: dict[int, int] = {}
    for number, stamp in enumerate(stamps_ns):
        found.setdefault(stamp, number)
    return found


def _notes(
    count: int, colours: dict[int, int], depths: dict[int, int], partner: dict[int, int], within_s: float
) -> list[str]:
    notes = []
    if twice := count - len(colours) - len(depths):
        notes.append(f"{counted(twice, 'picture')} left out: another has the same stamp")
    if alone := len(colours) - len(partner):
        notes.append(f"{counted(alone, 'colour picture')} without a depth picture within {within_s:g} s")
    return notes
