"""Timing of a playback of past commits."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise
from typing import Final

from semmap.schemas.errors import BadRequest

LONGEST_S: Final = 3.0
"""Longest wait for the next commit; longer pauses are shortened."""


def require_speed(speed: float) -> float:
    """Return `speed` if it is valid: 1 is real time, 10 ten times as fast. Raises BadRequest."""
    if not math.isfinite(speed) or speed <= 0.0:
        raise BadRequest(
            f"the speed must be greater than 0, not {speed:g}; 1 is real time, 10 is ten times as fast"
        )
    return speed


def require_longest(longest_s: float) -> float:
    """Return `longest_s` if it is valid. Raises BadRequest."""
    if not math.isfinite(longest_s) or longest_s < 0.0:
        raise BadRequest(f"the longest wait must be 0 seconds or more, not {longest_s:g}")
    return longest_s


def wait_s(before_ns: int, after_ns: int, *, speed: float = 1.0, longest_s: float = LONGEST_S) -> float:
    """Return the seconds from one commit to the next, by their stamps [ns since 1970].

    If the clock was set back in between, there is no wait.
    """
    return max(0.0, min((after_ns - before_ns) / 1e9 / speed, longest_s))


def waits_s(stamps_ns: Iterable[int], *, speed: float = 1.0, longest_s: float = LONGEST_S) -> Iterator[float]:
    """Yield the waits between commits with these stamps: one fewer than the stamps."""
    return (wait_s(*pair, speed=speed, longest_s=longest_s) for pair in pairwise(stamps_ns))


def next_position(
    stamps_ns: Sequence[int],
    at: int,
    *,
    speed: float = 1.0,
    longest_s: float = LONGEST_S,
    least_s: float = 0.0,
) -> tuple[int, float]:
    """Return the next commit to show, and the seconds until then.

    This is the next commit or, if many come within `least_s` seconds, the last of those, so that fewer frames
    have to be drawn. `at` and the result are indices of `stamps_ns`; the last index is its own successor.
    """
    waited_s, place = 0.0, at
    while place + 1 < len(stamps_ns):
        next_s = wait_s(stamps_ns[place], stamps_ns[place + 1], speed=speed, longest_s=longest_s)
        if place > at and waited_s + next_s > least_s:
            break
        waited_s += next_s
        place += 1
    return place, max(waited_s, least_s)
