"""Creation of a data folder from a backup, which is checked before existing data changes."""

from __future__ import annotations

import sqlite3
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path

import msgspec

from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.storage import body_shapes, seed
from semmap.nodes.kb_node.storage.encoding import body_encoding
from semmap.nodes.kb_node.storage.journal import FILENAME, Journal
from semmap.nodes.kb_node.storage.journal.beginning import TABLE
from semmap.nodes.kb_node.storage.journal.layout import COMPACTED, FORMAT, SCHEMA
from semmap.ontology.model_shapes import WorldShapes, exchange_world, world
from semmap.schemas import backups, errors
from semmap.schemas.backups import Opening, Piece, Restored
from semmap.schemas.commits import Commit


def restore(
    file: Path, data: Path, *, replace: bool = False, tell: Callable[[str], None] = lambda text: None
) -> Restored:
    """Restore the backup `file` to the folder `data`.

    With `replace`, an existing map is moved to `data/kept/<time>/`. `tell` is called with the progress of
    long work. Raises BadFile for an invalid backup. Raises Refused if there is a map, it is in use, or the
    disk rejects it. Then nothing has changed.
    """
    path = data / FILENAME
    if path.exists() and not replace:
        raise errors.Refused(
            f"there is a map in {data}; restore to another folder, or add --replace, which moves this map to"
            f" {data / seed.KEPT}"
        )
    new = path.with_name(f"new-{FILENAME}")
    try:
        data.mkdir(parents=True, exist_ok=True)
        seed.require_unused(path)
        opening, size = _write_journal(file, new, tell)
        kept = seed.install_journal(new, path)
    except OSError as error:
        raise errors.Refused(f"the map cannot be restored to {data}: {error.strerror}") from None
    finally:
        seed.delete_journal(new)
    return Restored(opening=opening, entities=size, kept=None if kept is None else str(kept))


def _write_journal(file: Path, new: Path, tell: Callable[[str], None]) -> tuple[Opening, int]:
    """Write the journal of a backup, and return its opening and the number of entities."""
    seed.delete_journal(new)
    rows = backups.read(file)
    opening = next(rows)
    if not isinstance(opening, Opening):
        raise errors.BadFile(f"{file}: the header of the backup is missing")
    try:
        with closing(sqlite3.connect(new)) as db:
            db.executescript(SCHEMA)
            form = COMPACTED if opening.first > 1 else FORMAT
            with db:
                db.execute("INSERT INTO meta VALUES ('format', ?)", (form,))
                shapes = _fill(db, rows, tell)
    except sqlite3.Error as error:
        raise errors.Refused(f"the map could not be written to {new}: {error}") from None
    if shapes:
        body_shapes.beside(new).write_bytes(shapes)
    with closing(Journal(new)) as journal, _using(shapes, file):
        try:
            semantic_map = SemanticMap(journal)
        except errors.Refused:
            raise backups.damaged(file) from None
        semantic_map.checkpoint()
        return opening, len(semantic_map)


@contextmanager
def _using(shapes: bytes, file: Path) -> Iterator[None]:
    """Use the shapes of a backup in the block, because the checkpoint has the relations that follow."""
    before = world()
    try:
        exchange_world(msgspec.json.decode(shapes, type=WorldShapes) if shapes else WorldShapes())
    except msgspec.DecodeError:
        raise backups.damaged(file) from None
    try:
        yield
    finally:
        exchange_world(before)


def _fill(db: sqlite3.Connection, rows: Iterator[Opening | Piece], tell: Callable[[str], None]) -> bytes:
    """Insert the rows, and return the content of the file with shapes."""
    shapes = b""
    head: Piece | None = None
    for row in rows:
        if not isinstance(row, Piece):
            raise errors.InternalError("a backup has a second opening")
        if row.kind == "commit":
            commit: Commit = body_encoding.decode(row.content, Commit)
            db.executemany("INSERT INTO touches VALUES (?, ?)", [(name, row.seq) for name in commit.names])
            db.execute("INSERT INTO commits VALUES (?, ?, ?, ?)", (row.seq, row.id, row.content, row.digest))
            if row.seq % 20_000 == 0:
                tell(f"{row.seq:,} commits restored")
        elif row.kind == "beginning":
            head = row
        elif row.kind == "snapshot" and head is not None:
            db.execute(TABLE)
            value = (row.seq, head.content, row.content, head.digest)
            db.execute("INSERT INTO beginning VALUES (?, ?, ?, ?)", value)
        elif row.kind == "shapes":
            shapes = row.content
        else:
            table = "tboxes" if row.kind == "tbox" else "checkpoints"
            db.execute(f"INSERT INTO {table} VALUES (?, ?, ?)", (row.seq, row.content, row.digest))
    return shapes
