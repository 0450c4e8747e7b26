"""Live poses of tracked entities for spatial queries. Facts depend on committed poses only."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from msgspec import structs

from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.schemas.entities import Entity, Live, distance_m
from semmap.schemas.live import LivePoses

_TIMEOUT_S = 3.0
"""Live poses are published at least once a second. After this time without one they are outdated."""
_SLIGHT_M = 0.001
_SLIGHT_TURN = 1e-3


class LiveEntities:
    """The newest live poses. Owned by the node's thread."""

    def __init__(self, semantic_map: SemanticMap, clock: Callable[[], float] = time.monotonic) -> None:
        """Begin without live poses."""
        self._map = semantic_map
        self._clock = clock
        self._live: dict[str, Live] = {}
        self._received_s = -_TIMEOUT_S

    def update(self, message: LivePoses) -> None:
        """Store the live poses of all tracked entities, as published by the coordinator."""
        self._live, self._received_s = message.entities, self._clock()

    def find(self, entity: Entity) -> Live | None:
        """Return the live pose of a tracked or attached entity, unless it is outdated."""
        if not (entity.tracked or entity.grip_provenance) or self._clock() - self._received_s > _TIMEOUT_S:
            return None
        return self._live.get(entity.name)

    @contextmanager
    def applied(self) -> Iterator[None]:
        """Within this context, tracked and attached entities have their live poses."""
        elsewhere = list(self._moved_entities())
        if not elsewhere:
            yield
            return
        with self._map.places.space().with_changes(elsewhere):
            yield

    def _moved_entities(self) -> Iterator[Entity]:
        for entity in filter(None, map(self._map.find, self._live)):
            live = self.find(entity)
            if live is not None and _is_different(entity, live):
                yield structs.replace(entity, pose=live.pose)


def _is_different(entity: Entity, live: Live) -> bool:
    if entity.pose is None or distance_m(entity.pose, live.pose) > _SLIGHT_M:
        return True
    pairs = zip(entity.pose.orientation_wxyz, live.pose.orientation_wxyz, strict=True)
    return any(abs(a - b) > _SLIGHT_TURN for a, b in pairs)
