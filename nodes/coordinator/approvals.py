"""What agents ask to be allowed to do, and what persons decide. In memory: a restart forgets it."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Final

from msgspec import structs

from schemas import agents, errors, wording
from schemas.approvals import Request
from schemas.commands import Approve, Submit
from schemas.entities import LESSER

_LASTS_NS: Final = 3_600_000_000_000
_MOST: Final = 100
"""Requests that wait at most."""


class Approvals:
    """Owned by the coordinator's thread."""

    def __init__(self, clock_ns: Callable[[], int] = time.time_ns) -> None:
        self._clock_ns = clock_ns
        self._last = 0
        self._by_id: dict[tuple[str, str], Request] = {}

    def submit(self, command: Submit) -> Request:
        """Ask, or look what became of it: the same id of the same agent is the same request.

        Raises BadRequest without an id, Busy when very many wait.
        """
        self._forget()
        if not command.id:
            raise errors.BadRequest("give the request an id, by which to ask what became of it")
        key = (command.agent, command.id)
        if (known := self._by_id.get(key)) is not None:
            return known
        if sum(request.decision == "waiting" for request in self._by_id.values()) >= _MOST:
            raise errors.Busy(
                f"{_MOST} requests wait for a person already; see: semmap approve", again_s=60.0
            )
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
        """Those that wait; or, with a number, that one as it is decided now.

        Raises Refused for one that is not there or decided already, for an agent, and for who asked for it.
        """
        self._forget()
        waiting = {r.number: (key, r) for key, r in self._by_id.items() if r.decision == "waiting"}
        if command.number is None:
            return tuple(request for _, request in waiting.values())
        if command.number not in waiting:
            there = wording.few([str(number) for number in waiting])
            raise errors.Refused(f"no request {command.number} is waiting; there are: {there}")
        key, request = waiting[command.number]
        if command.source in LESSER:
            raise errors.Refused("only an operator may approve or reject")
        if agents.is_proved(command.agent) and command.agent == request.agent:
            raise errors.Refused(f"request {request.number} is your own; somebody else must decide it")
        decided = structs.replace(
            request,
            decision="rejected" if command.reject else "approved",
            by=agents.name_of(command.agent) or command.source,
        )
        self._by_id[key] = decided
        return (decided,)

    def _forget(self) -> None:
        before = self._clock_ns() - _LASTS_NS
        self._by_id = {key: request for key, request in self._by_id.items() if request.stamp_ns >= before}
