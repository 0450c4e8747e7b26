"""Manual moves: attributes the new pose of a body to the client that moved it."""

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
"""Longer than a reply waits for rest. Later changes are not attributed to the move."""
_DONE = {"move": "moved", "open": "opened", "close": "closed"}


class Attribution(NamedTuple):
    """Who moved a body, and why. Without a verb, it moved by physics alone."""

    verb: str
    agent: str
    reason: str
    group: frozenset[str] = frozenset()
    """The bodies that were moved together; their poses are committed together."""


class ManualMoves:
    """The moved bodies whose new poses are not committed yet."""

    def __init__(self) -> None:
        self._released: dict[str, tuple[Attribution, float]] = {}

    def register(
        self, command: Move | Open | Close | Drive, load: Collection[str] = (), reason: str = ""
    ) -> None:
        """Register the move of a body and its contents; `reason` is used if the command has none."""
        group = frozenset((command.name, *load)) if load else frozenset[str]()
        if isinstance(command, Drive):
            reason, until_s = command.reason or f"{command.name} was driven", math.inf
        else:
            reason = command.reason or reason or f"{command.name} was {_DONE[command.VERB]} by hand"
            until_s = time.monotonic() + _RESTS_WITHIN_S
        attribution = Attribution(command.VERB, command.agent, reason, group)
        for name in (command.name, *load):
            self._released[name] = (attribution, until_s)

    def renew(self) -> None:
        """Renew the deadlines when simulated time runs again."""
        until_s = time.monotonic() + _RESTS_WITHIN_S
        self._released = {
            n: (attribution, max(until_s, was_s)) for n, (attribution, was_s) in self._released.items()
        }

    def forget(self, names: Collection[str]) -> None:
        """Forget the moves of bodies whose poses are committed; later changes have another attribution."""
        for name in names:
            self._released.pop(name, None)

    def group_of(self, name: str) -> frozenset[str]:
        """Return the bodies moved together with a body, itself included, that are not committed yet."""
        attribution, until_s = self._released.get(name, (None, 0.0))
        if attribution is None or time.monotonic() > until_s:
            return frozenset()
        return frozenset(n for n in attribution.group if self._released.get(n, (None, 0.0))[0] is attribution)

    @contextmanager
    def attribution_of(self, *names: str) -> Iterator[Attribution]:
        """Yield the attribution of the new pose of a body, or of several that were moved together.

        It is forgotten when the map has accepted or rejected the pose. It is kept for the next attempt if the
        map did not respond (NoAnswer).
        """
        moved = next((name for name in names if name in self._released), names[0])
        attribution, until_s = self._released.pop(moved, (None, 0.0))
        if attribution is None or time.monotonic() > until_s:
            yield Attribution("", "", f"{wording.few(names)} came to rest")
            return
        for name in attribution.group:
            if self._released.get(name, (None, 0.0))[0] is attribution:
                del self._released[name]
        try:
            yield attribution
        except NoAnswer:
            for name in attribution.group or names:
                self._released.setdefault(name, (attribution, time.monotonic() + _RESTS_WITHIN_S))
            raise
