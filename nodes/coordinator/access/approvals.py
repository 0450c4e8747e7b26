"""What agents ask to be allowed to do, and what persons decide. In memory: a restart forgets it."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Final

from msgspec import structs

from semmap.schemas import agents, errors, wording
from semmap.schemas.approvals import Request
from semmap.schemas.commands import Approve, Submit
from semmap.schemas.entities import LESSER

_LASTS_NS: Final = 3_600_000_000_000
_MOST: Final = 100
"""Requests that wait at most."""
_MOST_OF_ONE: Final = 10
"""Those of one agent: more than a person would want to read."""


class Approvals:
    """Owned by the coordinator's thread."""

    def __init__(self, clock_ns: Callable[[], int] = time.time_ns) -> None:
        self._clock_ns = clock_ns
        self._last = 0
        self._by_id: dict[tuple[str, str], Request] = {}

    def submit(self, command: Submit) -> Request:
        """Ask, or look what became of it: the same id of the same agent is the same request.

        Raises BadRequest without an id; Refused when very many wait, or many of this agent: not Busy, for
        clients ask again who is, and a person takes longer than they wait.
        """
        self._forget()
        if not command.id:
            raise errors.BadRequest("give the request an id, by which to ask what became of it")
        key = (command.agent, command.id)
        if (known := self._by_id.get(key)) is not None:
            return known
        waiting = [request.agent for request in self._by_id.values() if request.decision == "waiting"]
        if waiting.count(command.agent) >= _MOST_OF_ONE:
            raise errors.Refused(
                f"{_MOST_OF_ONE} requests of yours wait for a person already; wait until some are decided"
            )
        if len(waiting) >= _MOST:
            raise errors.Refused(f"{_MOST} requests wait for a person already; wait until some are decided")
        self._last += 1
        self._by_id[key] = made = Request(
            number=self._last,
            agent=command.agent,
            text=command.text,
            follows=command.follows,
            reason=command.reason,
            stamp_ns=self._clock_ns(),
        )
        return made

    def approve(self, command: Approve) -> tuple[Request, ...]:
        """Those that wait; or, with a number or `all`, those that are decided now, as decided.

        Raises BadRequest for `all` without `reject`; Refused for one that is not there or decided already,
        for an agent, and for who asked for it.
        """
        self._forget()
        waiting = {r.number: (key, r) for key, r in self._by_id.items() if r.decision == "waiting"}
        if command.all and (command.number is not None or not command.reject):
            raise errors.BadRequest("all goes with reject, and without a number")
        if command.number is None and not command.all:
            return tuple(request for _, request in waiting.values())
        if command.number is not None and command.number not in waiting:
            there = f"; waiting: {wording.few([str(number) for number in waiting])}" if waiting else ""
            raise errors.Refused(
                f"no request {command.number} is waiting{there or '; none is waiting at all'}"
            )
        if command.source in LESSER:
            raise errors.Refused("only an operator may approve or reject")
        own = command.agent if agents.is_proved(command.agent) else None
        if command.number is None:
            others = [(key, request) for key, request in waiting.values() if request.agent != own]
            return tuple(self._decide(key, request, command) for key, request in others)
        key, request = waiting[command.number]
        if request.agent == own:
            raise errors.Refused(f"request {request.number} is your own; somebody else must decide it")
        return (self._decide(key, request, command),)

    def _decide(self, key: tuple[str, str], request: Request, command: Approve) -> Request:
        self._by_id[key] = decided = structs.replace(
            request,
            decision="rejected" if command.reject else "approved",
            by=agents.name_of(command.agent) or command.source,
        )
        return decided

    def _forget(self) -> None:
        before = self._clock_ns() - _LASTS_NS
        self._by_id = {key: request for key, request in self._by_id.items() if request.stamp_ns >= before}
