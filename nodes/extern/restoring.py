"""A map from a backup, in a data folder whose system does not run."""

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
    """Restore a backup, made by `Client.backup`, to the data folder `data`; start it with `semmap up --data`.

    Nothing may run on that folder. A map that is there is moved to its folder `kept` if `replace`. `tell` is
    told, in words, how far the work is.

    Raises BadFile for what is no sound backup, and Refused when a system runs there, when there is a map that
    is not to be replaced, or when the disk does not take it; then nothing has changed. Needs the extra
    `semmap[kb]`.
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
