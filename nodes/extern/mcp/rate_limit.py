"""How often something may be done: a bucket of so many, refilled at a steady rate."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable


class Rate:
    """`per_s` a second in the long run, and up to `at_once` in a burst. For any thread."""

    def __init__(self, per_s: float, at_once: float, clock: Callable[[], float] = time.monotonic) -> None:
        self._per_s, self._at_once, self._clock = per_s, at_once, clock
        self._left, self._at = at_once, clock()
        self._lock = threading.Lock()

    def wait_s(self) -> float:
        """Take one: 0 if there was one, else after how long there will be [s], and none is taken."""
        with self._lock:
            now = self._clock()
            self._left = min(self._at_once, self._left + (now - self._at) * self._per_s)
            self._at = now
            if self._left >= 1.0:
                self._left -= 1.0
                return 0.0
            return (1.0 - self._left) / self._per_s
