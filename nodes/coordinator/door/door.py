"""The door, as the coordinator's node sees it: a command goes in, and its result comes out."""

from __future__ import annotations

from collections.abc import Sequence

from nodes.coordinator.door import changing, loading, undoing
from nodes.coordinator.door.map_view import MapView
from nodes.coordinator.hands import Hands
from nodes.coordinator.talking import Ask, Talk, hold, in_step
from schemas import errors
from schemas.commands import Add, Clear, Load, Remove, Undo, Update
from schemas.entities import Pose
from schemas.replies import Changed


class Door(MapView):
    """Executes the commands that change the map, and sees it as they leave it.

    Owned by the coordinator's thread. Errors are those that the command deserves, and those of the knowledge
    base.
    """

    def __init__(self, ask: Ask) -> None:
        """`ask(verb, message)` asks the knowledge base."""
        super().__init__()
        self._ask = ask
        self.hands = Hands()

    def change(self, command: Add | Update) -> Changed:
        """Put an entity into the map, or change what is named of one; what is not named stays."""
        return hold(self._changing(command), self._ask)

    def together(self, commands: Sequence[Add | Update]) -> Talk[list[Changed | errors.SemmapError]]:
        """Changes of different entities, with as few questions as one."""
        return in_step([self._changing(command) for command in commands])

    def _changing(self, command: Add | Update) -> Talk[Changed]:
        return changing.add(self, command) if isinstance(command, Add) else changing.update(self, command)

    def remove(self, command: Remove) -> Changed:
        """Take entities out: all of them, or, if one is unknown, none."""
        return hold(changing.remove(self, command), self._ask)

    def clear(self, command: Clear) -> Changed:
        """Take every entity out."""
        return hold(changing.clear(self, command), self._ask)

    def load(self, command: Load) -> Changed:
        """Add what a file describes."""
        return hold(loading.load(self, command), self._ask)

    def undo(self, command: Undo) -> Changed:
        """Take back a commit."""
        return hold(undoing.undo(self, command), self._ask)

    def follow(self, name: str, pose: Pose) -> None:
        """The map takes over where a body came to rest."""
        hold(changing.follow(self, name, pose, self.hands.that_moved(name)), self._ask)
