"""Queries that the coordinator answers from its replica of the map: list, get, status."""

from __future__ import annotations

from collections.abc import Iterable
from concurrent.futures import Future
from contextlib import suppress
from typing import Any, TypeVar

from msgspec import structs

from semmap.nodes import bus
from semmap.nodes.coordinator import formats
from semmap.nodes.coordinator.commands.dispatcher import CommandDispatcher
from semmap.nodes.coordinator.config import Truth
from semmap.nodes.coordinator.frames.feed import Frames
from semmap.nodes.coordinator.health_view import HealthView
from semmap.nodes.coordinator.kb_client import KbClient
from semmap.nodes.coordinator.live.feed import LiveFeed
from semmap.nodes.coordinator.reconciler.reconciler import Reconciler
from semmap.nodes.runtime.class_names import AmbiguousClass
from semmap.nodes.runtime.futures import then
from semmap.nodes.runtime.version import version
from semmap.ontology.model_shapes import own_size_m
from semmap.schemas import bridge, errors
from semmap.schemas import commands as c
from semmap.schemas.attachments import holder_of
from semmap.schemas.entities import Entity, Size
from semmap.schemas.relations import Described
from semmap.schemas.replies import SystemStatus

_DIGITS = 4
_MAX_SENTENCES = 5
"""Largest number of sentences of one kind in a status."""
E = TypeVar("E", bound=Entity)

Listed = tuple[Entity, ...] | dict[str, Any]
"""The entities, or a document in another format."""


class LocalQueries:
    """Answers queries about the present itself, and forwards queries about the past to the knowledge base."""

    def __init__(
        self,
        truth: Truth,
        dispatcher: CommandDispatcher,
        reconciler: Reconciler,
        health: HealthView,
        kb: KbClient,
        live: LiveFeed,
        frames: Frames,
    ) -> None:
        self._truth = truth
        self._dispatcher = dispatcher
        self._reconciler = reconciler
        self._health = health
        self._kb = kb
        self._live = live
        self._frames = frames

    def list(self, query: c.List) -> Listed | Future[Listed]:
        """Return the entities of a class, with the state of their bodies."""
        if query.all:
            return self._list_all(query)
        class_ = None if query.class_ is None else self._class_name(query.class_)
        is_of_tbox = class_ is None or class_ in self._dispatcher.map.classes.by_name
        if query.as_of is not None or query.where is not None or not is_of_tbox:
            asked = bridge.Entities(class_=class_, as_of=query.as_of, where=query.where)
            found = self._kb.ask_later(asked, patience_s=bus.RESTART_S)
            seen = with_size if query.as_of is not None else self._with_body
            return then(found, lambda there: self._formatted(map(seen, there), query.format))
        entities = self._dispatcher.map.entities_of(class_)
        if query.format == "json":
            entities = tuple(map(self._with_body, entities))
        return self._formatted(entities, query.format)

    def _list_all(self, query: c.List) -> Future[Listed]:
        """Return the entities and the individuals that are not in space. Raises BadRequest."""
        if query.as_of is not None or query.where is not None or query.format != "json":
            raise errors.BadRequest(
                "--all lists individuals that are not in space, which have no location and are not listed for"
                " the past or in the formats lu4r and legacy; remove --all or the other option"
            )
        class_ = query.class_
        if class_ is not None:
            with suppress(errors.UnknownClass):  # it may be a class that only the map uses
                class_ = self._dispatcher.map.classes.find(class_).name
        found = self._kb.ask_later(bridge.Entities(class_=class_, all=True), patience_s=bus.RESTART_S)
        return then(found, lambda there: tuple(map(self._with_body, there)))

    def get(self, query: c.Get) -> Described | Future[Described]:
        """Return one entity, with the state of its body; or an individual that is not in space."""
        if query.as_of is not None:
            return then(self._kb.ask_later(query, patience_s=bus.RESTART_S), with_size)
        if query.where or query.name not in self._dispatcher.map.entities:
            return then(self._kb.ask_later(query, patience_s=bus.RESTART_S), self._with_body)
        return Described.of(self._with_body(self._dispatcher.map.entity(query.name)))

    def status(self, query: c.Status) -> SystemStatus:
        """Return the state of the nodes, the map and the scene."""
        agreement, streamed = (
            self._reconciler.agreement(query.names or None),
            self._live.displaced(query.names),
        )
        return SystemStatus(
            truth=self._truth,
            commit=max(0, self._dispatcher.map.seq),
            entities=len(self._dispatcher.map.entities),
            bodies=len(self._reconciler.scene.bodies),
            in_agreement=agreement.holds and not streamed,
            nodes=self._health.nodes(),
            problems=(*self._reconciler.problems(), *self._live.problems(), *self._frames.problems()),
            version=version(),
            pending=_shorten(agreement.pending),
            displaced=_shorten((*agreement.displaced, *streamed)),
        )

    def _formatted(self, found: Iterable[Entity], wanted: c.ListFormat) -> Listed:
        entities = tuple(found)
        if wanted == "lu4r":
            return formats.lu4r(entities)
        if wanted == "legacy":
            iris = {name: info.iri for name, info in self._dispatcher.map.classes.by_name.items()}
            return formats.legacy(entities, iris)
        return entities

    def _class_name(self, word: str) -> str:
        """Return the name of a class; the word for a class of the past, or one that only the map declares."""
        try:
            return self._dispatcher.map.classes.find(word).name
        except AmbiguousClass:
            raise
        except errors.UnknownClass:
            return word

    def _with_body(self, entity: E) -> E:
        """Return the entity with its body state, and with its current pose if it is tracked or attached."""
        if not entity.in_space:
            return entity
        if entity.tracked or holder_of(entity):
            entity = structs.replace(entity, live=self._live.live_pose(entity))
        state, body = self._reconciler.body_state(entity), self._reconciler.scene.bodies.get(entity.name)
        if entity.size_m is not None or state.status == "none":
            return structs.replace(entity, body=state)
        if not entity.model:  # its body is a default box, whose size is not that of the entity
            known = "" if body is None else _describe_default_box(body.size_m)
            detail = "; ".join(filter(None, (state.detail, known)))
            return structs.replace(entity, body=structs.replace(state, detail=detail))
        sized = with_size(entity) if body is None else structs.replace(entity, size_m=_rounded(body.size_m))
        return structs.replace(sized, body=structs.replace(state, own_size=sized.size_m is not None))


def with_size(entity: E) -> E:
    """Return the entity with the size of its model, if the map states none and it is not a place."""
    if entity.size_m is not None or entity.place or not entity.model:
        return entity
    return structs.replace(entity, size_m=own_size_m(entity.model))


def _shorten(sentences: tuple[str, ...]) -> tuple[str, ...]:
    """Return the first sentences, and how many more there are."""
    more = len(sentences) - _MAX_SENTENCES
    return sentences if more <= 0 else (*sentences[:_MAX_SENTENCES], f"… and {more} more")


def _describe_default_box(size_m: Size) -> str:
    sides = " x ".join(f"{side:g}" for side in _rounded(size_m))
    return f"shown as a box of {sides} m, because neither the map nor a model gives its size"


def _rounded(size_m: Size) -> Size:
    """Round to the precision of the model table, so that the size does not change when the body appears."""
    x, y, z = size_m
    return round(x, _DIGITS), round(y, _DIGITS), round(z, _DIGITS)
