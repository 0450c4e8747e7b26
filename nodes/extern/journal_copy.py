"""Read-only copies of the journal of a data folder or of a running system."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

from semmap.nodes.runtime import extras
from semmap.nodes.supervisor import registry
from semmap.schemas import errors


class JournalCopy(NamedTuple):
    """The path of a copy, and the data folder of the original; None if that is on another machine."""

    path: Path
    data: Path | None


@contextmanager
def private_folder() -> Iterator[Path]:
    """Yield a temporary folder that only this user can read."""
    folder = Path(tempfile.mkdtemp(prefix=f"semmap-replay-{os.getpid()}-"))
    try:
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)


@contextmanager
def journal_copy(
    what: str,
    data: Path | None = None,
    *,
    where: str | None = None,
    identity: str | None = None,
    namespace: str | None = None,
) -> Iterator[JournalCopy]:
    """Yield a copy of the journal of a data folder or, without `data`, of the system at `where`.

    The journal of a system on another machine is copied by a backup. `what` is the command that needs it, for
    error messages. Raises BadFile if the folder has no map, Refused if the map is damaged, and NoAnswer if
    the system does not respond.
    """
    extras.require(what, "kb")
    from semmap.nodes.kb_node.storage.journal import FILENAME
    from semmap.nodes.kb_node.storage.replay.journal_copy import copy

    with private_folder() as folder:
        path = folder / FILENAME
        if data is None and (data := _data_folder(where, namespace)) is None:
            _fetch_backup(folder, where, identity, namespace)
        else:
            copy(data.resolve(), path)
        yield JournalCopy(path, data)


def _data_folder(where: str | None, namespace: str | None) -> Path | None:
    """Return the data folder with the map of a local system of this user, if there is one."""
    from semmap.nodes.extern.connection import resolve_endpoint

    reachable = resolve_endpoint(where, namespace)
    found = [s for s in registry.systems() if reachable in (s.reachable, s.listen)]
    folders = [Path(s.data) for s in found if namespace in (None, s.namespace)]
    from semmap.nodes.kb_node.storage.journal import FILENAME

    return next((folder for folder in folders if (folder / FILENAME).exists()), None)


def _fetch_backup(folder: Path, where: str | None, identity: str | None, namespace: str | None) -> None:
    from semmap.nodes.extern.backup import restore
    from semmap.nodes.extern.client import connect

    file = folder / "map.backup"
    with connect(where, identity=identity, namespace=namespace) as client:
        client.backup(file)
    try:
        restore(file, folder)
    except errors.BadFile as error:
        raise errors.Refused(error.text) from None
