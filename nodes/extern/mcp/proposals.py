"""Proposals: changes that were tried out and wait to be committed, each once, by its token."""

from __future__ import annotations

import secrets
import threading
import time
from collections import OrderedDict
from collections.abc import Callable
from typing import Any, Final

from msgspec import Struct, structs

from semmap.schemas import errors
from semmap.schemas.commands import Command
from semmap.schemas.replies import Changed

LASTS_S: Final = 1800.0
"""Seconds after which a proposal is forgotten."""
_MOST: Final = 200
"""Proposals that are kept at most: the oldest go."""


class Proposal(Struct, frozen=True, kw_only=True):
    """A change as it was tried out after commit `commit`; `rests_on` are the entities that it is about.

    `began_s` is on the clock of the store. `done` is the commit that it became.
    """

    token: str
    command: Command[Changed]
    commit: int
    tried: Changed
    rests_on: tuple[str, ...]
    began_s: float
    done: int | None = None
    at_work: bool = False


class Proposals:
    """Those of one server. For any thread."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._lock = threading.Lock()
        self._by_token: OrderedDict[str, Proposal] = OrderedDict()

    def add(self, **fields: Any) -> Proposal:
        """A new one, with a token that nobody can guess."""
        made = Proposal(token=secrets.token_urlsafe(12), began_s=self._clock(), **fields)
        with self._lock:
            self._by_token[made.token] = made
            while len(self._by_token) > _MOST:
                self._by_token.popitem(last=False)
        return made

    def take(self, token: str) -> Proposal:
        """The one of this token, which nobody else can take until `put_back` or `finish`. Raises Refused."""
        with self._lock:
            found = self._by_token.get(token)
            if found is None:
                raise errors.Refused("there is no proposal with that token; propose the change again")
            if found.done is not None:
                raise errors.Refused(f"that token was used: it became commit {found.done}; propose anew")
            if self._clock() - found.began_s > LASTS_S:
                del self._by_token[token]
                raise errors.Refused(
                    f"that proposal is older than {LASTS_S / 60:g} minutes; propose the change again"
                )
            if found.at_work:
                raise errors.Refused("that token is being committed just now")
            self._by_token[token] = taken = structs.replace(found, at_work=True)
            return taken

    def put_back(self, proposal: Proposal) -> None:
        """It was not committed, and may be tried again."""
        with self._lock:
            self._by_token[proposal.token] = structs.replace(proposal, at_work=False)

    def drop(self, proposal: Proposal) -> None:
        """It cannot be committed any more."""
        with self._lock:
            self._by_token.pop(proposal.token, None)

    def finish(self, proposal: Proposal, commit: int) -> None:
        """It became a commit."""
        with self._lock:
            self._by_token[proposal.token] = structs.replace(proposal, at_work=False, done=commit)
