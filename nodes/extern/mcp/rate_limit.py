"""A rate limit by a token bucket."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable


class Rate:
    """A token bucket: `per_s` calls per second, and bursts of `at_once`. It can be used from any thread."""

    def __init__(self, per_s: float, at_once: float, clock: Callable[[], float] = time.monotonic) -> None:
        self._per_s, self._at_once, self._clock = per_s, at_once, clock
        self._left, self._at = at_once, clock()
        self._lock = threading.Lock()

    def wait_s(self) -> float:
        """Take a token and return 0, or return the time until the next token is available [s]."""
        with self._lock:
            now = self._clock()
            self._left = min(self._at_once, self._left + (now - self._at) * self._per_s)
            self._at = now
            if self._left >= 1.0:
                self._left -= 1.0
                return 0.0
            return (1.0 - self._left) / self._per_s
