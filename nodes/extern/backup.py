"""Backups: a backup is fetched in parts, written to a local file, and verified."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

from semmap.schemas import backups, errors
from semmap.schemas.backups import BackupPart, Opening
from semmap.schemas.commands import Backup

_NEW = os.O_WRONLY | os.O_CREAT | os.O_EXCL


def write(
    ask: Callable[[Backup], BackupPart],
    file: str | Path,
    *,
    overwrite: bool = False,
    tell: Callable[[int], Any] = lambda size: None,
) -> Opening:
    """Write a map and its history to `file`, and return which map it is and its commit.

    `ask` requests a part of the backup, and `tell` receives the number of bytes written so far. The file is
    created only after it is complete and verified by its digests. Raises BadFile if the file exists and
    `overwrite` is not set, or if it cannot be written, and the errors of `ask`.
    """
    path = Path(file)
    if path.exists() and not overwrite:
        raise errors.BadFile(f"{path} already exists; add --overwrite or choose another name")
    unfinished = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        with os.fdopen(os.open(unfinished, _NEW, 0o600), "wb") as opened:
            part = ask(Backup())
            size = opened.write(part.content)
            while part.next:
                tell(size)
                part = ask(Backup(at=part.next))
                size += opened.write(part.content)
            opened.flush()
            os.fsync(opened.fileno())
        opening = backups.verify(unfinished)
        unfinished.replace(path)
    except OSError as error:
        raise errors.BadFile(f"the backup cannot be written to {path}: {error.strerror}") from None
    finally:
        unfinished.unlink(missing_ok=True)
    return opening
