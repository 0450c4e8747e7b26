"""Stores on disk with the triples of a large map: created once, kept across starts, cloned for readers.

A store is a folder of Oxigraph (RocksDB). A store itself is never opened for work: its large files do not
change, so a clone shares them by hard links and takes milliseconds, whatever the size of the map.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from contextlib import suppress
from itertools import count
from pathlib import Path
from typing import Final

import pyoxigraph as ox

FOLDER: Final = "sparql"
"""Next to the journal."""
_CLONE: Final = "clone-"
_UNFINISHED: Final = "filling-"
_UNCHANGING: Final = ".sst"


class DiskStores:
    """The stores of one journal. Each is named by the number and digest of a commit."""

    def __init__(self, data: Path) -> None:
        """Manage the stores next to the journal in `data`, and delete unfinished ones."""
        self.folder = data / FOLDER
        self._numbers = count(1)
        for path in self._paths():
            if path.name.startswith((_CLONE, _UNFINISHED)):
                shutil.rmtree(path, ignore_errors=True)

    def begin(self) -> Path:
        """Return the path for the next store. Raises OSError."""
        self.folder.mkdir(parents=True, exist_ok=True)
        return self.folder / f"{_UNFINISHED}{next(self._numbers)}"

    def finish(self, made: Path, seq: int, digest: bytes) -> Path:
        """Make a finished store the store of a commit, and delete the previous one. Raises OSError."""
        for _, _, old in list(self.found()):
            shutil.rmtree(old, ignore_errors=True)
        return made.rename(self.folder / f"{seq}-{digest.hex()}")

    def found(self) -> Iterator[tuple[int, str, Path]]:
        """Yield the commit's number and digest, and the path, of each store."""
        for path in self._paths():
            number, _, digest = path.name.partition("-")
            if number.isdigit():
                yield int(number), digest, path

    def _paths(self) -> list[Path]:
        return sorted(self.folder.iterdir()) if self.folder.is_dir() else []


def forget(data: Path) -> None:
    """Delete the stores, because another journal replaces theirs."""
    shutil.rmtree(data / FOLDER, ignore_errors=True)


def clone_store(path: Path) -> ox.Store:
    """Return a private clone of the store at `path`. Raises OSError."""
    clone = clone_path(path, os.getpid())
    shutil.rmtree(clone, ignore_errors=True)
    clone.mkdir()
    for file in path.iterdir():
        if file.suffix == _UNCHANGING:
            os.link(file, clone / file.name)
        elif file.name != "LOCK":
            shutil.copyfile(file, clone / file.name)
    return ox.Store(str(clone))


def clone_path(path: Path, pid: int) -> Path:
    """Return the path of a process's clone."""
    return path.parent / f"{_CLONE}{pid}"


def remove_clone(path: Path, pid: int) -> None:
    """Delete the clone of a process that has exited."""
    with suppress(OSError):
        shutil.rmtree(clone_path(path, pid))
