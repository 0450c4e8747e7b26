"""The rate limit of changes, and their approval by a person."""

from __future__ import annotations

import math
import threading
import time
from contextlib import suppress
from contextvars import ContextVar
from typing import Final

from msgspec import structs

from semmap.nodes.extern.client import Client
from semmap.nodes.extern.mcp.answers import Answer
from semmap.nodes.extern.mcp.consistent_read import newest
from semmap.nodes.extern.mcp.limits import Rate
from semmap.nodes.extern.mcp.requests import Summary
from semmap.schemas import errors
from semmap.schemas.approvals import Request
from semmap.schemas.commands import Submit

CANCELLED: ContextVar[threading.Event | None] = ContextVar("cancelled", default=None)
"""Set when the host of the agent cancels the call that runs in this context."""
PATIENCE_S: Final = 20.0
"""How long a call waits for the approval of a person before it returns [s]."""
_AGAIN_S: Final = 0.5
_MOST_WAITERS: Final = 2
"""The number of calls that wait for approval at the same time, each on a thread; others do not wait."""
_LATER_S: Final = 30.0
"""The suggested time until a retry if there are too many pending requests [s]."""
_MOST_REQUESTED: Final = 1000
_ENDS_WITHIN_S: Final = 2.0
"""The timeout of each withdrawal at the end; after one without a reply, no other is sent [s]."""


class Approval:
    """The rate limit of one agent and its requests for approval. It can be used from any thread."""

    def __init__(self, agent: str, *, per_min: float, required: bool, patience_s: float) -> None:
        self.required = required
        self._agent = agent
        self._patience_s = patience_s
        self._rate = Rate(per_min / 60.0, max(1.0, per_min))
        self._per_min = per_min
        self._waiters = threading.BoundedSemaphore(_MOST_WAITERS)
        self._requested: dict[str, bool] = {}
        """By name, whether the request may be pending."""
        self._has_ended = threading.Event()

    def require(self, client: Client, name: str, summary: Summary) -> Request | None:
        """Request approval and wait for it a short time; return None if no approval is required.

        Each change counts once against the rate limit: when approval is requested, or else when it is made.
        Raises Busy beyond the rate and for a cancelled call, and Refused if the request was rejected.
        """
        if not self.required:
            self._require_rate()
            return None
        if name not in self._requested:
            self._require_rate()
        submit = Submit(
            id=name,
            source="agent",
            agent=self._agent,
            text=errors.shortened(summary.text, 1900),
            reason=summary.reason,
            follows=tuple(errors.shortened(fact, 900) for fact in summary.follows),
        )
        self._require_not_ended()
        try:
            request = client.send(submit)
        except errors.Refused as error:  # too many pending requests; the proposal stays valid
            raise errors.Busy(error.text, again_s=_LATER_S) from None
        self._requested[name] = request.decision == "waiting"
        while len(self._requested) > _MOST_REQUESTED:
            del self._requested[next(iter(self._requested))]
        if request.decision == "waiting" and self._waiters.acquire(blocking=False):
            try:
                request = self._decided(client, submit)
                self._requested[name] = request.decision == "waiting"
            finally:
                self._waiters.release()
        if request.decision == "rejected":
            raise errors.Refused(f"request {request.number} was rejected by {request.by}")
        return request

    def withdraw_all(self, client: Client) -> None:
        """Withdraw the pending requests: the agent that made them has ended. No other is submitted later."""
        self._has_ended.set()
        with suppress(errors.NoAnswer):
            for name in [name for name, is_pending in self._requested.items() if is_pending]:
                with suppress(errors.BadRequest, errors.Refused, errors.Busy):
                    submit = Submit(id=name, source="agent", agent=self._agent, text="ended")
                    self._withdraw(client, submit, timeout_s=_ENDS_WITHIN_S)

    def _require_rate(self) -> None:
        if (wait_s := self._rate.wait_s()) > 0.0:
            raise errors.Busy(
                f"rate limit exceeded: {self._per_min:g} changes per minute; retry in {math.ceil(wait_s)} s",
                again_s=wait_s,
            )

    def _decided(self, client: Client, submit: Submit) -> Request:
        """Return the request when it is decided, or when the timeout has passed.

        Raises Busy, after the request is withdrawn, if the call is cancelled.
        """
        cancelled = CANCELLED.get() or threading.Event()
        deadline = time.monotonic() + self._patience_s
        while (request := client.send(submit)).decision == "waiting" and time.monotonic() < deadline:
            if cancelled.wait(_AGAIN_S):
                self._withdraw(client, submit)
                require_not_cancelled()
            self._require_not_ended()
        return request

    def _require_not_ended(self) -> None:
        if self._has_ended.is_set():
            raise errors.Busy("the server has ended; nothing has changed", again_s=0.0)

    def _withdraw(self, client: Client, submit: Submit, timeout_s: float = PATIENCE_S) -> None:
        """Withdraw a request. One that is decided already stays requested, so that a retry is not counted."""
        with suppress(errors.Refused):  # a restarted coordinator has no requests
            withdrawn = client.send(structs.replace(submit, withdraw=True), timeout_s=timeout_s)
            if withdrawn.decision != "withdrawn":
                return
        self._requested.pop(submit.id, None)


def require_not_cancelled() -> None:
    """Raise Busy if the host has cancelled the call; nothing has been changed, and it may be repeated."""
    if (cancelled := CANCELLED.get()) is not None and cancelled.is_set():
        raise errors.Busy("the call was cancelled; nothing has changed", again_s=0.0)


def report_waiting(client: Client, request: Request) -> Answer:
    """Return the reply to a call whose request is pending."""
    seq = newest(client)
    head = {
        "done": False,
        "waiting_for_a_person": f"semmap approve {request.number}",
        "then": "call again with the same arguments",
    }
    return Answer(first=seq, last=seq, head=head)
