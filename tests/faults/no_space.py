"""Compaction and backup of a map on a disk of a few MB that becomes full: `python -m tests.faults.no_space`.

It mounts file systems, so it runs in a namespace of its own, such as that of `unshare -rm`.
"""

from __future__ import annotations

import os
import random
import shutil
import subprocess
import tempfile
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any, Final

from semmap.nodes.extern import backup
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.storage.backup.backup_parts import read_part
from semmap.nodes.kb_node.storage.compaction import compaction
from semmap.nodes.kb_node.storage.history import HistoryReader
from semmap.nodes.kb_node.storage.journal import FILENAME, Journal
from semmap.schemas import backups, errors
from tests.kb_node import home

_COMMITS: Final = 60
_UNTIL: Final = 50
_DISK_MB: Final = 40
_ROOMS_KB: Final = (0, 64, 1024, 2048, 3072, 4096, 5120, 6144, 8192, 12288, 20480)
"""Free space when a map of about 8 MB is compacted: from none to more than it needs."""
_BACKUP_KB: Final = (0, 64, 1024, 4096, 16384)


def main() -> None:
    """Compact and back up with more and more room. Raises AssertionError if something is lost."""
    with tempfile.TemporaryDirectory(prefix="semmap-room-") as name:
        folder = Path(name)
        (folder / "map").mkdir()
        _write_map(folder / "map")
        full = [_compact(folder, room_kb) for room_kb in _ROOMS_KB]
        unsaved = [_back_up(folder, room_kb) for room_kb in _BACKUP_KB]
    assert {*full} == {*unsaved} == {True, False}, (full, unsaved)


def _write_map(folder: Path) -> None:
    """Create a map with a long history of incompressible names."""
    chance, made = random.Random(1), home.new_map(folder)
    for n in range(_COMMITS):
        alt = tuple(chance.randbytes(900).hex() for _ in range(40))
        made.commit(home.transaction(n, home.chair(f"chair{n}", alternatives=alt)))
    home.close(made)


@contextmanager
def _disk(folder: Path, content: Path | None, room_kb: int) -> Iterator[Path]:
    """Provide a file system with a copy of `content` and this much room."""
    disk = folder / "disk"
    disk.mkdir(exist_ok=True)
    subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={_DISK_MB}m", "none", disk], check=True)
    try:
        if content is not None:
            shutil.copytree(content, disk, dirs_exist_ok=True)
        _fill(disk, room_kb << 10)
        yield disk
    finally:
        subprocess.run(["umount", disk], check=True)


def _fill(disk: Path, room: int) -> None:
    filler = disk / "filler"
    filler.unlink(missing_ok=True)
    found = os.statvfs(disk)
    size = found.f_bavail * found.f_bsize - room
    with filler.open("wb") as file:
        os.posix_fallocate(file.fileno(), 0, size)


def _state(data: Path) -> tuple[Any, list[int]]:
    """Return the facts and entities of a map, and its commits."""
    with closing(Journal(data / FILENAME)) as journal:
        read = SemanticMap(journal)
        return (set(read.abox()), {e.name for e in read.snapshot().entities}), [
            c.seq for c in journal.commits()
        ]


def _compact(folder: Path, room_kb: int) -> bool:
    """Compact a map with so much room, and return whether the room was too little."""
    expected, commits = _state(folder / "map")
    with _disk(folder, folder / "map", room_kb) as disk:
        refused = ""
        try:
            with closing(Journal(disk / FILENAME)) as journal:
                compaction.compact(journal, HistoryReader(journal), _UNTIL)
        except errors.Refused as error:
            refused = error.text
            assert refused.endswith("free some space, then repeat it"), refused
        (disk / "filler").unlink()
        found, kept = _state(disk)
        assert found == expected, (room_kb, refused)
        assert kept == (commits if refused else commits[_UNTIL:]), (room_kb, refused, kept)
    return bool(refused)


def _back_up(folder: Path, room_kb: int) -> bool:
    """Replace a backup with so much room, and return whether the room was too little."""
    with closing(Journal(folder / "map" / FILENAME)) as journal, _disk(folder, None, 0) as disk:
        file, refused = disk / "map.backup", ""
        (disk / "filler").unlink()
        before = backup.write(lambda asked: read_part(journal, asked.at), file)
        _fill(disk, room_kb << 10)
        try:
            backup.write(lambda asked: read_part(journal, asked.at), file, overwrite=True)
        except errors.BadFile as error:
            refused = error.text
        assert backups.verify(file) == before
        assert {path.name for path in disk.iterdir()} == {"map.backup", "filler"}
    return bool(refused)


if __name__ == "__main__":
    main()
