"""The triples of a large map on disk: made once, kept between starts, and clone_store for whoever reads them.

A store is a folder of Oxigraph's (RocksDB). Nobody works in a store itself: its large files never change, so
that a clone shares them by hard links and costs milliseconds, whatever the size of the map.
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
"""Beside the journal."""
_CLONE: Final = "clone-"
_UNFINISHED: Final = "filling-"
_UNCHANGING: Final = ".sst"


class DiskStores:
    """The stores of one journal. One is named by a commit: its number and the digest of all up to it."""

    def __init__(self, data: Path) -> None:
        """Those beside the journal in `data`; what a process before this one left unfinished goes."""
        self.folder = data / FOLDER
        self._numbers = count(1)
        for path in self._paths():
            if path.name.startswith((_CLONE, _UNFINISHED)):
                shutil.rmtree(path, ignore_errors=True)

    def begin(self) -> Path:
        """Where the next store is to be made. Raises OSError."""
        self.folder.mkdir(parents=True, exist_ok=True)
        return self.folder / f"{_UNFINISHED}{next(self._numbers)}"

    def finish(self, made: Path, seq: int, digest: bytes) -> Path:
        """What was made is the store of a commit from now on; the one before goes. Raises OSError."""
        for _, _, old in list(self.found()):
            shutil.rmtree(old, ignore_errors=True)
        return made.rename(self.folder / f"{seq}-{digest.hex()}")

    def found(self) -> Iterator[tuple[int, str, Path]]:
        """Number and digest of the commit, and the path, of each store."""
        for path in self._paths():
            number, _, digest = path.name.partition("-")
            if number.isdigit():
                yield int(number), digest, path

    def _paths(self) -> list[Path]:
        return sorted(self.folder.iterdir()) if self.folder.is_dir() else []


def forget(data: Path) -> None:
    """Another journal takes the place of the one that the stores belong to."""
    shutil.rmtree(data / FOLDER, ignore_errors=True)


def clone_store(path: Path) -> ox.Store:
    """A store of this process's own, which begins as the one at `path` is. Raises OSError."""
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
    """Where a process has its clone."""
    return path.parent / f"{_CLONE}{pid}"


def remove_clone(path: Path, pid: int) -> None:
    """That of a process which is gone."""
    with suppress(OSError):
        shutil.rmtree(clone_path(path, pid))
