"""What people show perception, on its way there: the map knows which classes and entities there are."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

from msgspec import structs

from semmap.nodes.coordinator.door import Door
from semmap.schemas import commands as c
from semmap.schemas import errors, keys
from semmap.schemas.calls import Relay
from semmap.schemas.exemplars import LessonTold

R = TypeVar("R")

_TIMEOUT_S = 60.0


class Teaching:
    """Passes lessons on to perception. Raises NoAnswer when none runs."""

    def __init__(self, door: Door, perceives: Callable[[], bool]) -> None:
        """`perceives` tells whether perception runs."""
        self._door = door
        self._perceives = perceives

    def learn(self, command: c.Learn) -> Relay[LessonTold]:
        """Raises UnknownClass, UnknownName, BadRequest for what cannot be shown."""
        found = self._class_of(command.class_)
        if (command.entity is None) == (not command.views):
            raise errors.BadRequest("show either an entity that perception sees, or views of a thing")
        if command.entity is not None:
            entity = self._door.map.entity(command.entity)
            if entity.place:
                raise errors.Refused(f"{entity.name} is a place; only things can be shown")
        return self.relay(structs.replace(command, class_=found))

    def relay(self, command: c.Command[R]) -> Relay[R]:
        """Let perception answer."""
        if not self._perceives():
            raise errors.NoAnswer(
                "no perception is running, which could learn: semmap up --perception; or without a system:"
                " --data DIR"
            )
        return Relay(keys.PERCEPTION, command, _TIMEOUT_S)

    def _class_of(self, word: str) -> str:
        try:
            found = self._door.map.classes.spatial(word)
        except errors.UnknownClass as error:
            raise errors.UnknownClass(
                f"{error.text}; a class of your own is added to the TBox first: semmap load --tbox FILE"
            ) from None
        if found.place:
            raise errors.UnknownClass(f"'{found.name}' is a class of places; only things can be shown")
        return found.name
