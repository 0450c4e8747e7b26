"""Access to a large map for SPARQL: it is read in pieces into a store on disk.

The triples are passed to the loading process piece by piece, between the node's other work, and commits may
come in between. The store therefore begins in a state between two commits. Applying all commits since the
first piece makes it consistent, because each commit lists the added and removed triples.

If most of the map is one large commit, its store is filled while the commit is checked. If the commit comes
from a document, the store is filled while the document is read.
"""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future
from contextlib import suppress
from itertools import chain, islice
from pathlib import Path
from typing import Final, NamedTuple

from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.nodes.kb_node.sparql.triples.dataset import Delta
from semmap.nodes.kb_node.sparql.triples.disk_stores import DiskStores
from semmap.nodes.kb_node.sparql.triples.store_filler import StoreFiller
from semmap.nodes.kb_node.storage.journal import Journal
from semmap.nodes.runtime.futures import settle
from semmap.schemas import errors
from semmap.schemas.commits import Commit
from semmap.schemas.explanations import Triple

LARGE: Final = 200_000
"""Triples above which the store is on disk. Smaller stores are created as fast in memory."""
_PIECE: Final = 1000
"""Subjects in a piece, which takes the node's thread some milliseconds."""
_FRAME: Final = 20_000
"""Triples of a commit that are sent at once."""
_BYTES_OF_A_TRIPLE: Final = 40
"""Lower bound for a document."""
_OTHERWISE: Final = (b"_:", b"[", b"(", b"\xef\xbb\xbf")
"""Content that the map may read differently from the store, because blank nodes get other labels."""
_FAR_BEHIND: Final = 20_000
_FAR_BEHIND_BYTES: Final = 16 << 20
"""Commits, and their bytes in the journal, beyond which an old store is created again."""


class FilledStore(NamedTuple):
    """A store with all commits up to `seq` and some of those up to `settled`."""

    path: Path
    seq: int
    settled: int


