"""Deletion of compacted commits in small steps, so that new commits can be made between them."""

from __future__ import annotations

from typing import Final

from semmap.nodes.kb_node.storage.journal import Journal

_ROWS: Final = 2000
"""Rows per step, which take some tens of milliseconds to delete."""
_WHAT: Final = "the deletion of compacted commits"


def exist(journal: Journal) -> bool:
    """Return whether compacted commits are still stored."""
    with journal.file.reading() as db:
        (first,) = db.execute("SELECT min(seq) FROM commits").fetchone()
    return first is not None and first < journal.first


def delete(journal: Journal) -> None:
    """Delete compacted commits. After an interruption the next call continues.

    Raises NotWritten.
    """
    until = journal.beginning.seq
    while _delete_commits(journal, until):
        pass
    _delete_touches(journal, until)
    journal.file.shrink()


def _delete_commits(journal: Journal, until: int) -> int:
    statement = "DELETE FROM commits WHERE seq <= ? AND seq < (SELECT min(seq) FROM commits) + ?"
    with journal.file.writing(_WHAT) as db:
        return db.execute(statement, (until, _ROWS)).rowcount


def _delete_touches(journal: Journal, until: int) -> None:
    name: str | None = ""
    while name is not None:
        with journal.file.writing(_WHAT) as db:
            query = "SELECT name FROM touches WHERE name > ? ORDER BY name LIMIT 1 OFFSET ?"
            upto = (db.execute(query, (name, _ROWS)).fetchone() or (None,))[0]
            after = "name > ?" if name else "name >= ?"
            statement = f"DELETE FROM touches WHERE seq <= ? AND {after} AND (? IS NULL OR name <= ?)"
            db.execute(statement, (until, name, upto, upto))
            name = upto
