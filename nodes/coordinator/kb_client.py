"""The coordinator's end of `semmap/bridge`: what it asks of the knowledge base, and how long it waits."""

from __future__ import annotations

from concurrent.futures import Future
from typing import TypeVar

from semmap.nodes import bus
from semmap.nodes.runtime.futures import SingleThreadFuture
from semmap.nodes.runtime.loop import Node
from semmap.schemas import errors, keys
from semmap.schemas.calls import Call, Relay
from semmap.schemas.commands import Command

R = TypeVar("R")

_BUSY_S = 6 * 3600.0
"""However long the knowledge base works: it is watched, and its end ends the question."""
_AT_ONCE_S = 0.15
"""Then it goes on without waiting here, or `status` would wait, and the heart stop with the other one's."""
_OVER_A_START_S = 900.0
"""A large map takes its time to start."""


class KbClient:
    """Owned by the coordinator's thread."""

    def __init__(self, node: Node) -> None:
        self._node = node

    def ask(self, call: Call[R]) -> R:
        """The answer; nothing else is done until it comes. Raises its error."""
        return self._node.ask(keys.BRIDGE, call, timeout_s=_BUSY_S, beating=True)

    def ask_later(self, call: Call[R], *, patience_s: float = 0.0) -> Future[R]:
        """The answer when it comes; NoAnswer when nobody serves the key for `patience_s`."""
        return self._node.ask_later(keys.BRIDGE, call, timeout_s=_BUSY_S, patience_s=patience_s)

    def change(self, call: Call[R]) -> Future[R]:
        """The same as `change_later`, waited for here while somebody is there: that takes less time.

        What takes long is not waited for: other questions are answered meanwhile.
        """
        if not call.is_quick:
            return self.change_later(call)
        future: Future[R] = SingleThreadFuture()
        try:
            future.set_result(self._node.ask(keys.BRIDGE, call, timeout_s=_AT_ONCE_S, patience_s=0.0))
        except errors.NoAnswer:
            return self.change_later(call)
        except Exception as error:
            future.set_exception(error)
        return future

    def change_later(self, call: Call[R]) -> Future[R]:
        """The answer when it comes; while nobody serves the key it is asked again, over a restart.

        What is asked has the id of its command, so that it is done once.
        """
        patience_s = bus.RESTART_S if call.is_quick else _OVER_A_START_S
        return self._node.ask_later(keys.BRIDGE, call, timeout_s=_BUSY_S, patience_s=patience_s)

    def relay(self, command: Command[R]) -> Relay[R]:
        """Let the knowledge base answer a command itself."""
        return Relay(keys.BRIDGE, command, _BUSY_S)
