"""Restricts the files of a system to its user: folders 0700, files 0600."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path
from typing import Final

UMASK: Final = 0o077
"""The umask of the processes that write them."""
_FILES: Final = ("journal.sqlite*", "*.closure", "settings.json", "supervisord.*")
_FOLDERS: Final = ("in_work", "logs", "recordings", "kept", "sparql")


def make_private(data: Path) -> None:
    """Create the data folder if needed, and remove other users' access to it and semmap's files.

    Raises OSError if it cannot be created. Files of other users are not changed.
    """
    data.mkdir(mode=0o700, parents=True, exist_ok=True)
    for path in (data, *_own(data)):
        with contextlib.suppress(OSError):  # another user's, or gone
            mode = path.lstat().st_mode & 0o7777
            if mode & UMASK and not path.is_symlink():
                path.chmod(mode & ~UMASK)


def _own(data: Path) -> Iterator[Path]:
    """Yield the files of semmap: the folder may contain others."""
    for pattern in _FILES:
        yield from data.glob(pattern)
    for name in _FOLDERS:
        if (folder := data / name).is_dir():
            yield folder
            yield from folder.rglob("*")
