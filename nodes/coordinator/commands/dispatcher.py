"""Selects the handler of a command that changes the map, and returns its result."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from semmap.nodes.coordinator.commands import attachment, batch, entity_changes, load, undo
from semmap.nodes.coordinator.commands.map_view import MapView
from semmap.nodes.coordinator.commands.registration import HANDLERS
from semmap.nodes.coordinator.kb_coroutines import Ask, KbCoroutine, gather, run, run_single
from semmap.nodes.coordinator.reconciler.observed_state import ObservedState
from semmap.nodes.coordinator.scene.manual_moves import Attribution, ManualMoves
from semmap.nodes.coordinator.scheduler import Change
from semmap.schemas.replies import Changed

_MODULES: Final = (attachment, batch, entity_changes, load, undo)
"""The modules with handlers, which are registered when they are imported."""


class CommandDispatcher:
    """Executes the commands that change the map, and holds the resulting map.

    Owned by the coordinator's thread. Raises the errors of the handlers and of the knowledge base.
    """

    def __init__(self, ask: Ask) -> None:
        """`ask(call)` sends a request to the knowledge base."""
        self.map = MapView()
        self._ask = ask
        self.manual_moves = ManualMoves()

    def change(self, command: Change) -> Changed:
        """Execute one command and return its result."""
        return run(self._handle(command), self._ask)

    def run_together(self, commands: Sequence[Change]) -> KbCoroutine[list[Changed | Exception]]:
        """Execute changes of different entities with as few requests as one needs."""
        if len(commands) == 1:
            return run_single(self._handle(commands[0]))
        return gather([self._handle(command) for command in commands])

    def _handle(self, command: Change) -> KbCoroutine[Changed]:
        if isinstance(command, ObservedState):
            return self._adopt(command)
        return HANDLERS[type(command)](self.map, command)

    def _adopt(self, observed: ObservedState) -> KbCoroutine[Changed]:
        """Commit the observed state of one entity, or of those that were moved together."""
        if observed.reason:
            return (
                yield from entity_changes.adopt_observed(
                    self.map, observed, Attribution("", "", observed.reason)
                )
            )
        with self.manual_moves.attribution_of(*observed.names) as cause:
            return (yield from entity_changes.adopt_observed(self.map, observed, cause))
