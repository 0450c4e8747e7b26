"""Compacting: what is older than so long becomes a snapshot, which the history begins with from then on."""

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
    """How much of the history becomes the snapshot."""

    last: int
    """The last commit of it; the one that the history begins with already where nothing is old enough."""
    commits: int


class _Changes(Struct):
    """The triples of a commit."""

    seq: int
    retracted: tuple[Triple, ...] = ()
    inserted: tuple[Triple, ...] = ()


def share(journal: Journal, *, keep_ns: int, now_ns: int) -> CompactedRange:
    """What is older than `keep_ns`: the commits before the first that is not.

    Stamps of the future, by a clock that went wrong, say nothing. The last commit always stays.
    """
    begins, last = journal.beginning.seq, journal.last
    young = journal.stamps.within(now_ns - keep_ns, now_ns)
    until = max(begins, min([last, *young[:1]]) - 1)
    return CompactedRange(until, until - begins)


def compact(journal: Journal, past: HistoryReader, until: int) -> None:
    """Let the history begin with the map as it was after commit `until`. Raises NotWritten, Refused.

    Either all of it is done or nothing; commits may be made meanwhile. An end in the middle of the cleaning
    up costs nothing but room.
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
    """All that was asserted after a commit, the TBox with it: what commits brought and did not take away."""
    start = journal.snapshot()
    asserted = {*start.said(), *rdf.parse(journal.tbox(start.seq), f"the first TBox in {journal.path}")}
    terms: dict[str, str] = {}
    share = terms.setdefault
    for changes in journal.decode_partially(_Changes):
        if changes.seq > seq:
            break
        asserted.difference_update(changes.retracted)
        asserted.update((share(s, s), share(p, p), share(o, o)) for s, p, o in changes.inserted)
    return asserted
