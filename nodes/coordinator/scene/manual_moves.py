"""Manual moves: the new pose of such a body is attributed to the client that moved it."""

from __future__ import annotations

import math
import time
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from typing import NamedTuple

from semmap.schemas import wording
from semmap.schemas.commands import Close, Drive, Move, Open
from semmap.schemas.errors import NoAnswer

_RESTS_WITHIN_S = 60.0
"""Longer than a reply waits for rest; what rests and is not followed is forgotten before."""
_DONE = {"move": "moved", "open": "opened", "close": "closed"}


class Attribution(NamedTuple):
    """On whose behalf a body was moved, and why. Without a verb it was nobody: physics did it."""

    verb: str
    agent: str
    reason: str
    group: frozenset[str] = frozenset()
    """The bodies that it carried together; the map follows all of them at once."""


class ManualMoves:
    """The bodies that hands let go of and whose resting place the map has not taken over yet."""

    def __init__(self) -> None:
        self._released: dict[str, tuple[Attribution, float]] = {}

    def register(
        self, command: Move | Open | Close | Drive, load: Collection[str] = (), reason: str = ""
    ) -> None:
        """A hand let go of a body, and of what it carried along with it; `reason` where none is given."""
        group = frozenset((command.name, *load)) if load else frozenset[str]()
        if isinstance(command, Drive):
            reason, until_s = command.reason or f"{command.name} was driven", math.inf
        else:
            reason = command.reason or reason or f"{command.name} was {_DONE[command.VERB]} by hand"
            until_s = time.monotonic() + _RESTS_WITHIN_S
        cause = Attribution(command.VERB, command.agent, reason, group)
        for name in (command.name, *load):
            self._released[name] = (cause, until_s)

    def renew(self) -> None:
        """Simulated time runs again: what was let go has as long as ever to come to rest."""
        until_s = time.monotonic() + _RESTS_WITHIN_S
        self._released = {n: (cause, max(until_s, was_s)) for n, (cause, was_s) in self._released.items()}

    def forget(self, names: Collection[str]) -> None:
        """These bodies rest where the map has them: what moves them next is not what moved them last."""
        for name in names:
            self._released.pop(name, None)

    def group_of(self, name: str) -> frozenset[str]:
        """Who was carried together with a body and is still to be followed with it, itself among them."""
        cause, until_s = self._released.get(name, (None, 0.0))
        if cause is None or time.monotonic() > until_s:
            return frozenset()
        return frozenset(n for n in cause.group if self._released.get(n, (None, 0.0))[0] is cause)

    @contextmanager
    def attribution_of(self, *names: str) -> Iterator[Attribution]:
        """The cause because of which a body rests where it does, or several do that it carried together.

        It is forgotten when the map has accepted or refused the new place, and kept for the next attempt when
        the map did not answer (NoAnswer).
        """
        moved = next((name for name in names if name in self._released), names[0])
        cause, until_s = self._released.pop(moved, (None, 0.0))
        if cause is None or time.monotonic() > until_s:
            yield Attribution("", "", f"{wording.few(names)} came to rest")
            return
        for name in cause.group:
            if self._released.get(name, (None, 0.0))[0] is cause:
                del self._released[name]
        try:
            yield cause
        except NoAnswer:
            for name in cause.group or names:
                self._released.setdefault(name, (cause, time.monotonic() + _RESTS_WITHIN_S))
            raise
