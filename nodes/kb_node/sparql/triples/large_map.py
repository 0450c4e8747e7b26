"""The map as SPARQL needs it when it is large: read in pieces, and followed from a store that is on disk.

The triples go to the process that fills the store piece by piece, between the node's other work, and commits
may come meanwhile. So the store begins as something between two states of the map; taking in all commits
since the first piece, which say what is there and what is not, makes it the map as it is.

The store of a map that is mostly one large commit is begun when this is, and filled while it is checked; if
the commit is what a document says, when that comes, and filled from it while it is read.
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
"""Triples: a map of more has its store on disk; of fewer in memory, which is as soon made."""
_PIECE: Final = 1000
"""Subjects in a piece: some milliseconds of the node's thread."""
_FRAME: Final = 20_000
"""Triples of a commit that are sent at once."""
_BYTES_OF_A_TRIPLE: Final = 40
"""At least, in a document."""
_OTHERWISE: Final = (b"_:", b"[", b"(", b"\xef\xbb\xbf")
"""With these a document may say something else to the map: blank nodes have other labels there."""
_FAR_BEHIND: Final = 20_000
_FAR_BEHIND_BYTES: Final = 16 << 20
"""Commits, and their size in the journal: a store that lacks more is made anew."""


class FilledStore(NamedTuple):
    """A store: it has all commits up to `seq` and some of those up to `settled`."""

    path: Path
    seq: int
    settled: int


class LargeMap:
    """Owned by the node's thread, on which `soon(handle)` calls `handle()` between other work."""

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
        """Is it worth a store on disk?"""
        return len(self._reasoner()) > self._large

    def is_large_change(self, commit: Commit) -> bool:
        """Is a commit so large that the store is better made anew?"""
        return len(commit.inserted) + len(commit.retracted) > self._large

    def find_store(self, seq: int) -> tuple[FilledStore, list[Delta]] | None:
        """The store that was kept, and the commits since, up to `seq`; None if it does not do."""
        for number, digest, path in self._stores.found():
            if number > seq or self._journal.digest(number).hex() != digest:
                continue
            count, size = self._journal.extent(after=number)
            if count > _FAR_BEHIND or size > _FAR_BEHIND_BYTES or self._journal.tbox_changes(number):
                continue
            return FilledStore(path, number, number), [
                delta_of(c) for c in self._journal.commits(after=number)
            ]
        return None

    def prefetch(self, commit_id: str, turtle: bytes, base: str, *, packed: bytes = b"") -> None:
        """What a document says will be inserted by a commit of that id: begin its store if that is worth it.

        `packed` is the same as it came, if that was packed: so much is kept until the store is filled.
        Whoever finds that it is not so, or that there will be no commit, has to `forget` it.
        """
        is_much = len(turtle) > self._large * _BYTES_OF_A_TRIPLE and not any(
            map(turtle.__contains__, _OTHERWISE)
        )
        if is_much and not self.is_large:
            self._begin(commit_id, (), packed or turtle, base)

    def prepare(self, commit: Commit) -> Callable[[], None]:
        """A commit will be made if it stands the check: begin its store if that is worth it.

        What is returned gives it up again.
        """
        if self._prepared is None or self._prepared[0] != commit.id or commit.retracted:
            self.discard()  # what was taken back
            if self.is_large_change(commit) and not (commit.retracted or self.is_large):
                self._begin(commit.id, commit.inserted)
        return self.discard

    def discard(self) -> None:
        """What was foreseen or foretold does not come."""
        if self._prepared is not None:
            self._prepared[1].abort()
            self._prepared = None

    def _begin(self, commit_id: str, inserted: Sequence[Triple], turtle: bytes = b"", base: str = "") -> None:
        self.discard()
        with suppress(OSError):  # `fill` says so
            path = self._stores.begin()
            before = list(self._reasoner().asserted())
            self._prepared = commit_id, StoreFiller(path, _frames(before, inserted), turtle, base=base)

    def fill(self, seq: int, now: Callable[[], int], commit: Commit | None = None) -> Future[FilledStore]:
        """Make the store of the map after commit `seq`, as it is; the node's thread resolves the future.

        `commit` is that one if it was just made: its store may be there already. `now()` is the number of the
        last commit. The future's error is Refused when the disk does not take it, or when literals differ in
        nothing but how they are spelled.
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
        """The asserted triples, for another thread, in pieces that the node's makes when it can."""
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
        """Give up what is being made."""
        for filler in (self._filler, self._prepared and self._prepared[1]):
            if filler is not None and not filler.outcome.done():
                filler.abort()


def _frames(*groups: Sequence[Triple]) -> Iterator[Sequence[Triple]]:
    for triples in groups:
        for start in range(0, len(triples), _FRAME):
            yield triples[start : start + _FRAME]


def delta_of(commit: Commit) -> Delta:
    """A commit as its readers need it."""
    return Delta(seq=commit.seq, retracted=commit.retracted, inserted=commit.inserted)