class LargeMap:
    """The large map. Owned by the node's thread; `soon(handle)` calls `handle()` there between other work."""

    def __init__(
        self,
        journal: Journal,
        reasoner: Callable[[], Reasoner],
        soon: Callable[[Callable[[], None]], None],
        *,
        large: int = LARGE,
    ) -> None:
        self._journal = journal
        self._reasoner = reasoner
        self._soon = soon
        self._large = large
        self._stores = DiskStores(journal.path.parent)
        self._filler: StoreFiller | None = None
        self._prepared: tuple[str, StoreFiller] | None = None
        """The id of a commit that is being checked, and the store of the map after it."""

    @property
    def is_large(self) -> bool:
        """Return whether the map needs a store on disk."""
        return len(self._reasoner()) > self._large

    def is_large_change(self, commit: Commit) -> bool:
        """Return whether a commit is so large that the store is better created again."""
        return len(commit.inserted) + len(commit.retracted) > self._large

    def find_store(self, seq: int) -> tuple[FilledStore, list[Delta]] | None:
        """Return the kept store and the commits since, up to `seq`, or None if it is not usable."""
        for number, digest, path in self._stores.found():
            if number > seq or self._journal.digest(number).hex() != digest:
                continue
            count, size = self._journal.size_after(after=number)
            if count > _FAR_BEHIND or size > _FAR_BEHIND_BYTES or self._journal.tbox_changes(number):
                continue
            return FilledStore(path, number, number), [
                delta_of(c) for c in self._journal.commits(after=number)
            ]
        return None

    def prefetch(self, commit_id: str, turtle: bytes, base: str, *, packed: bytes = b"") -> None:
        """Begin the store of a commit that will insert a document, if the document is large enough.

        `packed` is the compressed document, which is kept until the store is filled. The caller must
        `discard` the store if the commit differs or is not made.
        """
        is_much = len(turtle) > self._large * _BYTES_OF_A_TRIPLE and not any(
            map(turtle.__contains__, _OTHERWISE)
        )
        if is_much and not self.is_large:
            self._begin(commit_id, (), packed or turtle, base)

    def prepare(self, commit: Commit) -> Callable[[], None]:
        """Begin the store of a commit that is being checked, if it is large enough.

        The returned function aborts that.
        """
        if self._prepared is None or self._prepared[0] != commit.id or commit.retracted:
            self.discard()  # of an aborted commit
            if self.is_large_change(commit) and not (commit.retracted or self.is_large):
                self._begin(commit.id, commit.inserted)
        return self.discard

    def discard(self) -> None:
        """Abort the store that was begun in advance."""
        if self._prepared is not None:
            self._prepared[1].abort()
            self._prepared = None

    def _begin(self, commit_id: str, inserted: Sequence[Triple], turtle: bytes = b"", base: str = "") -> None:
        self.discard()
        with suppress(OSError):  # `fill` reports it
            path = self._stores.begin()
            before = list(self._reasoner().asserted())
            self._prepared = commit_id, StoreFiller(path, _frames(before, inserted), turtle, base=base)

    def fill(self, seq: int, now: Callable[[], int], commit: Commit | None = None) -> Future[FilledStore]:
        """Create the store of the present map after commit `seq`. The node's thread resolves the future.

        `commit` is the commit just made, whose store may exist already. `now()` returns the number of the
        last commit. The future fails with Refused if the disk is full, or if literals differ only in their
        spelling.
        """
        future: Future[FilledStore] = Future()
        count: int | None = None
        if commit is not None and self._prepared is not None and self._prepared[0] == commit.id:
            (_, filler), self._prepared = self._prepared, None
            count = len(self._reasoner())
        else:
            try:
                filler = StoreFiller(self._stores.begin(), self._pieces())
            except OSError as error:
                future.set_exception(errors.Refused(f"the SPARQL store cannot be created: {error.strerror}"))
                return future
        self._filler = filler

        def finish(done: Future[tuple[int, int]]) -> FilledStore:
            sent, found = done.result()
            return self._finished(filler.path, found == (sent if count is None else count), seq, now())

        def on_done(done: Future[tuple[int, int]]) -> None:
            self._soon(lambda: settle(future, lambda: finish(done)))

        filler.outcome.add_done_callback(on_done)
        return future

    def _pieces(self) -> Iterator[Sequence[Triple]]:
        """Yield the asserted triples for another thread, in pieces that the node's thread makes."""
        subjects = self._reasoner().by_subject()
        while groups := self._on_the_node(lambda: list(islice(subjects, _PIECE))):
            yield list(chain.from_iterable(groups))

    def _on_the_node(self, take: Callable[[], list[list[Triple]]]) -> list[list[Triple]]:
        future: Future[list[list[Triple]]] = Future()
        self._soon(lambda: settle(future, take))
        return future.result()

    def _finished(self, path: Path, is_whole: bool, seq: int, settled: int) -> FilledStore:
        if not is_whole:
            shutil.rmtree(path, ignore_errors=True)
            raise errors.Refused("some literals differ only in spelling")
        try:
            return FilledStore(self._stores.finish(path, seq, self._journal.digest(seq)), seq, settled)
        except OSError as error:
            raise errors.Refused(f"the SPARQL store could not be kept: {error.strerror}") from None

    def close(self) -> None:
        """Abort stores that are being created."""
        for filler in (self._filler, self._prepared and self._prepared[1]):
            if filler is not None and not filler.outcome.done():
                filler.abort()


def _frames(*groups: Sequence[Triple]) -> Iterator[Sequence[Triple]]:
    for triples in groups:
        for start in range(0, len(triples), _FRAME):
            yield triples[start : start + _FRAME]


def delta_of(commit: Commit) -> Delta:
    """Return a commit as a delta."""
    return Delta(seq=commit.seq, retracted=commit.retracted, inserted=commit.inserted)
