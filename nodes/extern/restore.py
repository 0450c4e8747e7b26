"""Restoring a map from a backup, in a data folder whose system is stopped."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

from semmap.nodes.runtime import extras
from semmap.schemas import backups
from semmap.schemas.backups import Restored


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
