"""Commands about exemplars: checks their classes and entities, and forwards them to perception."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

from msgspec import structs

from semmap.nodes.coordinator.commands.dispatcher import CommandDispatcher
from semmap.schemas import commands as c
from semmap.schemas import errors, keys
from semmap.schemas.calls import Relay
from semmap.schemas.exemplars import LessonTold

R = TypeVar("R")

_TIMEOUT_S = 60.0


class ExemplarCommands:
    """Forwards exemplars to perception. Raises NoAnswer if perception is not running."""

    def __init__(self, dispatcher: CommandDispatcher, perceives: Callable[[], bool]) -> None:
        """`perceives()` returns whether perception is running."""
        self._dispatcher = dispatcher
        self._perceives = perceives

    def learn(self, command: c.Learn) -> Relay[LessonTold]:
        """Teach an exemplar. Raises UnknownClass, UnknownName or BadRequest if it cannot be taught."""
        found = self._class_of(command.class_)
        if (command.entity is None) == (not command.views):
            raise errors.BadRequest("give either an entity that perception sees, or views of an object")
        if command.entity is not None:
            entity = self._dispatcher.map.entity(command.entity)
            if entity.place:
                raise errors.Refused(f"{entity.name} is a place; only objects can be learned")
        return self.relay(structs.replace(command, class_=found))

    def relay(self, command: c.Command[R]) -> Relay[R]:
        """Forward a command to perception."""
        if not self._perceives():
            raise errors.NoAnswer(
                "perception is not running; start it with: semmap up --perception; or, without a system, use"
                " --data DIR"
            )
        return Relay(keys.PERCEPTION, command, _TIMEOUT_S)

    def _class_of(self, word: str) -> str:
        try:
            found = self._dispatcher.map.classes.spatial(word)
        except errors.UnknownClass as error:
            raise errors.UnknownClass(
                f"{error.text}; to add it to the TBox, below Object: semmap learn --new-class"
            ) from None
        if found.place:
            raise errors.UnknownClass(f"'{found.name}' is a class of places; only objects can be learned")
        return found.name
