"""The coordinator's end of `semmap/bridge`: what it asks of the knowledge base, and how long it waits."""

from __future__ import annotations

from concurrent.futures import Future
from typing import Any, TypeVar

from nodes import bus
from nodes.runtime.futures import settle
from nodes.runtime.loop import Node
from schemas import errors, keys
from schemas.calls import Call, Relay
from schemas.commands import Command

R = TypeVar("R")

_LONG_S = {"load": 300.0, "load-tbox": 300.0, "undo": 300.0}
"""What keeps the knowledge base busy; the heart goes on beating meanwhile."""
_BESIDE_S = {"check": 660.0, "sparql": 180.0, "watch": 180.0}
"""What is worked out beside its other work."""
_USUALLY_S = 10.0
_AT_ONCE_S = 3.0


class Bridge:
    """Owned by the coordinator's thread."""

    def __init__(self, node: Node) -> None:
        self._node = node

    def ask(self, call: Call[R]) -> R:
        """The answer; nothing else is done until it comes. Raises its error."""
        return self._node.ask(keys.BRIDGE, call, timeout_s=_USUALLY_S)

    def ask_later(self, call: Call[R], *, patience_s: float = 0.0) -> Future[R]:
        """The answer when it comes; NoAnswer when nobody serves the key for `patience_s`."""
        return self._node.ask_later(keys.BRIDGE, call, patience_s=patience_s)

    def change(self, call: Call[R]) -> Future[R]:
        """The same as `change_later`, waited for here while somebody is there: that takes less time."""
        timeout_s, beating = _LONG_S.get(call.VERB, _AT_ONCE_S), call.VERB in _LONG_S
        future: Future[R] = Future()
        settle(
            future,
            lambda: self._node.ask(keys.BRIDGE, call, timeout_s=timeout_s, patience_s=0.0, beating=beating),
        )
        return self.change_later(call) if _is_unanswered(future) else future

    def change_later(self, call: Call[R]) -> Future[R]:
        """The answer when it comes; while nobody serves the key it is asked again, over a restart.

        What is asked has the id of its command, so that it is done once.
        """
        timeout_s = _LONG_S.get(call.VERB, _USUALLY_S)
        return self._node.ask_later(keys.BRIDGE, call, timeout_s=timeout_s, patience_s=bus.RESTART_S)

    def relay(self, command: Command[R]) -> Relay[R]:
        """Let the knowledge base answer a command itself."""
        return Relay(keys.BRIDGE, command, _BESIDE_S.get(command.VERB, bus.TIMEOUT_S))


def _is_unanswered(asked: Future[Any]) -> bool:
    return isinstance(asked.exception(), errors.NoAnswer)
