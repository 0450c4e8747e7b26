"""The coordinator's requests to the knowledge base, with their time-outs."""

from __future__ import annotations

from concurrent.futures import Future
from typing import TypeVar

from semmap.nodes import bus
from semmap.nodes.runtime.futures import SingleThreadFuture
from semmap.nodes.runtime.loop import HasGone, Node, never
from semmap.schemas import errors, keys
from semmap.schemas.calls import Call, Relay
from semmap.schemas.commands import Command

R = TypeVar("R")

_TIMEOUT_S = 6 * 3600.0
"""Time-out of long work. The knowledge base is supervised, and the request ends when its process ends."""
_BLOCKING_S = 0.15
"""Longest blocking wait. Otherwise `status` and the heartbeat would stop while the knowledge base works."""
_START_TIMEOUT_S = 900.0
"""A large map takes this long to start."""


class KbClient:
    """Owned by the coordinator's thread."""

    def __init__(self, node: Node) -> None:
        self._node = node

    def ask(self, call: Call[R]) -> R:
        """Return the reply, and block until it arrives. Raises its error."""
        return self._node.ask(keys.BRIDGE, call, timeout_s=_TIMEOUT_S, beating=True)

    def ask_later(self, call: Call[R], *, patience_s: float = 0.0) -> Future[R]:
        """Return the future reply; it raises NoAnswer if no node serves the key for `patience_s`."""
        return self._node.ask_later(keys.BRIDGE, call, timeout_s=_TIMEOUT_S, patience_s=patience_s)

    def change(self, call: Call[R], has_gone: HasGone = never) -> Future[R]:
        """Send a change like `change_later`, but wait a short time for the reply, which is faster.

        A change that takes longer is not waited for, so that other requests are answered in the meantime.
        """
        if not call.is_quick:
            return self.change_later(call, has_gone)
        future: Future[R] = SingleThreadFuture()
        try:
            future.set_result(self._node.ask(keys.BRIDGE, call, timeout_s=_BLOCKING_S, patience_s=0.0))
        except bus.TimedOut:
            return self.change_later(call, has_gone)
        except errors.NoAnswer as error:
            if not has_gone():
                return self.change_later(call, has_gone)
            future.set_exception(error)
        except Exception as error:
            future.set_exception(error)
        return future

    def change_later(self, call: Call[R], has_gone: HasGone = never) -> Future[R]:
        """Send a change, and repeat it while no node serves the key, as during a restart.

        A change has the id of its command, so it is executed only once. It is not repeated if its client
        `has_gone`.
        """
        patience_s = bus.RESTART_S if call.is_quick else _START_TIMEOUT_S
        return self._node.ask_later(
            keys.BRIDGE, call, timeout_s=_TIMEOUT_S, patience_s=patience_s, has_gone=has_gone
        )

    def relay(self, command: Command[R]) -> Relay[R]:
        """Forward a command to the knowledge base."""
        return Relay(keys.BRIDGE, command, _TIMEOUT_S)
