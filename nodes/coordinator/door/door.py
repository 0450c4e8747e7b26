"""The door, as the coordinator's node sees it: a command goes in, and its result comes out."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from semmap.nodes.coordinator.dialogues import Ask, Talk, alone, hold, in_step
from semmap.nodes.coordinator.door import attaching, batching, changing, loading, undoing
from semmap.nodes.coordinator.door.known_map import KnownMap
from semmap.nodes.coordinator.scene.hands import Hand, Hands
from semmap.nodes.coordinator.scene.settled import Settled
from semmap.nodes.coordinator.turns import Change
from semmap.schemas.commands import (
    Add,
    Attach,
    Batch,
    Clear,
    Command,
    Detach,
    Load,
    Remove,
    Set,
    Track,
    Undo,
    Unset,
    Update,
)
from semmap.schemas.replies import Changed

_CHANGING: Mapping[type[Command], Callable[[KnownMap, Any], Talk[Changed]]] = {
    Add: changing.add,
    Update: changing.update,
    Set: changing.set_,
    Unset: changing.unset,
    Batch: batching.batch,
    Track: changing.track,
    Attach: attaching.attach,
    Detach: attaching.detach,
    Remove: changing.remove,
    Clear: changing.clear,
    Load: loading.load,
    Undo: undoing.undo,
}


class Door:
    """Executes the commands that change the map, and sees it as they leave it.

    Owned by the coordinator's thread. Errors are those that the command deserves, and those of the knowledge
    base.
    """

    def __init__(self, ask: Ask) -> None:
        """`ask(call)` asks the knowledge base."""
        self.map = KnownMap()
        self._ask = ask
        self.hands = Hands()

    def change(self, command: Change) -> Changed:
        """Change the map as a command says."""
        return hold(self._changing(command), self._ask)

    def together(self, commands: Sequence[Change]) -> Talk[list[Changed | Exception]]:
        """Changes of different entities, with as few questions as one."""
        if len(commands) == 1:
            return alone(self._changing(commands[0]))
        return in_step([self._changing(command) for command in commands])

    def _changing(self, command: Change) -> Talk[Changed]:
        if isinstance(command, Settled):
            return self._settled(command)
        return _CHANGING[type(command)](self.map, command)

    def _settled(self, settled: Settled) -> Talk[Changed]:
        """The map takes over where things are: one, or those that a hand carried together."""
        if settled.reason:
            return (yield from changing.follow(self.map, settled, Hand("", "", settled.reason)))
        with self.hands.that_moved(*settled.names) as hand:
            return (yield from changing.follow(self.map, settled, hand))
