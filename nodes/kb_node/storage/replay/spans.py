"""A span of a journal's history."""

from __future__ import annotations

from typing import NamedTuple

from semmap.nodes.kb_node.storage.history import HistoryReader
from semmap.nodes.kb_node.storage.journal import Journal
from semmap.schemas import errors
from semmap.schemas.moments import When


class Span(NamedTuple):
    """The commits from the map after commit `since` to the map after commit `until`."""

    since: int
    until: int

    def __len__(self) -> int:
        """Return the number of commits in the span."""
        return self.until - self.since


def span_of(journal: Journal, since: When | None, until: When | None) -> Span:
    """Return the span between two commits or times, by default the whole stored history.

    Raises Refused for compacted or future commits and for an empty history, BadRequest if the end is before
    the start.
    """
    past = HistoryReader(journal)
    if not journal.last:
        raise errors.Refused(f"{journal.path}: the map has no commits")
    first = max(journal.beginning.seq, 1)
    begin = first if since is None else past.commit_at(since)
    end = journal.last if until is None else past.commit_at(until)
    if end < begin:
        raise errors.BadRequest(f"the end (commit {end}) is before the beginning (commit {begin})")
    return Span(begin, end)
