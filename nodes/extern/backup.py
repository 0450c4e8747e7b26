"""A backup as a file of the client's: fetched part by part, then read back and verified."""

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
    """Write the map that answers to `ask`, with its history, to `file`; which map it is, and as of when.

    `tell` is told how many bytes there are so far. The file appears when all of it is there and has been
    verified by its digests. Raises BadFile when it is there already and not to be overwritten, or cannot be
    written; what `ask` raises.
    """
    path = Path(file)
    if path.exists() and not overwrite:
        raise errors.BadFile(f"{path} is there already; overwrite it with --overwrite, or give another name")
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
