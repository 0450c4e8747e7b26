"""A node's replica of the map: a snapshot, updated by the commits since."""

from __future__ import annotations

from typing import Final, Generic, TypeVar

from semmap.nodes.runtime.interning import EntityInterner
from semmap.schemas import errors
from semmap.schemas.bridge import SnapshotQuery
from semmap.schemas.commits import Commit, Effects, Snapshot
from semmap.schemas.entities import Entity

PAGE: Final = 5000
"""Entities in a page of a snapshot: some megabytes, and some milliseconds of the knowledge base."""
_DIGESTS: Final = 1000
"""Commits whose digests are remembered."""


_MOST_AHEAD: Final = 100
"""Commits that are kept for when those before them have come."""


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
        """What asks for the page that follows `page`, which has more after it."""
        return SnapshotQuery(after=page.entities[-1].name, limit=PAGE)

    def take(self, page: Snapshot) -> None:
        """The reply to `query`, which asks for the next page from then on."""
        if self._seq is None:
            self._seq, self._digest = page.seq, page.digest
        self._entities += map(self._shared.entity, page.entities)
        self.are_complete = not page.more
        if page.more:
            self.query = self.after(page)

    @property
    def snapshot(self) -> Snapshot:
        """All that was fetched, with the number of the first page: what came later is taken again."""
        if self._seq is None:
            raise errors.InternalError("no page of the map was fetched")
        return Snapshot(seq=self._seq, entities=tuple(self._entities), digest=self._digest)


C = TypeVar("C", Commit, Effects)


class MapReplica(Generic[C]):
    """The entities by name, as of commit `seq`; -1 before a first snapshot.

    Anybody may publish what looks like a commit. So it remembers the digests of those that it took, and
    compares: where the knowledge base says another one, all of it is in doubt, and a snapshot counts.
    """

    def __init__(self) -> None:
        self.seq = -1
        self.entities: dict[str, Entity] = {}
        self._heard = -1
        self._lacking = -1
        self._doubted = self._doubted_meanwhile = False
        self._ahead: dict[int, C] = {}
        """Commits that came before those they follow: a reply may be read while others wait to be."""
        self._during_pages: dict[int, C] | None = None
        self._digests: dict[int, str] = {}
        self._confirmed = -1

    @property
    def is_confirmed(self) -> bool:
        """Is it current, and does the knowledge base say so itself: in a reply, a snapshot, a heartbeat?"""
        return self.is_current and self._confirmed == self.seq

    @property
    def is_current(self) -> bool:
        """Whether it is in force and has every commit that was heard of.

        One may be heard of before a snapshot that was made without it.
        """
        return self.seq >= 0 and self._heard <= self.seq and not self._doubted

    @property
    def is_being_fetched(self) -> bool:
        """Whether somebody is fetching a snapshot in pages."""
        return self._during_pages is not None

    def begin_pages(self) -> SnapshotPages:
        """A snapshot in pages, to `begin` with when they are complete; commits are kept in mind meanwhile.

        Who cannot complete them says so by `give_up_pages`.
        """
        self._during_pages = {}
        return SnapshotPages()

    def give_up_pages(self) -> None:
        """The pages that were begun do not come."""
        self._during_pages = None

    def begin(self, snapshot: Snapshot) -> bool:
        """Take over a snapshot, and the commits that came while its pages did.

        False, and nothing is taken, if it is older than what is known and that is not in doubt.
        """
        if snapshot.seq < self.seq and not self._doubted:
            self._during_pages = None
            return False
        self._doubted, is_doubted_anew = False, self._doubted_meanwhile
        self._doubted_meanwhile = False
        self.seq = self._confirmed = snapshot.seq
        self._digests = {snapshot.seq: snapshot.digest}
        self.entities = {entity.name: entity for entity in snapshot.entities}
        self._forget_what_never_was(snapshot.seq)
        since, self._during_pages = {**self._ahead, **(self._during_pages or {})}, None
        self._ahead.clear()
        for _, commit in sorted(since.items()):
            self.take(commit)
        if is_doubted_anew:  # one of those may be forged, and hide what the next snapshot shows
            self.doubt()
        return True

    def _forget_what_never_was(self, seq: int) -> None:
        """A commit that was heard of and that two snapshots lack was never made."""
        if self._heard > seq and self._heard == self._lacking:
            self._heard = seq
            self._ahead.clear()
        self._lacking = self._heard

    def take(self, commit: C) -> bool:
        """Take over a commit. False if a snapshot is needed.

        That is so if the commit is abridged, one before it was missed, or all of it is in doubt.
        """
        if commit.seq <= self.seq:
            self._compare(commit.seq, commit.digest)
        self._heard = max(self._heard, commit.seq)
        if self._during_pages is not None:
            self._keep(self._during_pages, commit)
        following: C | None = commit
        if commit.seq > self.seq + 1 and len(self._ahead) < _MOST_AHEAD:
            self._keep(self._ahead, commit)
        while following is not None and following.seq == self.seq + 1 and following.abridged is None:
            self._apply(following)
            following = self._ahead.pop(self.seq + 1, None)
        return commit.seq <= self.seq and not self._doubted

    def _keep(self, waiting: dict[int, C], commit: C) -> None:
        """Let it wait; all is in doubt if another one of its number does."""
        other = waiting.setdefault(commit.seq, commit)
        if commit.digest and other.digest != commit.digest:
            self.doubt()

    def _apply(self, commit: C) -> None:
        """Let the entities be as the next commit leaves them."""
        self.seq = commit.seq
        self._digests[commit.seq] = commit.digest
        self._digests.pop(commit.seq - _DIGESTS, None)
        for gone in commit.removed:
            self.entities.pop(gone.name, None)
        for entity in commit.changed:
            self.entities[entity.name] = entity

    def confirm(self, seq: int, digest: str) -> None:
        """The knowledge base itself says that this is commit `seq`, and with it all that came before."""
        if self._compare(seq, digest):
            self._confirmed = max(self._confirmed, seq)

    def _compare(self, seq: int, digest: str) -> bool:
        """Is it known that this is commit `seq`? All is in doubt if another one is known."""
        known = self._digests.get(seq)
        if known is not None and digest and known != digest:
            self.doubt()
        return bool(known) and known == digest

    def doubt(self) -> None:
        """Another knowledge base may know less, after a repair: its snapshot counts, whatever its number.

        So it is when commits contradict one another.
        """
        self._heard = -1
        self._doubted = True
        self._doubted_meanwhile = self._during_pages is not None
        self._ahead.clear()
