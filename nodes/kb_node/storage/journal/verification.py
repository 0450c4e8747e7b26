"""Verification of a whole journal."""

from __future__ import annotations

from collections.abc import Callable

from msgspec import MsgspecError

from semmap.nodes.kb_node.storage.journal import beginning, index_check
from semmap.nodes.kb_node.storage.journal.journal import Journal, decode_row
from semmap.nodes.kb_node.storage.journal.rows import Damaged


def verify(journal: Journal, progress: Callable[[], None] = lambda: None) -> None:
    """Read all contents. Raises Damaged at the first damaged commit, Refused for other damage."""
    since, expected = _indexed_until(journal), index_check.Expected()
    for row in journal.rows():
        if row.seq > since:
            commit = decode_row(row)
            if commit.seq != row.seq:
                raise Damaged(journal.path, row.seq)
            expected.add(commit)
        progress()
    with journal.file.reading() as db:
        tboxes = db.execute("SELECT seq FROM tboxes").fetchall()
        if not index_check.is_well_formed(db):
            raise journal.damage_error("its structure is damaged")
        if not expected.matches(db, since):
            raise journal.damage_error("an index is damaged")
        if journal.beginning.seq and beginning.body_of(db, journal.beginning) is None:
            raise journal.damage_error("the snapshot at the start of its history is damaged")
    for (seq,) in tboxes:
        journal.tbox(seq)


def _indexed_until(journal: Journal) -> int:
    """Return the last commit up to which the indexes are as recorded. Raises Refused if they are not."""
    begins = journal.beginning.seq
    with journal.file.reading() as db:
        try:
            record = index_check.read(db)
        except (MsgspecError, TypeError):
            raise journal.damage_error("the record of its indexes is damaged") from None
        if record is None or record.seq < begins:
            return begins
        if not index_check.is_as_recorded(db, begins, record):
            raise journal.damage_error("an index is damaged")
        return record.seq
