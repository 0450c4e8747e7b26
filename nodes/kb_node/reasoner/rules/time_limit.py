"""A limit of the time for counting the matches of SWRL rules, of which there may be any number."""

from __future__ import annotations

import time


class OutOfTime(Exception):
    """The time limit is reached."""


class TimeLimit:
    """A limit of the CPU time of this thread, so that results do not depend on the load of the machine."""

    def __init__(self, seconds: float) -> None:
        self._until_s = time.thread_time() + seconds

    def check(self) -> None:
        """Raise OutOfTime if the limit is reached."""
        if time.thread_time() >= self._until_s:
            raise OutOfTime
