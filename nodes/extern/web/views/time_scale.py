"""The positions of commits on a slider over time."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from itertools import accumulate
from typing import Final

STEPS: Final = 1000
"""The last position of the slider; the first one is 0."""


def positions_of(stamps_ns: Sequence[int]) -> list[int]:
    """Return the positions of commits, by their stamps in their order [ns since 1970].

    After the clock was set back, commits are at the latest time before, until the clock is there again.
    """
    at = list(accumulate(stamps_ns, max))
    span_ns = at[-1] - at[0] if at else 0
    return [round(STEPS * (each - at[0]) / span_ns) if span_ns else STEPS for each in at]


def index_at(positions: Sequence[int], position: int) -> int:
    """Return the index of the last commit at a position or before it; 0 if there is none."""
    return max(0, bisect_right(positions, position) - 1)
