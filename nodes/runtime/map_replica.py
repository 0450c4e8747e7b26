"""A node's replica of the map: a snapshot, updated by the commits since."""

from __future__ import annotations

from typing import Final, Generic, TypeVar

from semmap.nodes.runtime.interning import EntityInterner
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.bridge import SnapshotQuery
from semmap.schemas.commits import Commit, Effects, Snapshot
from semmap.schemas.entities import Entity

PAGE: Final = 5000
"""Entities in a page of a snapshot: some megabytes, and some milliseconds of the knowledge base's time."""
_DIGESTS: Final = 1000
"""Number of commits whose digests are stored."""


_MOST_AHEAD: Final = 100
"""Largest number of commits that wait for earlier ones."""


def note_name(entity: Entity) -> None:
    """Note the name of an entity for its IRI, for the rare case that it is not the one of the IRI."""
    if not entity.iri.endswith(entity.name) or v.has_given_name(v.iri(entity.iri)):
        v.give_name(v.iri(entity.iri), entity.name)


class SnapshotPages:
    """A snapshot that is fetched page by page."""

    def __init__(self) -> None:
        self.query = SnapshotQuery(limit=PAGE)
        self.are_complete = False
        self._shared = EntityInterner()
        self._seq: int | None = None
        self._digest = ""
        self._entities: list[Entity] = []

    @staticmethod
    def after(page: Snapshot) -> SnapshotQuery:
        """Return the query for the page after `page`, which must not be the last."""
        return SnapshotQuery(after=page.entities[-1].name, limit=PAGE)

    def take(self, page: Snapshot) -> None:
        """Add the reply to `query`, which is then the query for the next page."""
        if self._seq is None:
            self._seq, self._digest = page.seq, page.digest
        self._entities += map(self._shared.entity, page.entities)
        self.are_complete = not page.more
        if page.more:
            self.query = self.after(page)

    @property
    def snapshot(self) -> Snapshot:
        """The fetched entities, with the number of the first page; later commits are applied again."""
        if self._seq is None:
            raise errors.InternalError("no page of the map was fetched")
        return Snapshot(seq=self._seq, entities=tuple(self._entities), digest=self._digest)


C = TypeVar("C", Commit, Effects)


class MapReplica(Generic[C]):
    """The entities by name, as of commit `seq`; -1 before the first snapshot.

    Any program may publish messages that look like commits. The replica therefore stores the digests of its
    commits. If the knowledge base reports another digest, the replica is in doubt until the next snapshot.
    """

    def __init__(self) -> None:
        self.seq = -1
        self.entities: dict[str, Entity] = {}
        self._announced = -1
        self._missing = -1
        self._doubted = self._doubted_during_pages = False
        self._ahead: dict[int, C] = {}
        """Commits that arrived before earlier ones: a reply may be processed while publications wait."""
        self._during_pages: dict[int, C] | None = None
        self._digests: dict[int, str] = {}
        self._confirmed = -1

    @property
    def is_confirmed(self) -> bool:
        """Whether it is current, and confirmed by a reply, snapshot or heartbeat of the knowledge base."""
        return self.is_current and self._confirmed == self.seq

    @property
    def is_current(self) -> bool:
        """Whether it is valid and includes every commit that has arrived.

        A commit may arrive before a snapshot that does not include it.
        """
        return self.seq >= 0 and self._announced <= self.seq and not self._doubted

    @property
    def is_being_fetched(self) -> bool:
        """Whether a snapshot is being fetched."""
        return self._during_pages is not None

    def begin_pages(self) -> SnapshotPages:
        """Start a paged snapshot for `begin`; commits that arrive in the meantime are stored.

        Call `cancel_pages` if it cannot be completed.
        """
        self._during_pages = {}
        return SnapshotPages()

    def cancel_pages(self) -> None:
        """Cancel a paged snapshot."""
        self._during_pages = None

    def begin(self, snapshot: Snapshot) -> bool:
        """Load a snapshot, and apply the commits that arrived while it was fetched.

        Returns False, and loads nothing, if it is older than the replica and that is not in doubt.
        """
        if snapshot.seq < self.seq and not self._doubted:
            self._during_pages = None
            return False
        self._doubted, is_doubted_again = False, self._doubted_during_pages
        self._doubted_during_pages = False
        self.seq = self._confirmed = snapshot.seq
        self._digests = {snapshot.seq: snapshot.digest}
        self.entities = {entity.name: entity for entity in snapshot.entities}
        for entity in snapshot.entities:
            note_name(entity)
        self._forget_unmade(snapshot.seq)
        since, self._during_pages = {**self._ahead, **(self._during_pages or {})}, None
        self._ahead.clear()
        for _, commit in sorted(since.items()):
            self.take(commit)
        if is_doubted_again:  # one of these commits may be forged: fetch another snapshot
            self.doubt()
        return True

    def _forget_unmade(self, seq: int) -> None:
        """Forget an announced commit that two snapshots lack: it was never made."""
        if self._announced > seq and self._announced == self._missing:
            self._announced = seq
            self._ahead.clear()
        self._missing = self._announced

    def take(self, commit: C) -> bool:
        """Apply a commit. Returns False if a snapshot is needed.

        A snapshot is needed if the commit is abridged, an earlier one is missing, or the replica is in doubt.
        """
        if commit.seq <= self.seq:
            self._compare(commit.seq, commit.digest)
        self._announced = max(self._announced, commit.seq)
        if self._during_pages is not None:
            self._store(self._during_pages, commit)
        following: C | None = commit
        if commit.seq > self.seq + 1 and len(self._ahead) < _MOST_AHEAD:
            self._store(self._ahead, commit)
        while following is not None and following.seq == self.seq + 1 and following.abridged is None:
            self._apply(following)
            following = self._ahead.pop(self.seq + 1, None)
        return commit.seq <= self.seq and not self._doubted

    def _store(self, waiting: dict[int, C], commit: C) -> None:
        """Store a commit that has to wait; a different one with the same number puts the replica in doubt."""
        other = waiting.setdefault(commit.seq, commit)
        if commit.digest and other.digest != commit.digest:
            self.doubt()

    def _apply(self, commit: C) -> None:
        """Apply the next commit to the entities."""
        self.seq = commit.seq
        self._digests[commit.seq] = commit.digest
        self._digests.pop(commit.seq - _DIGESTS, None)
        for gone in commit.removed:
            self.entities.pop(gone.name, None)
        for entity in commit.changed:
            self.entities[entity.name] = entity
            note_name(entity)

    def confirm(self, seq: int, digest: str) -> None:
        """Note that the knowledge base has confirmed commit `seq` and all earlier ones."""
        if self._compare(seq, digest):
            self._confirmed = max(self._confirmed, seq)

    def _compare(self, seq: int, digest: str) -> bool:
        """Return whether commit `seq` has this digest; another digest puts the replica in doubt."""
        known = self._digests.get(seq)
        if known is not None and digest and known != digest:
            self.doubt()
        return bool(known) and known == digest

    def doubt(self) -> None:
        """Put the replica in doubt: the next snapshot is loaded, whatever its number.

        This is needed after a repair of the knowledge base, which may lose commits, and for contradictory
        commits.
        """
        self._announced = -1
        self._doubted = True
        self._doubted_during_pages = self._during_pages is not None
        self._ahead.clear()
