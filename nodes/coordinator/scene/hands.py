"""Moves by hand: the new pose of such a body is attributed to the client that moved it."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import NamedTuple

from schemas.commands import Move
from schemas.errors import NoAnswer

_RESTS_WITHIN_S = 10.0


class Hand(NamedTuple):
    """On whose behalf a body was moved, and why. Without a verb it was nobody: physics did it."""

    verb: str
    agent: str
    reason: str


class Hands:
    """The bodies that hands let go of and whose resting place the map has not taken over yet."""

    def __init__(self) -> None:
        self._released: dict[str, tuple[Hand, float]] = {}

    def let_go(self, command: Move) -> None:
        """A hand let go of a body."""
        hand = Hand("move", command.agent, command.reason or f"{command.name} was moved by hand")
        self._released[command.name] = (hand, time.monotonic() + _RESTS_WITHIN_S)

    @contextmanager
    def that_moved(self, name: str) -> Iterator[Hand]:
        """The hand because of which a body rests where it does.

        It is forgotten when the map has accepted or refused the new place, and kept for the next attempt when
        the map did not answer (NoAnswer).
        """
        hand, until_s = self._released.pop(name, (None, 0.0))
        if hand is None or time.monotonic() > until_s:
            yield Hand("", "", f"{name} came to rest")
            return
        try:
            yield hand
        except NoAnswer:
            self._released.setdefault(name, (hand, time.monotonic() + _RESTS_WITHIN_S))
            raise
