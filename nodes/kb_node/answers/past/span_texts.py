"""Intervals in which something held, in words with commits and ages."""

from __future__ import annotations

from collections.abc import Sequence

from semmap.nodes.kb_node.storage.journal import Journal
from semmap.schemas import wording
from semmap.schemas.map_history import Spell

_LONGEST = 10
"""Intervals that are listed one by one in the text."""


def stamp_of(journal: Journal, seq: int) -> int:
    """Return the time of a commit. Compacted commits have the time of the first snapshot."""
    begins = journal.beginning
    return begins.stamp_ns if begins.seq and seq <= begins.seq else journal.stamps.of(max(seq, 1))


def describe_spells(name: str, where: str, intervals: Sequence[Spell], now_ns: int) -> str:
    """Return `cup1 has been on table1 since commit 4 (for 2 min); before that from commit 1 until ...`."""
    if not intervals:
        return f"{name} was never {where}"
    spans = [_span(spell, now_ns) for spell in intervals if spell.until is not None]
    shown = spans if len(spans) <= _LONGEST else [*spans[:3], f"{len(spans) - 6} more times", *spans[-3:]]
    total_s = sum(lasted_s(spell, now_ns) for spell in intervals)
    often = f"; {len(intervals)} times, {wording.duration(total_s)} in all" if len(intervals) > 1 else ""
    if (last := intervals[-1]).until is None:
        earlier = f"; before that {', '.join(shown)}" if shown else ""
        return f"{name} has been {where} since {_beginning(last)} ({_length(last, now_ns)}){earlier}{often}"
    return f"{name} is no longer {where}; it was {', '.join(shown)}{often}"


def _span(spell: Spell, now_ns: int) -> str:
    """Return `from commit 1 until commit 3 (for 20 s, until 5 min ago)`."""
    ago = wording.duration((now_ns - (spell.until_ns or now_ns)) / 1e9)
    return f"from {_beginning(spell)} until commit {spell.until} ({_length(spell, now_ns)}, until {ago} ago)"


def _beginning(spell: Spell) -> str:
    return f"commit {spell.since}" if spell.since else "before the history begins"


def _length(spell: Spell, now_ns: int) -> str:
    at_least = "" if spell.since else "at least "
    return f"for {at_least}{wording.duration(lasted_s(spell, now_ns))}"


def lasted_s(spell: Spell, now_ns: int) -> float:
    """Return the duration of an interval [s]."""
    return ((spell.until_ns or now_ns) - spell.since_ns) / 1e9
