"""Moves by hand: the new pose of such a body is attributed to the client that moved it."""

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


class Hand(NamedTuple):
    """On whose behalf a body was moved, and why. Without a verb it was nobody: physics did it."""

    verb: str
    agent: str
    reason: str
    party: frozenset[str] = frozenset()
    """The bodies that it carried together; the map follows all of them at once."""


class Hands:
    """The bodies that hands let go of and whose resting place the map has not taken over yet."""

    def __init__(self) -> None:
        self._released: dict[str, tuple[Hand, float]] = {}

    def let_go(
        self, command: Move | Open | Close | Drive, load: Collection[str] = (), reason: str = ""
    ) -> None:
        """A hand let go of a body, and of what it carried along with it; `reason` where none is given."""
        party = frozenset((command.name, *load)) if load else frozenset[str]()
        if isinstance(command, Drive):
            reason, until_s = command.reason or f"{command.name} was driven", math.inf
        else:
            reason = command.reason or reason or f"{command.name} was {_DONE[command.VERB]} by hand"
            until_s = time.monotonic() + _RESTS_WITHIN_S
        hand = Hand(command.VERB, command.agent, reason, party)
        for name in (command.name, *load):
            self._released[name] = (hand, until_s)

    def renew(self) -> None:
        """Simulated time runs again: what was let go has as long as ever to come to rest."""
        until_s = time.monotonic() + _RESTS_WITHIN_S
        self._released = {n: (hand, max(until_s, was_s)) for n, (hand, was_s) in self._released.items()}

    def forget(self, names: Collection[str]) -> None:
        """These bodies rest where the map has them: what moves them next is not what moved them last."""
        for name in names:
            self._released.pop(name, None)

    def party_of(self, name: str) -> frozenset[str]:
        """Who was carried together with a body and is still to be followed with it, itself among them."""
        hand, until_s = self._released.get(name, (None, 0.0))
        if hand is None or time.monotonic() > until_s:
            return frozenset()
        return frozenset(n for n in hand.party if self._released.get(n, (None, 0.0))[0] is hand)

    @contextmanager
    def that_moved(self, *names: str) -> Iterator[Hand]:
        """The hand because of which a body rests where it does, or several do that it carried together.

        It is forgotten when the map has accepted or refused the new place, and kept for the next attempt when
        the map did not answer (NoAnswer).
        """
        moved = next((name for name in names if name in self._released), names[0])
        hand, until_s = self._released.pop(moved, (None, 0.0))
        if hand is None or time.monotonic() > until_s:
            yield Hand("", "", f"{wording.few(names)} came to rest")
            return
        for name in hand.party:
            if self._released.get(name, (None, 0.0))[0] is hand:
                del self._released[name]
        try:
            yield hand
        except NoAnswer:
            for name in hand.party or names:
                self._released.setdefault(name, (hand, time.monotonic() + _RESTS_WITHIN_S))
            raise
