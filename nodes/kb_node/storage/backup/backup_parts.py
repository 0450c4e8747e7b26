"""The content of a backup, read from a journal in parts. The client requests one part after another.

Nothing is stored between two parts. Written commits never change, so all parts together are the journal at
the time of the first request, whatever has been committed since. The last row is the file with the shapes of
the bodies of world files.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final, NamedTuple

from semmap.nodes.kb_node.storage import body_shapes
from semmap.nodes.kb_node.storage.journal import Journal, beginning
from semmap.nodes.kb_node.storage.journal.rows import Row
from semmap.schemas import errors
from semmap.schemas.backups import MAGIC, BackupPart, End, Kind, Opening, Piece, framed

PART_BYTES: Final = 4 << 20
_SHAPES: Final = "shapes"
_STORED: Final[dict[Kind, str]] = {
    "tbox": "SELECT seq, '', value, digest FROM tboxes WHERE seq > ? AND seq <= ? ORDER BY seq LIMIT 1",
    "beginning": "SELECT seq, '', head, digest FROM beginning WHERE seq > ? AND seq <= ?",
    "snapshot": "SELECT seq, '', body, digest FROM beginning WHERE seq > ? AND seq <= ?",
    "commit": "SELECT * FROM commits WHERE seq > ? AND seq <= ? ORDER BY seq LIMIT 1",
    "checkpoint": "SELECT seq, '', body, digest FROM checkpoints WHERE seq > ? AND seq <= ?"
    " ORDER BY seq DESC LIMIT 1",
}
_KINDS: Final[tuple[Kind, ...]] = (*_STORED, _SHAPES)


class Position(NamedTuple):
    """The start of a part: an offset within a row, in a journal with this start and end."""

    begins: int
    last: int
    kind: int
    seq: int
    offset: int

    @classmethod
    def read(cls, text: str) -> Position:
        """Parse the text from `format`. Raises BadRequest."""
        try:
            position = cls._make(map(int, text.split(".")))
        except (ValueError, TypeError):
            position = None
        if position is None or not 0 <= position.kind < len(_KINDS):
            raise errors.BadRequest(
                f"invalid position of a backup part: '{text}'; leave it out to start a backup"
            )
        return position

    def format(self) -> str:
        """Return it as text."""
        return ".".join(map(str, self))


def read_part(journal: Journal, at: str, *, size: int = PART_BYTES) -> BackupPart:
    """Return the first part of a backup or the one `at` the position that the previous part named.

    Raises Refused if the history was compacted meanwhile, BadRequest.
    """
    if at:
        position, content = Position.read(at), list[bytes]()
    else:
        opening = _make_opening(journal)  # commits continue, so the last one is fixed here
        position = Position(journal.beginning.seq, opening.last, 0, -1, 0)
        content = [MAGIC, framed(opening)]
    if position.begins != journal.beginning.seq:
        raise errors.Refused("the history was compacted during the backup; start the backup again")
    filled = 0
    for following, piece in _iterate_pieces(journal, position, size):
        content.append(framed(piece))
        filled += len(piece.content)
        if filled >= size:
            return BackupPart(content=b"".join(content), next=following.format())
    content.append(framed(End(last=position.last)))
    return BackupPart(content=b"".join(content))


def _make_opening(journal: Journal) -> Opening:
    last = journal.last
    map_id, begun_ns = journal.origin()
    return Opening(
        map_id=map_id,
        begun_ns=begun_ns,
        first=journal.first,
        last=last,
        digest=journal.digest(last).hex(),
        stamp_ns=journal.stamps.of(last) if last >= journal.first else journal.beginning.stamp_ns,
        chain=journal.beginning.chain,
    )


def _iterate_pieces(journal: Journal, position: Position, size: int) -> Iterator[tuple[Position, Piece]]:
    """Yield the pieces from a position on, each with the position after it."""
    for number in range(position.kind, len(_KINDS)):
        kind = _KINDS[number]
        begun = number == position.kind
        seq = position.seq if begun else -1
        rows = _iterate_rows(journal, kind, after=seq - bool(begun and position.offset), until=position.last)
        for row in rows:
            start = position.offset if begun and row.seq == position.seq else 0
            while True:
                content = row.body[start : start + size]
                start += size
                more = start < len(row.body)
                following = position._replace(kind=number, seq=row.seq, offset=start if more else 0)
                piece = Piece(
                    kind=kind, seq=row.seq, id=row.id, digest=row.digest, content=content, more=more
                )
                yield following, piece
                if not more:
                    break


def _iterate_rows(journal: Journal, kind: Kind, *, after: int, until: int) -> Iterator[Row]:
    """Yield the rows of one kind with numbers after `after` and up to `until`, in order."""
    after = max(after, journal.beginning.seq) if kind == "commit" else after
    if kind == _SHAPES:
        written_ns, content = body_shapes.read(body_shapes.beside(journal.path))
        if content and written_ns > after:
            yield Row(written_ns, "", content, beginning.digest(content))
        return
    while True:
        with journal.file.reading() as db:
            if kind in ("beginning", "snapshot") and not beginning.exists(db):
                return
            found = db.execute(_STORED[kind], (after, until)).fetchone()
        if found is None:
            return
        row = Row._make(found)
        yield row._replace(digest=beginning.digest(row.body)) if kind == "snapshot" else row
        after = row.seq
