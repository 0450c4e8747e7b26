"""Reads the commits of a recording, for programs."""

from __future__ import annotations

import logging
import os
import shutil
import struct
import tempfile
import warnings
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from rerun.chunk import RrdReader

from nodes.recorder.recording import COMMIT_FIELDS, COMMITS
from schemas import errors
from schemas.explanations import Triple

log = logging.getLogger(__name__)

_SIGNATURE = b"RRF"
_FILE_HEADER_BYTES = 12
_MESSAGE_HEADER = struct.Struct("<QQ")


@dataclass(frozen=True)
class RecordedCommit:
    """What a recording says of one commit. `changed` and `removed` are names of entities.

    `came` and `went` are facts of where things are that were computed; of a commit that was recorded
    afterwards, from the journal, they are not known, and empty.
    """

    seq: int
    stamp_ns: int
    id: str
    source: str
    agent: str
    reason: str
    inserted: tuple[Triple, ...]
    retracted: tuple[Triple, ...]
    changed: tuple[str, ...]
    removed: tuple[str, ...]
    came: tuple[Triple, ...] = field(default=(), compare=False)
    went: tuple[Triple, ...] = field(default=(), compare=False)


def require_recording(path: Path) -> None:
    """Raises BadFile, saying why, when `path` is not the file of a recording."""
    try:
        with path.open("rb") as file:
            signature = file.read(len(_SIGNATURE))
    except FileNotFoundError:
        raise errors.BadFile(f"no such file: {path}") from None
    except OSError as error:
        raise errors.BadFile(f"cannot read {path}: {error.strerror}") from None
    if signature != _SIGNATURE:
        raise errors.BadFile(f"{path} is not a recording (.rrd)")


def read_commits(path: Path) -> list[RecordedCommit]:
    """All commits in a recording, by number. Raises BadFile.

    One that was both heard and recalled counts once. Where the file ends within a message, because it grows
    or its writer was killed, the commits up to there are given, and a warning tells how much is left out.
    """
    require_recording(path)
    try:
        commits = _once_each(_commits(path, called=path))
    except errors.BadFile:
        with tempfile.TemporaryDirectory() as folder:
            whole = Path(shutil.copyfile(path, Path(folder, path.name)))
            left_out = _cut_after_last_message(whole)
            if not left_out:
                raise
            commits = _once_each(_commits(whole, called=path))
        log.warning("%s ends in the middle of a message; its last %d bytes are ignored", path, left_out)
    return sorted(commits, key=lambda commit: (commit.seq, commit.stamp_ns))


def _cut_after_last_message(path: Path) -> int:
    """Shorten the file of a recording to its whole messages: by how many bytes.

    After the file's header, each message has its kind and its length before it.
    """
    with path.open("r+b") as file:
        size, end = file.seek(0, os.SEEK_END), _FILE_HEADER_BYTES
        while (start := end + _MESSAGE_HEADER.size) <= size:
            file.seek(end)
            _, length = _MESSAGE_HEADER.unpack(file.read(_MESSAGE_HEADER.size))
            if start + length > size:
                break
            end = start + length
        file.truncate(min(end, size))
    return max(size - end, 0)


def _commits(path: Path, *, called: Path) -> Iterator[RecordedCommit]:
    with warnings.catch_warnings():
        # A recording that is not closed, because it grows or its writer was killed, has no footer.
        warnings.filterwarnings("ignore", message=".*no footer")
        try:
            for chunk in RrdReader(path).stream():
                if chunk.entity_path == f"/{COMMITS}":
                    yield from map(_commit_of, _rows(chunk.to_record_batch()))
        except (RuntimeError, ValueError) as error:
            raise errors.BadFile(f"cannot read {called}: {error}") from None


def _once_each(commits: Iterable[RecordedCommit]) -> set[RecordedCommit]:
    """Without those that were recorded twice: the one that tells what was computed is kept."""
    found: dict[RecordedCommit, RecordedCommit] = {}
    for commit in commits:
        if commit not in found or commit.came or commit.went:
            found[commit] = commit
    return set(found.values())


def _rows(batch: Any) -> list[dict[str, Any]]:
    prefix = f"{COMMIT_FIELDS}:"
    names = [name for name in batch.schema.names if name.startswith(prefix)]
    rows = batch.select(names).to_pylist()
    return [{key.removeprefix(prefix): value for key, value in row.items()} for row in rows]


def _commit_of(row: dict[str, Any]) -> RecordedCommit:
    def several(field: str) -> list[str]:
        # A field that is empty in every commit of a chunk has no column there.
        return row.get(field) or []

    return RecordedCommit(
        seq=row["seq"][0],
        stamp_ns=row["stamp_ns"][0],
        id=row["id"][0],
        source=row["source"][0],
        agent=row["agent"][0],
        reason=row["reason"][0],
        inserted=tuple(map(_triple, several("inserted"))),
        retracted=tuple(map(_triple, several("retracted"))),
        changed=tuple(several("changed")),
        removed=tuple(several("removed")),
        came=tuple(map(_triple, several("came"))),
        went=tuple(map(_triple, several("went"))),
    )


def _triple(line: str) -> Triple:
    """The triple of a line of N-Triples; only the object may hold spaces."""
    subject, predicate, object_ = line.removesuffix(" .").split(" ", 2)
    return (subject, predicate, object_)
