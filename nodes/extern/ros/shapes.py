"""The shapes of entities, requested from the knowledge base once for each different one."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Future
from functools import partial
from typing import Final

import msgspec

from semmap.nodes.runtime.loop import Node
from semmap.ontology.model_shapes import ModelShape, WorldShapes
from semmap.schemas import errors, keys
from semmap.schemas.bridge import FoundShapes, ShapeKey, ShapesOf
from semmap.schemas.entities import Entity

_AT_ONCE: Final = 500
_RETRY_S: Final = 2.0
"""Time after which shapes that did not arrive are requested again."""


class ShapeTable:
    """The shapes of entities that were requested. Entities without a size and a model have none."""

    def __init__(self) -> None:
        self._known: dict[ShapeKey, ModelShape | None] = {}
        self._requested: set[ShapeKey] = set()
        self._keys: dict[str, tuple[Entity, ShapeKey]] = {}
        """The keys of entities by name, which are needed again with each pose."""

    def of(self, entity: Entity) -> ModelShape | None:
        """Return the shape of an entity with its joints as asserted, if it is known."""
        return None if entity.place else self._known.get(self._key_of(entity))

    def queries(self, entities: Iterable[Entity]) -> Iterator[ShapesOf]:
        """Yield the queries for the shapes that were not requested yet, and mark these as requested."""
        keys = [self._key_of(entity) for entity in entities if not entity.place]
        wanted = [key for key in dict.fromkeys(keys) if key not in self._requested]
        self._requested.update(wanted)
        for start in range(0, len(wanted), _AT_ONCE):
            yield ShapesOf(keys=tuple(wanted[start : start + _AT_ONCE]))

    def take(self, query: ShapesOf, reply: FoundShapes) -> None:
        """Store the shapes of a reply. Raises InternalError for one that cannot be decoded."""
        try:
            found = msgspec.json.decode(reply.content, type=WorldShapes)
            for key in query.keys:
                (number,) = found.bodies.get(key.name, ("",))
                self._known[key] = found.shapes[number] if number else None
        except (msgspec.DecodeError, KeyError, ValueError) as error:
            raise errors.InternalError(f"the shapes from kb_node are invalid: {error}") from None

    def _key_of(self, entity: Entity) -> ShapeKey:
        known = self._keys.get(entity.name)
        if known is None or known[0] is not entity:
            known = self._keys[entity.name] = (entity, ShapeKey.of(entity))
        return known[1]

    def reset(self) -> None:
        """Mark all shapes as not requested; those that are known are used until they arrive."""
        self._requested.clear()

    def forget(self, keys: Sequence[ShapeKey]) -> None:
        """Mark shapes whose request failed as not requested."""
        self._requested.difference_update(keys)


class ShapeFeed:
    """Requests shapes without waiting for them. It is owned by the thread of the node."""

    def __init__(self, node: Node, on_arrived: Callable[[], None]) -> None:
        """`on_arrived()` is called after shapes have arrived, and when it is time to request them again."""
        self._node, self._on_arrived = node, on_arrived
        self._table = ShapeTable()

    def of(self, entity: Entity) -> ModelShape | None:
        """Return the shape of an entity, if it has arrived."""
        return self._table.of(entity)

    def reset(self) -> None:
        """Request all shapes again, because they may have changed without a commit."""
        self._table.reset()

    def fetch(self, entities: Iterable[Entity]) -> None:
        """Request the shapes of entities that were not requested yet."""
        for query in self._table.queries(entities):
            asked = self._node.ask_later(keys.BRIDGE, query)
            asked.add_done_callback(partial(self._on_reply, query))

    def _on_reply(self, query: ShapesOf, done: Future[FoundShapes]) -> None:
        if done.exception() is None:
            self._table.take(query, done.result())
            self._on_arrived()
        else:
            self._node.later(_RETRY_S, partial(self._retry, query))

    def _retry(self, query: ShapesOf) -> None:
        self._table.forget(query.keys)
        self._on_arrived()
