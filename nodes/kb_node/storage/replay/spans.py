"""A span of a journal's history, as people give it."""

from __future__ import annotations

from typing import NamedTuple

from semmap.nodes.kb_node.storage.history import HistoryReader
from semmap.nodes.kb_node.storage.journal import Journal
from semmap.schemas import errors
from semmap.schemas.moments import When


class Span(NamedTuple):
    """From the map as it was after commit `since` to what it was after commit `until`."""

    since: int
    until: int

    def __len__(self) -> int:
        """How many commits lead from one to the other."""
        return self.until - self.since


def span_of(journal: Journal, since: When | None, until: When | None) -> Span:
    """The span between two commits or times; by default from the first that is known to the last.

    Raises Refused for what was compacted, what has not happened yet, and an empty history; BadRequest where
    the end is before the beginning.
    """
    past = HistoryReader(journal)
    if not journal.last:
        raise errors.Refused(f"{journal.path}: nothing has happened in this map: it has no commits")
    first = max(journal.beginning.seq, 1)
    begin = first if since is None else past.commit_at(since)
    end = journal.last if until is None else past.commit_at(until)
    if end < begin:
        raise errors.BadRequest(f"the end (commit {end}) is before the beginning (commit {begin})")
    return Span(begin, end)
