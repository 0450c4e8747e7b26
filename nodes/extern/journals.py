"""A copy of a map's journal, to read: of a data folder, or of a running system."""

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
    """Where the copy is, and the data folder that it is of; None where that is on another machine."""

    path: Path
    data: Path | None


@contextmanager
def own_folder() -> Iterator[Path]:
    """A folder that nobody else may read, deleted at the end."""
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
    """A copy of the journal of a data folder or, without one, of the system at `where`.

    Of one on another machine a backup is made. `what` needs it. Raises BadFile when there is no map in the
    folder, Refused when it is damaged, NoAnswer when no system answers.
    """
    extras.require(what, "kb")
    from semmap.nodes.kb_node.storage.journal import FILENAME
    from semmap.nodes.kb_node.storage.replay.journal_copy import copy

    with own_folder() as folder:
        path = folder / FILENAME
        if data is None and (data := _data_of(where, namespace)) is None:
            _backed_up(folder, where, identity, namespace)
        else:
            copy(data.resolve(), path)
        yield JournalCopy(path, data)


def _data_of(where: str | None, namespace: str | None) -> Path | None:
    """The data folder of a system that this user runs on this machine and that has the map itself."""
    from semmap.nodes.extern.connection import endpoint

    reachable = where or endpoint(namespace)
    found = [s for s in registry.systems() if reachable in (s.reachable, s.listen)]
    folders = [Path(s.data) for s in found if namespace in (None, s.namespace)]
    from semmap.nodes.kb_node.storage.journal import FILENAME

    return next((folder for folder in folders if (folder / FILENAME).exists()), None)


def _backed_up(folder: Path, where: str | None, identity: str | None, namespace: str | None) -> None:
    from semmap.nodes.extern.client import connect
    from semmap.nodes.extern.restoring import restore

    file = folder / "map.backup"
    with connect(where, identity=identity, namespace=namespace) as client:
        client.backup(file)
    try:
        restore(file, folder)
    except errors.BadFile as error:
        raise errors.Refused(error.text) from None
