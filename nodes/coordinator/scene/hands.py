"""Hands that move bodies: where such a body comes to rest is the word of who had it moved."""

from __future__ import annotations

import time
from typing import NamedTuple

from schemas.commands import Move

_RESTS_WITHIN_S = 10.0


class Hand(NamedTuple):
    """On whose behalf a body was moved, and why. Without a verb it was nobody: physics did it."""

    verb: str
    agent: str
    reason: str


class Hands:
    """The bodies that hands let go of and that have not come to rest yet."""

    def __init__(self) -> None:
        self._released: dict[str, tuple[Hand, float]] = {}

    def let_go(self, command: Move) -> None:
        """A hand let go of a body."""
        hand = Hand("move", command.agent, command.reason or f"{command.name} was moved by hand")
        self._released[command.name] = (hand, time.monotonic() + _RESTS_WITHIN_S)

    def that_moved(self, name: str) -> Hand:
        """The hand because of which a body rests where it does; it is asked once."""
        hand, until_s = self._released.pop(name, (None, 0.0))
        if hand is not None and time.monotonic() < until_s:
            return hand
        return Hand("", "", f"{name} came to rest")
