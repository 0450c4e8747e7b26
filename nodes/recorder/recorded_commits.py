"""Reads the commits of a recording, for programs."""

from __future__ import annotations

import logging
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from semmap.nodes.recorder.intact_part import chunks, open_intact_part
from semmap.nodes.recorder.recording import COMMIT_FIELDS, COMMITS
from semmap.schemas.explanations import Triple

log = logging.getLogger(__name__)


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


def read_commits(path: Path) -> list[RecordedCommit]:
    """All commits in a recording, by number. Raises BadFile.

    One that was both heard and recalled counts once. Where the file ends within a message, because it grows
    or its writer was killed, or is damaged, the commits up to there are given, and a warning tells how much
    is left out.
    """
    with open_intact_part(path) as whole:
        if text := whole.describe(path):
            log.warning("%s", text)
        return commits_of(whole.path)


def commits_of(path: Path) -> list[RecordedCommit]:
    """All commits in a recording that can be read to its end, by number."""
    return sorted(_deduplicated(_commits(path)), key=lambda commit: (commit.seq, commit.stamp_ns))


def _commits(path: Path) -> Iterator[RecordedCommit]:
    for chunk in chunks(path):
        if chunk.entity_path == f"/{COMMITS}":
            yield from map(_commit_of, _rows(chunk.to_record_batch()))


def _deduplicated(commits: Iterable[RecordedCommit]) -> set[RecordedCommit]:
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
