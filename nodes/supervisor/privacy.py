"""A system's files are its user's own: folders 0700, files 0600."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path
from typing import Final

UMASK: Final = 0o077
"""For the processes that write them."""
_FILES: Final = ("journal.sqlite*", "*.closure", "settings.json", "supervisord.*")
_FOLDERS: Final = ("logs", "recordings", "kept", "sparql")


def make_private(data: Path) -> None:
    """Make the data folder, if need be, and take away others' access to it and to semmap's files in it.

    Raises OSError when it cannot be made. What belongs to another user is left as it is.
    """
    data.mkdir(mode=0o700, parents=True, exist_ok=True)
    for path in (data, *_own(data)):
        with contextlib.suppress(OSError):  # another user's, or gone
            mode = path.lstat().st_mode & 0o7777
            if mode & UMASK and not path.is_symlink():
                path.chmod(mode & ~UMASK)


def _own(data: Path) -> Iterator[Path]:
    """What semmap has written there: the folder may have other things in it."""
    for pattern in _FILES:
        yield from data.glob(pattern)
    for name in _FOLDERS:
        if (folder := data / name).is_dir():
            yield folder
            yield from folder.rglob("*")
