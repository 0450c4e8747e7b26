"""Stored commits, read in pages and verified by their digests."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Final, NamedTuple

from semmap.nodes.kb_node.storage.journal.digests import is_intact
from semmap.nodes.kb_node.storage.journal.sqlite_file import JournalFile, repair_hint
from semmap.schemas import errors

PAGE: Final = 256


class Damaged(errors.Refused):
    """A commit is not as it was written. `last_good` is the number of the previous one."""

    def __init__(self, path: Path, seq: int) -> None:
        super().__init__(
            f"{path}: commit {seq} is damaged; the last good one is {seq - 1}; {repair_hint(path)}"
        )
        self.last_good = seq - 1


class Row(NamedTuple):
    """A commit as stored in the file."""

    seq: int
    id: str
    body: bytes
    digest: bytes


def read_intact_rows(file: JournalFile, *, after: int, before: bytes, size: int = PAGE) -> Iterator[Row]:
    """Yield the commits after `after`, whose digest is `before`. Raises Damaged at the first damaged one."""
    seq = after
    while rows := read_page(file, seq, size):
        for row in rows:
            seq += 1
            if row.seq != seq or not is_intact(before, row.body, row.digest):
                raise Damaged(file.path, seq)
            before = row.digest
            yield row


def read_page(file: JournalFile, after: int, size: int = PAGE) -> list[Row]:
    """Return the next rows. If they cannot be read together, read them one by one to find the damaged one."""
    query = "SELECT seq, command_id, body, digest FROM commits WHERE seq > ? ORDER BY seq LIMIT ?"
    try:
        with file.reading() as db:
            return list(map(Row._make, db.execute(query, (after, size))))
    except errors.Refused:
        if size == 1:
            raise Damaged(file.path, after + 1) from None
        return read_page(file, after, 1)


def read_newest_first(file: JournalFile, *, until: int, size: int = PAGE) -> Iterator[tuple[int, bytes]]:
    """Yield the numbers and bodies of the commits up to `until`, newest first. They are not verified."""
    query = "SELECT seq, body FROM commits WHERE seq <= ? ORDER BY seq DESC LIMIT ?"
    while True:
        with file.reading() as db:
            page = db.execute(query, (until, size)).fetchall()
        if not page:
            return
        yield from page
        until = page[-1][0] - 1
