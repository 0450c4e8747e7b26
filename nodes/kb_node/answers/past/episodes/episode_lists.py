"""Lists of events and intervals: parts in a period, at the same time, and overlaps."""

from __future__ import annotations

from collections.abc import Sequence

from semmap.schemas.episodes import Episode


def clip(episodes: Sequence[Episode], first_ns: int, last_ns: int) -> list[Episode]:
    """Return the episodes that overlap with a period."""
    return [e for e in episodes if e.since_ns <= last_ns and (e.until_ns is None or e.until_ns > first_ns)]


def find_common(found: list[Episode] | None, others: list[Episode]) -> list[Episode]:
    """Return the events that are at the same time as one of the others."""
    if found is None:
        return others
    times = {e.since_ns for e in found}
    return [e for e in others if e.since_ns in times]


def touches(span: Episode, move: Episode) -> bool:
    """Return whether a move began or ended within an interval."""
    return span.since_ns <= move.since_ns and (span.until_ns is None or span.until_ns >= move.since_ns)


def find_overlaps(one: Sequence[Episode], other: Sequence[Episode]) -> list[Episode]:
    """Return the common parts of two lists of intervals."""
    found = []
    for a in one:
        for b in other:
            begin = a if a.since_ns >= b.since_ns else b
            ends = [e for e in (a, b) if e.until_ns is not None]
            end = min(ends, key=lambda e: e.until_ns or 0, default=None)
            if end is not None and (end.until_ns or 0) <= begin.since_ns:
                continue
            found.append(
                Episode(
                    subject=a.subject,
                    what=f"{a.what} {b.what}",
                    since=begin.since,
                    since_ns=begin.since_ns,
                    until=None if end is None else end.until,
                    until_ns=None if end is None else end.until_ns,
                )
            )
    return found
