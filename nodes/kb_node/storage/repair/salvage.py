"""Extraction of intact commits from a damaged journal. Each is verified by its own digest."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress

from semmap.nodes.kb_node.documents import rdf
from semmap.nodes.kb_node.storage.encoding import body_encoding
from semmap.nodes.kb_node.storage.encoding.checkpoint_encoding import Checkpoint
from semmap.nodes.kb_node.storage.journal import Journal
from semmap.nodes.kb_node.storage.journal.digests import chain_digest
from semmap.nodes.kb_node.storage.journal.rows import Row
from semmap.schemas import errors
from semmap.schemas.commits import Commit
from semmap.schemas.explanations import Triple


def read_commits(journal: Journal) -> Iterator[tuple[int, Commit | None, bytes | None]]:
    """Yield the number of each commit, the commit, and its new TBox if any. None for a damaged one.

    A commit whose TBox is damaged counts as damaged, too.
    """
    before, row = journal.digest(journal.beginning.seq), read_row(journal, journal.first)
    for seq in range(journal.first, _likely_last(journal) + 1):
        following = read_row(journal, seq + 1)
        commit = None if row is None else _verify_commit(seq, row, before, following)
        tbox = None
        if commit is not None and commit.tbox:
            tbox = read_tbox(journal, seq)
            commit = commit if tbox is not None else None
        yield seq, commit, tbox
        before, row = b"" if row is None else row.digest, following


def read_row(journal: Journal, seq: int) -> Row | None:
    """Return a stored commit, intact or not, or None if it cannot be read."""
    query = "SELECT seq, command_id, body, digest FROM commits WHERE seq = ?"
    try:
        with journal.file.reading() as db:
            found = db.execute(query, (seq,)).fetchone()
    except errors.Refused:
        return None
    is_one = found is not None and isinstance(found[2], bytes) and isinstance(found[3], bytes)
    return Row._make(found) if is_one else None


def _likely_last(journal: Journal) -> int:
    """Return the greatest commit number found anywhere in the file, damaged or not."""
    found = [journal.beginning.seq]
    for table in ("commits", "touches", "checkpoints", "tboxes"):
        with suppress(errors.Refused), journal.file.reading() as db:
            (seq,) = db.execute(f"SELECT max(seq) FROM {table}").fetchone()
            found.append(seq if isinstance(seq, int) else 0)
    while read_row(journal, max(found) + 1) is not None:
        found.append(max(found) + 1)
    return max(found)


def read_tbox(journal: Journal, seq: int) -> bytes | None:
    """Return the TBox that commit `seq` introduced, or None if there is none or it is damaged."""
    with suppress(errors.Refused):
        if seq in journal.tbox_changes(after=seq - 1):
            return journal.tbox(seq)
    return None


def compute_abox_after(journal: Journal, seq: int, checkpoint: Checkpoint) -> frozenset[Triple] | None:
    """Return the ABox after commit `seq`, computed back from a later checkpoint.

    None if a commit between is damaged.
    """
    try:
        triples = {*checkpoint.all_triples(), *_tbox(journal, checkpoint.seq)}
        for number in range(checkpoint.seq, seq, -1):
            row = read_row(journal, number)
            commit = None if row is None else _verify_commit(number, row, b"", read_row(journal, number + 1))
            if commit is None:
                return None
            triples.difference_update(commit.inserted)
            triples.update(commit.retracted)
        return frozenset(triples.difference(_tbox(journal, seq)))
    except errors.Refused:
        return None


def _tbox(journal: Journal, seq: int) -> list[Triple]:
    return rdf.parse(journal.tbox(seq), "the TBox")


def _verify_commit(seq: int, row: Row, before: bytes, following: Row | None) -> Commit | None:
    """Return the commit if its digest, or that of the next commit, proves it intact.

    `before` is the digest of the previous commit, if known.
    """
    try:
        commit: Commit = body_encoding.decode(row.body, Commit)
        own = bytes.fromhex(commit.digest)
    except (errors.BadRequest, ValueError):
        return None
    digests = {chain_digest(digest, row.body) for digest in (own, before)}
    if commit.seq != seq or not (row.digest in digests or (following and _follows(following, digests))):
        return None
    return commit


def _follows(row: Row, digests: set[bytes]) -> bool:
    """Return whether a commit was written after one with one of these digests."""
    return any(chain_digest(digest, row.body) == row.digest for digest in digests)
