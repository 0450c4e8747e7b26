"""Proposals: changes after a dry run, which can be committed once, by a token."""

from __future__ import annotations

import secrets
import threading
import time
from collections import OrderedDict
from collections.abc import Callable
from typing import Any, Final

from msgspec import Struct, structs

from semmap.nodes.extern.mcp.answers import Answer
from semmap.schemas import errors
from semmap.schemas.commands import Command
from semmap.schemas.replies import Changed

LASTS_S: Final = 1800.0
"""The lifetime of a proposal [s]."""
_MOST: Final = 200
"""The maximum number of proposals; the oldest are dropped."""


class Proposal(Struct, frozen=True, kw_only=True):
    """A change with its dry run after commit `commit`; it depends on the entities `rests_on`.

    `began_s` is on the clock of the store. `sent` is set if the change was sent and its reply is missing.
    `done` is the reply of the executed proposal.
    """

    token: str
    command: Command[Changed]
    commit: int
    tried: Changed
    rests_on: tuple[str, ...]
    began_s: float
    sent: bool = False
    done: Answer | None = None
    at_work: bool = False


class Proposals:
    """The proposals of one server. They can be used from any thread."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._lock = threading.Lock()
        self._by_token: OrderedDict[str, Proposal] = OrderedDict()

    def add(self, **fields: Any) -> Proposal:
        """Add a proposal with a random token."""
        made = Proposal(token=secrets.token_urlsafe(12), began_s=self._clock(), **fields)
        with self._lock:
            self._by_token[made.token] = made
            while len(self._by_token) > _MOST:
                self._by_token.popitem(last=False)
        return made

    def take(self, token: str) -> Proposal:
        """Return the proposal with this token, and lock it until `put_back` or `finish`.

        One that is done is returned without a lock. Raises Refused for an unknown or expired token, and Busy
        while another call commits it.
        """
        with self._lock:
            found = self._by_token.get(token)
            if found is None:
                raise errors.Refused("unknown token; propose the change again")
            if found.done is not None:
                return found
            if self._clock() - found.began_s > LASTS_S:
                del self._by_token[token]
                raise errors.Refused(
                    f"the proposal expired after {LASTS_S / 60:g} minutes; propose the change again"
                )
            if found.at_work:
                raise errors.Busy("another call commits this token; call again", again_s=1.0)
            self._by_token[token] = taken = structs.replace(found, at_work=True)
            return taken

    def put_back(self, proposal: Proposal, *, sent: bool = False) -> None:
        """Unlock a proposal that was not committed or, if it was `sent`, whose reply is missing."""
        with self._lock:
            self._by_token[proposal.token] = structs.replace(proposal, at_work=False, sent=sent)

    def drop(self, proposal: Proposal) -> None:
        """Delete a proposal that can no longer be committed."""
        with self._lock:
            self._by_token.pop(proposal.token, None)

    def finish(self, proposal: Proposal, reply: Answer) -> None:
        """Record the reply of a proposal, which a repeated call returns."""
        with self._lock:
            self._by_token[proposal.token] = structs.replace(proposal, at_work=False, done=reply)
