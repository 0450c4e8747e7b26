"""Checkpoints in a journal: the whole map after a commit, from which a start continues."""

from __future__ import annotations

import logging
from collections.abc import Callable

from semmap.nodes.kb_node.storage.encoding import checkpoint_encoding
from semmap.nodes.kb_node.storage.encoding.checkpoint_encoding import Checkpoint
from semmap.nodes.kb_node.storage.journal import index_check
from semmap.nodes.kb_node.storage.journal.digests import chain_digest, is_intact
from semmap.nodes.kb_node.storage.journal.sqlite_file import JournalFile

log = logging.getLogger(__name__)


def save(file: JournalFile, checkpoint: Checkpoint, *, begins: int, progress: Callable[[], None]) -> None:
    """Write `checkpoint` to a journal that begins after commit `begins`, and keep one older checkpoint.

    Raises NotWritten, with nothing changed, if the disk rejects it.
    """
    body = checkpoint_encoding.encode(checkpoint, progress)
    row = (checkpoint.seq, body, chain_digest(b"", body))
    with file.writing(f"the checkpoint after commit {checkpoint.seq}") as db:
        db.execute("INSERT OR REPLACE INTO checkpoints VALUES (?, ?, ?)", row)
        db.execute(
            "DELETE FROM checkpoints WHERE seq NOT IN (SELECT seq FROM checkpoints ORDER BY seq DESC LIMIT 2)"
        )
        index_check.write(db, begins, checkpoint.seq)


def load_newest(file: JournalFile, *, begins: int, progress: Callable[[], None]) -> Checkpoint | None:
    """Return the newest intact checkpoint of a journal that begins after commit `begins`, or None."""
    with file.reading() as db:
        for seq, body, digest in db.execute("SELECT * FROM checkpoints ORDER BY seq DESC"):
            if is_intact(b"", body, digest):
                found = checkpoint_encoding.decode(body, progress)
                if found.seq == seq >= begins:
                    return found
            log.warning("%s: the checkpoint after commit %d is damaged and not used", file.path, seq)
    return None
