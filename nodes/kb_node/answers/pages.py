"""Snapshots in pages, because a million entities are too many for one message."""

from __future__ import annotations

import math
import time
from bisect import bisect_right
from itertools import islice

from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.schemas.bridge import SnapshotQuery
from semmap.schemas.commits import Snapshot

_PATIENCE_S = 0.5
"""Time in which clients are expected to request the first page after a start, and each further page."""


class Pages:
    """Pages of a map that may change in between. Each page names the commit that it is as of."""

    def __init__(self, semantic_map: SemanticMap) -> None:
        self._map = semantic_map
        self._names: list[str] = []
        self._asked_s = time.monotonic()
        """Time of the last request that others follow, or of the start."""

    @property
    def is_request_expected(self) -> bool:
        """Return whether a request for a page is likely soon. Other work should not delay it."""
        return time.monotonic() - self._asked_s < _PATIENCE_S

    def snapshot(self, query: SnapshotQuery) -> Snapshot:
        """Return all entities, or the requested page.

        The names are sorted once, for the first page. An entity that is added later is in none of the other
        pages; the commit that added it is later than the first page.
        """
        if query.limit is None:
            return self._map.snapshot()
        if not query.after or not self._names:
            self._names = sorted(self._map.names)
        start = bisect_right(self._names, query.after) if query.after else 0
        there = filter(None, map(self._map.find, islice(self._names, start, None)))
        found = tuple(islice(there, query.limit))
        more = next(there, None) is not None
        self._asked_s = time.monotonic()
        if not more:
            self._names, self._asked_s = [], -math.inf
        return Snapshot(seq=self._map.seq, entities=found, more=more, digest=self._map.digest)
