"""Requests of agents that an operator approves or rejects. They are lost at a restart."""

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
"""Largest number of waiting requests."""
_MOST_OF_ONE: Final = 10
"""Largest number of waiting requests of one agent."""


class Approvals:
    """Owned by the coordinator's thread."""

    def __init__(self, clock_ns: Callable[[], int] = time.time_ns) -> None:
        self._clock_ns = clock_ns
        self._last = 0
        self._by_id: dict[tuple[str, str], Request] = {}

    def submit(self, command: Submit) -> Request:
        """Submit a request, or return its state: the same id of the same agent is the same request.

        With `withdraw`, a pending request is deleted; a decided one is returned. Raises BadRequest without an
        id. Raises Refused if too many requests wait, in total or of this agent, and if there is none to
        withdraw. It is not Busy, because clients repeat busy requests and an operator takes longer than they
        wait.
        """
        self._forget()
        if not command.id:
            raise errors.BadRequest("the request has no id; it is needed to query the decision")
        key = (command.agent, command.id)
        known = self._by_id.get(key)
        if command.withdraw:
            return self._withdraw(key, known)
        if known is not None:
            return known
        waiting = [request.agent for request in self._by_id.values() if request.decision == "waiting"]
        if waiting.count(command.agent) >= _MOST_OF_ONE:
            raise errors.Refused(
                f"{_MOST_OF_ONE} of your requests already wait for approval; wait until some are decided"
            )
        if len(waiting) >= _MOST:
            raise errors.Refused(f"{_MOST} requests already wait for approval; wait until some are decided")
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
        """Return the waiting requests or, with a number or `all`, decide those and return them.

        Raises BadRequest for `all` without `reject`. Raises Refused for an agent, for the client's own
        request, and for a request that is unknown or decided.
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
                f"request {command.number} is not waiting{there or '; no request is waiting'}"
            )
        if command.source in LESSER:
            raise errors.Refused("only an operator may approve or reject")
        own = command.agent if agents.is_proved(command.agent) else None
        if command.number is None:
            others = [(key, request) for key, request in waiting.values() if request.agent != own]
            return tuple(self._decide(key, request, command) for key, request in others)
        key, request = waiting[command.number]
        if request.agent == own:
            raise errors.Refused(f"request {request.number} is your own; another operator must decide it")
        return (self._decide(key, request, command),)

    def _withdraw(self, key: tuple[str, str], known: Request | None) -> Request:
        if known is None:
            raise errors.Refused(f"there is no request with the id '{errors.shortened(key[1], 100)}'")
        if known.decision != "waiting":
            return known
        del self._by_id[key]
        return structs.replace(known, decision="withdrawn")

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
