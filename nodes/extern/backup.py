"""Backups: written from a running system to a local file, and restored to a data folder."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

from semmap.nodes.runtime import extras
from semmap.schemas import backups, errors
from semmap.schemas.backups import BackupPart, Opening, Restored
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


def restore(
    file: str | Path,
    data: str | Path,
    *,
    replace: bool = False,
    tell: Callable[[str], None] = lambda text: None,
) -> Restored:
    """Restore a backup by `Client.backup` to the data folder `data`; start it with `semmap up --data`.

    The system of that folder must be stopped. With `replace`, an existing map is moved to its folder `kept`.
    `tell` receives progress messages.

    Raises BadFile for a damaged backup. Raises Refused if a system is running there, if there is a map and
    `replace` is not set, or if the disk is full; then nothing has changed. Requires the extra `semmap[kb]`.
    """
    extras.require("semmap restore", "kb")
    from semmap.nodes.kb_node.storage.backup.restore import restore as restore_journal
    from semmap.nodes.supervisor.privacy import UMASK, make_private
    from semmap.nodes.supervisor.up import alone

    file, folder = Path(file), Path(data).resolve()
    next(backups.read(file))  # before a folder is made
    umask = os.umask(UMASK)
    try:
        with alone(folder):
            make_private(folder)
            return restore_journal(file, folder, replace=replace, tell=tell)
    finally:
        os.umask(umask)
