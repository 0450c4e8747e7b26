"""What a node knows of the map by following it: the last snapshot, kept fresh by the commits since."""

from __future__ import annotations

from typing import Final, Generic, TypeVar

from nodes.runtime.shared_parts import SharedParts
from schemas.bridge import SnapshotQuery
from schemas.commits import Commit, Effects, Snapshot
from schemas.entities import Entity

PAGE: Final = 5000
"""Entities in a page of a snapshot: some megabytes, and some milliseconds of the knowledge base."""


class SnapshotPages:
    """A snapshot that is fetched page by page."""

    def __init__(self) -> None:
        self.query = SnapshotQuery(limit=PAGE)
        self.are_complete = False
        self._shared = SharedParts()
        self._seq: int | None = None
        self._entities: list[Entity] = []

    def take(self, page: Snapshot) -> None:
        """The reply to `query`, which asks for the next page from then on."""
        if self._seq is None:
            self._seq = page.seq
        self._entities += map(self._shared.entity, page.entities)
        self.are_complete = not page.more
        if page.more:
            self.query = SnapshotQuery(after=page.entities[-1].name, limit=PAGE)

    @property
    def snapshot(self) -> Snapshot:
        """All that was fetched, with the number of the first page: what came later is taken again."""
        assert self._seq is not None
        return Snapshot(seq=self._seq, entities=tuple(self._entities))


C = TypeVar("C", Commit, Effects)


class MapReplica(Generic[C]):
    """The entities by name, as of commit `seq`; -1 before a first snapshot."""

    def __init__(self) -> None:
        self.seq = -1
        self.entities: dict[str, Entity] = {}
        self._heard = -1
        self._during_pages: dict[int, C] | None = None

    @property
    def is_behind(self) -> bool:
        """Was a commit heard of that it lacks? One may come before a snapshot that was made without it."""
        return self.seq < self._heard

    def begin_pages(self) -> SnapshotPages:
        """A snapshot in pages, to `begin` with when they are complete; commits are kept in mind meanwhile."""
        self._during_pages = {}
        return SnapshotPages()

    def begin(self, snapshot: Snapshot) -> None:
        """Take over a snapshot, and the commits that came while its pages did."""
        self.seq = snapshot.seq
        self.entities = {entity.name: entity for entity in snapshot.entities}
        since, self._during_pages = self._during_pages or {}, None
        for _, commit in sorted(since.items()):
            self.take(commit)

    def take(self, commit: C) -> bool:
        """Take over a commit. False if it is abridged or one before it was missed: a snapshot is needed."""
        self._heard = max(self._heard, commit.seq)
        if self._during_pages is not None:
            self._during_pages[commit.seq] = commit
        if commit.seq == self.seq + 1 and commit.abridged is None:
            self.seq = commit.seq
            for gone in commit.removed:
                self.entities.pop(gone.name, None)
            self.entities.update({entity.name: entity for entity in commit.changed})
        return commit.seq <= self.seq

    def doubt(self) -> None:
        """Another knowledge base may know less than what was heard of the one before."""
        self._heard = -1
