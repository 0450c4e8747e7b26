"""The map as SPARQL needs it when it is large: read in pieces, and followed from a store that is on disk.

The triples go to the process that fills the store piece by piece, between the node's other work, and commits
may come meanwhile. So the store begins as something between two states of the map; taking in all commits
since the first piece, which say what is there and what is not, makes it the map as it is.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from contextlib import suppress
from itertools import chain, islice
from pathlib import Path
from typing import Final, NamedTuple

from nodes.kb_node.reasoner import Reasoner
from nodes.kb_node.sparql.triples.dataset import Delta
from nodes.kb_node.sparql.triples.kept import KeptStores
from nodes.kb_node.storage.journal import Journal
from nodes.runtime.futures import settle
from schemas import errors
from schemas.commits import Commit
from schemas.explanations import Triple

LARGE: Final = 200_000
"""Triples: a map of more has its store on disk; of fewer in memory, which is as soon made."""
_PIECE: Final = 1000
"""Subjects in a piece: some milliseconds of the node's thread."""
_FAR_BEHIND: Final = 20_000
_FAR_BEHIND_BYTES: Final = 16 << 20
"""Commits, and their size in the journal: a store that lacks more is made anew."""


class Filled(NamedTuple):
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
        self._stores = KeptStores(journal.path.parent)
        self._process: subprocess.Popen[bytes] | None = None

    @property
    def is_large(self) -> bool:
        """Is it worth a store on disk?"""
        return len(self._reasoner()) > self._large

    def is_much(self, commit: Commit) -> bool:
        """Is a commit so large that the store is better made anew?"""
        return len(commit.inserted) + len(commit.retracted) > self._large

    def kept(self, seq: int) -> tuple[Filled, list[Delta]] | None:
        """The store that was kept, and the commits since, up to `seq`; None if it does not do."""
        for number, digest, path in self._stores.found():
            if number > seq or self._journal.digest(number).hex() != digest:
                continue
            count, size = self._journal.extent(after=number)
            if count > _FAR_BEHIND or size > _FAR_BEHIND_BYTES or self._journal.tbox_changes(number):
                continue
            return Filled(path, number, number), [delta_of(c) for c in self._journal.commits(after=number)]
        return None

    def fill(self, seq: int, now: Callable[[], int]) -> Future[Filled]:
        """Make the store of the map after commit `seq`, as it is; the node's thread resolves the future.

        `now()` is the number of the last commit. Its error is Refused when the disk does not take it, or when
        literals differ in nothing but how they are spelled.
        """
        future: Future[Filled] = Future()
        pieces = self._reasoner().by_subject()
        try:
            path = self._stores.begin()
        except OSError as error:
            future.set_exception(errors.Refused(f"the SPARQL store cannot be created: {error.strerror}"))
            return future

        def work() -> None:
            try:
                sent, found = self._pump(pieces, path)
                self._soon(lambda: settle(future, lambda: self._finished(path, sent, found, seq, now())))
            except (OSError, ValueError) as error:
                shutil.rmtree(path, ignore_errors=True)
                refusal = errors.Refused(f"the SPARQL store could not be created: {error}")
                self._soon(lambda: future.set_exception(refusal))

        threading.Thread(target=work, name="sparql-filling", daemon=True).start()
        return future

    def _pump(self, pieces: Iterator[list[Triple]], path: Path) -> tuple[int, int]:
        """Send all pieces: how many triples were sent, and how many the store has."""
        command = [sys.executable, "-P", "-m", "nodes.kb_node.sparql.triples.filling", str(path)]
        with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as process:
            self._process = process
            assert process.stdin is not None
            assert process.stdout is not None
            sent = 0
            while piece := self._on_the_node(lambda: list(islice(pieces, _PIECE))):
                triples = list(chain.from_iterable(piece))
                sent += len(triples)
                process.stdin.write("".join([f"{s} {p} {o} .\n" for s, p, o in triples]).encode())
            process.stdin.close()
            return sent, int(process.stdout.read())

    def _on_the_node(self, take: Callable[[], list[list[Triple]]]) -> list[list[Triple]]:
        future: Future[list[list[Triple]]] = Future()
        self._soon(lambda: settle(future, take))
        return future.result()

    def _finished(self, path: Path, sent: int, found: int, seq: int, settled: int) -> Filled:
        if found < sent:
            shutil.rmtree(path, ignore_errors=True)
            raise errors.Refused("some literals differ only in spelling")
        try:
            return Filled(self._stores.finish(path, seq, self._journal.digest(seq)), seq, settled)
        except OSError as error:
            raise errors.Refused(f"the SPARQL store could not be kept: {error.strerror}") from None

    def close(self) -> None:
        """Give up what is being made."""
        if self._process is not None:
            with suppress(OSError):
                self._process.kill()


def delta_of(commit: Commit) -> Delta:
    """A commit as its readers need it."""
    return Delta(seq=commit.seq, retracted=commit.retracted, inserted=commit.inserted)
