"""The stamps of the scene."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Final

_SET_BACK_NS: Final = 10_000_000_000
"""Subscribers request the scene again after a larger step of a clock; until then they drop older poses."""


class SceneClock:
    """The time of day, but a stamp is later than the one before if the clock was set back only a little."""

    def __init__(self, now_ns: Callable[[], int] = time.time_ns) -> None:
        """Create it; `now_ns` is the clock [ns since 1970]."""
        self._now_ns = now_ns
        self._last_ns = 0

    def stamp_ns(self) -> int:
        """Return the stamp of what is observed now."""
        now_ns = self._now_ns()
        if 0 <= self._last_ns - now_ns <= _SET_BACK_NS:
            now_ns = self._last_ns + 1
        self._last_ns = now_ns
        return now_ns
