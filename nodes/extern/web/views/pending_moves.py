"""Steps of entities by the arrow keys that the map does not have yet, grouped into changes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from msgspec import structs

from semmap.nodes.extern.web.views.entities.forms import build_move
from semmap.schemas.commands import Batch, Update
from semmap.schemas.entities import Entity, Pose, Vector


class _Move(NamedTuple):
    names: tuple[str, ...]
    x_m: float
    y_m: float


class PendingMoves:
    """Moves in the order in which they are sent, one change each; at most one is sent at a time."""

    def __init__(self) -> None:
        self.presses = 0
        """The number of steps so far."""
        self._moves: list[_Move] = []
        self._is_closed = True
        """Whether the next step begins another move."""
        self._sent: Mapping[str, Vector] = {}
        """The positions in the change that was sent last, until the map has it."""

    @property
    def is_empty(self) -> bool:
        """Whether every step was sent."""
        return not self._moves

    @property
    def is_first_open(self) -> bool:
        """Whether further steps can still become part of the move that is sent next."""
        return len(self._moves) == 1 and not self._is_closed

    def add(self, names: tuple[str, ...], step_m: tuple[float, float]) -> None:
        """Add a step of the selected entities along x and y to the last move, or begin another one."""
        self.presses += 1
        x, y = step_m
        if not self._is_closed and self._moves and self._moves[-1].names == names:
            last = self._moves.pop()
            x, y = last.x_m + x, last.y_m + y
        self._moves.append(_Move(names, x, y))
        self._is_closed = False

    def close(self) -> None:
        """End the last move, because of another selection."""
        self._is_closed = True

    def discard_last(self) -> bool:
        """Discard the last move if it was not taken yet; return whether there was one."""
        if not self._moves:
            return False
        self._moves.pop()
        self._is_closed = True
        return True

    def clear(self) -> None:
        """Discard all steps, because another map is served."""
        self._moves.clear()
        self._sent = {}

    def take(self, entities: Mapping[str, Entity]) -> Batch | None:
        """Remove the first move, and return its change of the current entities.

        Return None if its steps cancel one another. Raises BadRequest if none of the entities has a position.
        """
        move = self._moves.pop(0)
        x, y = round(move.x_m, 3), round(move.y_m, 3)
        if not (x or y):
            return None
        change = build_move([entities[name] for name in move.names if name in entities], (x, y, 0.0))
        updates = (update for update in change.changes if isinstance(update, Update))
        self._sent = {update.name: update.at for update in updates if update.at is not None}
        return change

    def finish(self) -> None:
        """Forget the change that was sent last: the map has it, or it was rejected."""
        self._sent = {}

    def poses_after(self, entities: Mapping[str, Entity]) -> dict[str, Pose]:
        """Return the poses of the moved entities after all steps, also those being sent."""
        offsets = dict.fromkeys(self._sent, (0.0, 0.0))
        for move in self._moves:
            for name in move.names:
                x, y = offsets.get(name, (0.0, 0.0))
                offsets[name] = x + move.x_m, y + move.y_m
        poses = {}
        for name, (x, y) in offsets.items():
            if name in entities and (pose := entities[name].pose) is not None:
                px, py, pz = self._sent.get(name, pose.position_m)
                poses[name] = structs.replace(pose, position_m=(px + x, py + y, pz))
        return poses
