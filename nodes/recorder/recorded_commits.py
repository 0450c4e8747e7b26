"""Reads the commits of a recording, for use in programs."""

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
    """One commit of a recording. `changed` and `removed` are names of entities.

    `came` and `went` are computed spatial facts. They are unknown, and empty, for a commit that was recorded
    later from the journal.
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
    """Return all commits in a recording, by number. Raises BadFile.

    A commit that was recorded twice counts once. If the file is truncated or damaged, the commits of its
    intact part are returned, and a warning says how much is ignored.
    """
    with open_intact_part(path) as whole:
        if text := whole.describe(path):
            log.warning("%s", text)
        return commits_of(whole.path)


def commits_of(path: Path) -> list[RecordedCommit]:
    """Return all commits in an intact recording, by number."""
    return sorted(_deduplicated(_commits(path)), key=lambda commit: (commit.seq, commit.stamp_ns))


def _commits(path: Path) -> Iterator[RecordedCommit]:
    for chunk in chunks(path):
        if chunk.entity_path == f"/{COMMITS}":
            yield from map(_commit_of, _rows(chunk.to_record_batch()))


def _deduplicated(commits: Iterable[RecordedCommit]) -> set[RecordedCommit]:
    """Remove commits that were recorded twice; the record with computed facts is kept."""
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
    """Parse a triple from a line of N-Triples. Only the object may contain spaces."""
    subject, predicate, object_ = line.removesuffix(" .").split(" ", 2)
    return (subject, predicate, object_)
