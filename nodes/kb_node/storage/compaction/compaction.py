"""Compaction: old commits are replaced by a snapshot, with which the history then begins."""

from __future__ import annotations

from contextlib import suppress
from typing import NamedTuple

from msgspec import Struct

from semmap.nodes.kb_node.documents import rdf
from semmap.nodes.kb_node.storage.compaction import leftovers
from semmap.nodes.kb_node.storage.encoding.checkpoint_encoding import Checkpoint
from semmap.nodes.kb_node.storage.history import HistoryReader
from semmap.nodes.kb_node.storage.journal import Journal
from semmap.nodes.kb_node.storage.journal.beginning import Beginning
from semmap.nodes.kb_node.storage.journal.sqlite_file import NotWritten
from semmap.schemas.explanations import Triple


class CompactedRange(NamedTuple):
    """The part of the history that becomes the snapshot."""

    last: int
    """Its last commit. Without old commits it is the one with which the history already begins."""
    commits: int


class _Changes(Struct):
    """The triples of a commit."""

    seq: int
    retracted: tuple[Triple, ...] = ()
    inserted: tuple[Triple, ...] = ()


def choose_range(journal: Journal, *, keep_ns: int, now_ns: int) -> CompactedRange:
    """Return the commits older than `keep_ns`, before the first younger one.

    Stamps in the future, from a wrong clock, are ignored. The last commit is always kept.
    """
    begins, last = journal.beginning.seq, journal.last
    young = journal.stamps.within(now_ns - keep_ns, now_ns)
    until = max(begins, min([last, *young[:1]]) - 1)
    return CompactedRange(until, until - begins)


def compact(journal: Journal, past: HistoryReader, until: int) -> None:
    """Start the history with the map after commit `until`. Raises NotWritten, Refused.

    The change is atomic, and commits may be made meanwhile. An interruption while old commits are deleted
    only costs disk space.
    """
    map_id, begun_ns = journal.origin()
    abox = collect_asserted(journal, until).difference(rdf.parse(journal.tbox(until), "the TBox"))
    snapshot = Checkpoint(seq=until, triples=tuple(abox), entities=past.entities(until))
    journal.start_from(
        Beginning(
            seq=until,
            stamp_ns=journal.stamps.of(until),
            chain=journal.digest(until),
            map_id=map_id,
            begun_ns=begun_ns,
        ),
        snapshot,
    )
    with suppress(NotWritten):
        leftovers.delete(journal)


def collect_asserted(journal: Journal, seq: int) -> set[Triple]:
    """Return all asserted triples after a commit, with the TBox."""
    start = journal.snapshot()
    asserted = {
        *start.all_triples(),
        *rdf.parse(journal.tbox(start.seq), f"the first TBox in {journal.path}"),
    }
    terms: dict[str, str] = {}
    intern = terms.setdefault
    for changes in journal.decode_partially(_Changes):
        if changes.seq > seq:
            break
        asserted.difference_update(changes.retracted)
        asserted.update((intern(s, s), intern(p, p), intern(o, o)) for s, p, o in changes.inserted)
    return asserted
