"""What the coordinator answers itself, from its replica of the map: list, get, status."""

from __future__ import annotations

from collections.abc import Iterable
from concurrent.futures import Future
from typing import Any, TypeVar

from msgspec import structs

from semmap.nodes import bus
from semmap.nodes.coordinator import formats
from semmap.nodes.coordinator.config import Truth
from semmap.nodes.coordinator.door import Door
from semmap.nodes.coordinator.frames.feed import Frames
from semmap.nodes.coordinator.health_view import HealthView
from semmap.nodes.coordinator.kb_client import Bridge
from semmap.nodes.coordinator.live.feed import LiveFeed
from semmap.nodes.coordinator.scene.reconciler import Keeping
from semmap.nodes.runtime.futures import then
from semmap.nodes.runtime.version import version
from semmap.ontology.model_shapes import own_size_m
from semmap.schemas import bridge, errors
from semmap.schemas import commands as c
from semmap.schemas.attachments import holder_of
from semmap.schemas.entities import Entity, Size
from semmap.schemas.moments import When
from semmap.schemas.relations import Described
from semmap.schemas.replies import SystemStatus

_DIGITS = 4
_MOST = 5
"""So many sentences of one kind are in a status."""
E = TypeVar("E", bound=Entity)

Listed = tuple[Entity, ...] | dict[str, Any]
"""The entities, or the document of another format."""


class Answers:
    """What is true now is known to the door; the past is asked of the knowledge base."""

    def __init__(
        self,
        truth: Truth,
        door: Door,
        keeping: Keeping,
        health: HealthView,
        bridge: Bridge,
        live: LiveFeed,
        frames: Frames,
    ) -> None:
        self._truth = truth
        self._door = door
        self._keeping = keeping
        self._health = health
        self._bridge = bridge
        self._live = live
        self._frames = frames

    def list(self, query: c.List) -> Listed | Future[Listed]:
        """The entities of a class, with what has become of their bodies."""
        class_ = None if query.class_ is None else self._class_name(query.class_, query.as_of)
        if query.as_of is not None or query.where is not None:
            asked = bridge.Entities(class_=class_, as_of=query.as_of, where=query.where)
            found = self._bridge.ask_later(asked, patience_s=bus.RESTART_S)
            seen = with_size if query.as_of is not None else self._with_body
            return then(found, lambda there: self._formatted(map(seen, there), query.format))
        entities = self._door.map.entities_of(class_)
        if query.format == "json":
            entities = tuple(map(self._with_body, entities))
        return self._formatted(entities, query.format)

    def get(self, query: c.Get) -> Described | Future[Described]:
        """One entity, with what has become of its body."""
        if query.as_of is not None:
            return then(self._bridge.ask_later(query, patience_s=bus.RESTART_S), with_size)
        if query.where:
            return then(self._bridge.ask_later(query, patience_s=bus.RESTART_S), self._with_body)
        return Described.of(self._with_body(self._door.map.entity(query.name)))

    def status(self, query: c.Status) -> SystemStatus:
        """The nodes, the map, the scene."""
        agreement, streamed = self._keeping.agreement(query.names or None), self._live.displaced(query.names)
        return SystemStatus(
            truth=self._truth,
            commit=max(0, self._door.map.seq),
            entities=len(self._door.map.entities),
            bodies=len(self._keeping.scene.bodies),
            in_agreement=agreement.holds and not streamed,
            nodes=self._health.nodes(),
            problems=(*self._keeping.problems(), *self._live.problems(), *self._frames.problems()),
            version=version(),
            pending=_few(agreement.pending),
            displaced=_few((*agreement.displaced, *streamed)),
        )

    def _formatted(self, found: Iterable[Entity], wanted: c.ListFormat) -> Listed:
        entities = tuple(found)
        if wanted == "lu4r":
            return formats.lu4r(entities)
        if wanted == "legacy":
            iris = {name: info.iri for name, info in self._door.map.classes.by_name.items()}
            return formats.legacy(entities, iris)
        return entities

    def _class_name(self, word: str, as_of: When | None) -> str:
        """The class that is meant; then there may have been others than now."""
        try:
            return self._door.map.classes.find(word).name
        except errors.UnknownClass:
            if as_of is None:
                raise
            return word

    def _with_body(self, entity: E) -> E:
        """With what has become of its body, and where it is just now if it is tracked or held."""
        if entity.tracked or holder_of(entity):
            entity = structs.replace(entity, live=self._live.of(entity))
        state, body = self._keeping.body_state(entity), self._keeping.scene.bodies.get(entity.name)
        if entity.size_m is not None or state.status == "none":
            return structs.replace(entity, body=state)
        if not entity.model:  # its body is a box, whose size says nothing of the entity's
            known = "" if body is None else _stands_in(body.size_m)
            detail = "; ".join(filter(None, (state.detail, known)))
            return structs.replace(entity, body=structs.replace(state, detail=detail))
        sized = with_size(entity) if body is None else structs.replace(entity, size_m=_rounded(body.size_m))
        return structs.replace(sized, body=structs.replace(state, own_size=sized.size_m is not None))


def with_size(entity: E) -> E:
    """The entity with the size of its model, if it has one, the map states none and it is no place."""
    if entity.size_m is not None or entity.place or not entity.model:
        return entity
    return structs.replace(entity, size_m=own_size_m(entity.model))


def _few(sentences: tuple[str, ...]) -> tuple[str, ...]:
    """The first, and how many more there are."""
    more = len(sentences) - _MOST
    return sentences if more <= 0 else (*sentences[:_MOST], f"… and {more} more")


def _stands_in(size_m: Size) -> str:
    sides = " x ".join(f"{side:g}" for side in _rounded(size_m))
    return f"a box of {sides} m stands in for it, because neither the map nor a model says how large it is"


def _rounded(size_m: Size) -> Size:
    """To the precision of the table of models, so that an entity's size is the same before it has a body."""
    x, y, z = size_m
    return round(x, _DIGITS), round(y, _DIGITS), round(z, _DIGITS)
