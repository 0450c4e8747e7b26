"""Pairing of colour and depth images by time."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from semmap.schemas.wording import counted


class Pairs(NamedTuple):
    """The indices of (colour, depth) images in the order of time, and notes on skipped images."""

    taken: list[tuple[int, int]]
    notes: list[str]


def pairs(colour_ns: Sequence[int], depth_ns: Sequence[int], within_s: float, every_s: float) -> Pairs:
    """Pair each image with the nearest one of the other kind, at most `within_s` apart.

    If images of one kind have the same stamp, the first is used. Pairs are at least `every_s` apart.
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
    """Return the index of the first image by stamp."""
    found: dict[int, int] = {}
    for number, stamp in enumerate(stamps_ns):
        found.setdefault(stamp, number)
    return found


def _notes(
    count: int, colours: dict[int, int], depths: dict[int, int], partner: dict[int, int], within_s: float
) -> list[str]:
    notes = []
    if twice := count - len(colours) - len(depths):
        notes.append(f"{counted(twice, 'image')} skipped: duplicate stamp")
    if alone := len(colours) - len(partner):
        notes.append(f"{counted(alone, 'colour image')} without a depth image within {within_s:g} s")
    return notes
