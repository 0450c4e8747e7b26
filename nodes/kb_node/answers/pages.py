"""The map, page by page: a snapshot of a million entities is too much for one message, and one answer."""

from __future__ import annotations

import math
import time
from bisect import bisect_right
from itertools import islice

from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.schemas.bridge import SnapshotQuery
from semmap.schemas.commits import Snapshot

_PATIENCE_S = 0.5
"""For those who follow the map to ask for its first page after a start, and for the next one."""


class Pages:
    """Pages of a map that may change between two of them: each is as of the commit that it names."""

    def __init__(self, semantic_map: SemanticMap) -> None:
        self._map = semantic_map
        self._names: list[str] = []
        self._asked_s = time.monotonic()
        """When a page was asked for that others follow, or when it was time to begin."""

    @property
    def is_request_expected(self) -> bool:
        """Whether somebody is likely to ask for a page in a moment: then nothing else should delay it."""
        return time.monotonic() - self._asked_s < _PATIENCE_S

    def snapshot(self, query: SnapshotQuery) -> Snapshot:
        """All entities, or the page that is asked for.

        The names are sorted once, for the first page. An entity that came since is in none of the others: the
        commit that brought it is later than the first page.
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
