"""How long the disk takes, which tells whether it is worth working meanwhile."""

from __future__ import annotations

from collections import deque
from typing import Final

_REMEMBERED: Final = 9
_LOOK_EACH: Final = 32
_LONG_S: Final = 1e-4
"""Twice as long as it takes to wake a thread up."""


class Pace:
    """Of the last commits that were waited for with nothing done meanwhile."""

    def __init__(self) -> None:
        self._took_s: deque[float] = deque(maxlen=_REMEMBERED)
        self._asked = 0

    def took(self, time_s: float) -> None:
        """A commit took so long."""
        self._took_s.append(time_s)

    def is_slow(self) -> bool:
        """Does it take so long that one should work meanwhile? Now and then not, to see how long that is."""
        self._asked += 1
        if not self._took_s or self._asked % _LOOK_EACH == 0:
            return False
        return sorted(self._took_s)[len(self._took_s) // 2] >= _LONG_S
