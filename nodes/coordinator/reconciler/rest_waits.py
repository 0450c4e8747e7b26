"""Limits the waits for contents, or for parts of a robot, to come to rest. Reads no clock."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Final, NamedTuple

from semmap.schemas.scenes import Body

CALM_S: Final = 2.0
"""The longest wait, in simulated time, because rest is also judged in simulated time."""


class _Wait(NamedTuple):
    since_s: float
    due: frozenset[str]


class RestWaits:
    """The start of each wait [s of simulated time], by the name of the whole."""

    def __init__(self) -> None:
        self._waits: dict[str, _Wait] = {}

    def must_wait(self, whole: str, due: Collection[str], now_s: float) -> bool:
        """Return whether to wait for what still moves in or of `whole`; the bodies `due` rest already.

        The wait begins with the first call, and again if the simulated time has been set back.
        """
        wait = self._waits.get(whole)
        if wait is None or now_s < wait.since_s:
            wait = self._waits[whole] = _Wait(now_s, frozenset(due))
        return now_s < wait.since_s + CALM_S

    def end(self, whole: str) -> None:
        """Forget the wait for `whole`, if there is one."""
        self._waits.pop(whole, None)

    def forget_moving(self, bodies: Mapping[str, Body]) -> None:
        """Forget each wait of which a body that was due is gone or moves again.

        Otherwise the next time that it comes to rest would count as waited for already.
        """
        self._waits = {
            whole: wait
            for whole, wait in self._waits.items()
            if all((body := bodies.get(name)) is not None and body.resting for name in wait.due)
        }
