"""A standing query and its rows."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from semmap.nodes.kb_node.sparql.triples.dataset import Delta
from semmap.schemas import errors
from semmap.schemas.commands import Watch
from semmap.schemas.sparql import Row, RowsChanged

if TYPE_CHECKING:
    from semmap.nodes.kb_node.sparql.queries.footprint import Footprint


@dataclass
class StandingQuery:
    """One standing query. `ends` is the end of its lease [s, monotonic], which begins with its first rows."""

    watch: str
    query: str
    inferred: bool
    lease_s: float
    looks_at: Footprint
    demand: int = 0
    """The number of the measurements that it needs; 0 for none."""
    ends: float = math.inf
    rows: Counter[Row] = field(default_factory=Counter)

    @classmethod
    def of(cls, command: Watch, name: str, demand: int) -> StandingQuery:
        """Return the query of a command, without rows."""
        # imported late, because rdflib's parser would delay the first query
        from semmap.nodes.kb_node.sparql.queries.footprint import footprint

        if command.query is None:
            raise errors.InternalError("a standing query has no text")
        return cls(
            watch=name,
            query=command.query,
            inferred=command.inferred,
            lease_s=command.lease,
            looks_at=footprint(command.query),
            demand=demand if command.inferred else 0,
        )

    def is_touched(self, delta: Delta) -> bool:
        """Return whether a commit may change its rows."""
        return self.looks_at.is_touched(delta.everything if self.inferred else delta.asserted)

    def update_rows(self, rows: Iterable[Row], since: int, seq: int) -> RowsChanged | None:
        """Set its rows after commit `seq` and return the changes, if any."""
        now = Counter(rows)
        appeared, disappeared = now - self.rows, self.rows - now
        self.rows = now
        if not appeared and not disappeared:
            return None
        return RowsChanged(
            watch=self.watch,
            seq=seq,
            since=since,
            appeared=tuple(appeared.elements()),
            disappeared=tuple(disappeared.elements()),
        )
