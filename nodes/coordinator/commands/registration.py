"""The table of the handlers of commands that change the map. Each handler is registered where it is defined.

@handles(Remove)
def remove(view: MapView, command: Remove) -> KbCoroutine[Changed]: ...
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final

from semmap.nodes.coordinator.commands.commit import C, Change, idempotent
from semmap.schemas.commands import Command

HANDLERS: Final[dict[type[Command], Change[Any]]] = {}
"""The handlers by the type of the command. `dispatcher.py` imports their modules."""


def handles(kind: type[C]) -> Callable[[Change[C]], Change[C]]:
    """Register a function as the handler of a command, and make the command idempotent."""

    def register(change: Change[C]) -> Change[C]:
        HANDLERS[kind] = handler = idempotent(change)
        return handler

    return register
