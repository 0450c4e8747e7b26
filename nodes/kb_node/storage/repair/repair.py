"""Mends a damaged journal: what is good is kept, also after a damaged commit, and what is not is told.

What a damaged commit changed is worked out from a later checkpoint, if there is one. If there is none, it is
left out, and with it the later commits that change what it said. Numbers stay: in the place of a commit that
is left out is one that changes nothing and says so.
"""

from __future__ import annotations

import os
import struct
import time
import uuid
from collections.abc import Callable
from contextlib import suppress
from itertools import count
from pathlib import Path

from msgspec import structs

from semmap.nodes.kb_node.documents import ontology_files, rdf
from semmap.nodes.kb_node.documents.tbox import tbox_validation
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.storage import seed
from semmap.nodes.kb_node.storage.journal import FILENAME, Checkpoint, Journal, write_ahead
from semmap.nodes.kb_node.storage.journal.sqlite_file import InUse, NotWritten
from semmap.nodes.kb_node.storage.journal.verification import verify
from semmap.nodes.kb_node.storage.repair import salvage
from semmap.nodes.kb_node.storage.repair.restating import DoesNotFit, fitted
from semmap.schemas import errors
from semmap.schemas.commits import Commit

_TOLD_EVERY_S = 2.0
_MAGIC = b"SQLite format 3\0"
_HEADER = struct.Struct(">16sH10xI")
"""How an SQLite file begins: what it is, the size of a page [bytes], and how many pages there are."""


def repair(data: Path, tell: Callable[[str], None] = lambda text: None, *, tbox: Path | None = None) -> str:
    """Make the journal of folder `data` sound again, up to its last good commit; say what was done.

    Of long work `tell` is told how far it is. The TBox that the map began with is taken from the file `tbox`
    where the journal's own cannot be read.

    The damaged journal is moved to `data/kept/<time>/`. Raises BadFile when there is none, Refused when it is
    in use or holds nothing to go on from.
    """
    path = data / FILENAME
    if not path.exists():
        raise errors.BadFile(f"there is no map in {data}")
    new = path.with_name(f"new-{FILENAME}")
    damaged, mended = _opened(path)
    try:
        if _is_sound(damaged, _counting("checked", tell)):
            found = (
                "the log with the last commits was damaged and is mended" if mended else "nothing is damaged"
            )
            return f"{found} in {data}: the map continues from commit {damaged.last}"
        made = _Salvage(damaged, new, _first_tbox(damaged, tbox), tell)
        last = made.made()
    finally:
        damaged.close()
    kept = seed.put_in_place(new, path)
    return f"the map continues from commit {last} ({made.told()}); the damaged file is kept in {kept}"


def _opened(path: Path) -> tuple[Journal, bool]:
    """The journal, also one whose end is missing or whose log is damaged; whether the log was mended."""
    try:
        return Journal(path, to_salvage=True), False
    except InUse:
        raise
    except errors.Refused as error:
        if write_ahead.is_set_aside(path):
            write_ahead.mend(path)
            write_ahead.forget(path)
            return _opened(path)[0], True
        if _filled_up(path):
            return _opened(path)
        raise errors.Refused(f"{_reason(error)}; start a new map with --fresh (this one is kept)") from None


def _filled_up(path: Path) -> bool:
    """Was its end missing? SQLite reads nothing of such a file, but what is there when zeros follow."""
    with path.open("rb") as file:
        magic, page_size, pages = _HEADER.unpack(file.read(_HEADER.size).ljust(_HEADER.size))
    length = page_size * pages
    if magic != _MAGIC or path.stat().st_size >= length:
        return False
    os.truncate(path, length)
    return True


def _counting(done: str, tell: Callable[[str], None]) -> Callable[[], None]:
    """A function to call after each commit; now and then it tells how many there were."""
    numbers, due_s = count(1), time.monotonic() + _TOLD_EVERY_S

    def progress() -> None:
        nonlocal due_s
        number = next(numbers)
        if time.monotonic() >= due_s:
            due_s = time.monotonic() + _TOLD_EVERY_S
            tell(f"{number:,} commits {done}")

    return progress


def _is_sound(journal: Journal, progress: Callable[[], None]) -> bool:
    try:
        journal.require_format()
        verify(journal, progress)
    except errors.Refused:
        return False
    return True


def _first_tbox(damaged: Journal, instead: Path | None) -> bytes:
    """The TBox (N-Triples) that the map began with, or what is there in its place."""
    try:
        return damaged.tbox(damaged.beginning.seq)
    except errors.Refused as error:
        if instead is None:
            raise errors.Refused(
                f"{_reason(error)}: the TBox that the map started with cannot be read; provide it with"
                f" --tbox FILE, or start a new map with --fresh (the damaged file is kept)"
            ) from None
    triples = ontology_files.gather([instead], {}).triples
    tbox_validation.compile_tbox(triples, str(instead))
    return rdf.serialise(triples, "ntriples")


def _reason(error: errors.Refused) -> str:
    """What is wrong, without how one goes on."""
    return error.text.partition("; ")[0]


class _Salvage:
    """A journal that is made of what is good in a damaged one."""

    def __init__(self, damaged: Journal, new: Path, tbox: bytes, tell: Callable[[str], None]) -> None:
        """`tbox` (N-Triples) is the one that the history begins with."""
        self._damaged = damaged
        self._new = new
        self._tbox = tbox
        self._tell = tell
        self._lost = [seq for seq, commit, _ in salvage.commits(damaged) if commit is None]
        self._unfit: list[int] = []
        self._checkpoint = self._sound_checkpoint()
        self._known_again = 0
        """The last damaged commit after which the map is known, from the checkpoint."""
        self._stamp_ns = damaged.beginning.stamp_ns

    def made(self) -> int:
        """Write the journal; the number of its last commit. Raises NotWritten, Refused."""
        seed.remove(self._new)
        journal = Journal.create(self._new, self._tbox)
        try:
            self._begin(journal)
            with journal.together():
                self._take_over(journal, _counting("saved", self._tell))
            self._tell(f"the map is rebuilt from {journal.last:,} commits")
            SemanticMap(journal).checkpoint()
            return journal.last
        finally:
            journal.close()

    def _take_over(self, journal: Journal, progress: Callable[[], None]) -> None:
        """The commits as they are, and what can be had after a damaged one, until the map is known again."""
        uncertain: SemanticMap | None = None
        for seq, commit, tbox in salvage.commits(self._damaged):
            if seq < journal.first:
                continue
            if commit is not None and uncertain is None:
                journal.append(commit, tbox)
            else:
                uncertain = uncertain or SemanticMap(journal)
                if self._mended(uncertain, seq, commit, tbox):
                    uncertain = None
            if commit is not None:
                self._stamp_ns = commit.stamp_ns
            progress()

    def told(self) -> str:
        """What was damaged, and what has become of it."""
        known = [seq for seq in self._lost if seq <= self._known_again]
        gone = [seq for seq in self._lost if seq > self._known_again]
        told = []
        if known and self._checkpoint is not None:
            it = "it" if len(known) == 1 else "they"
            told.append(
                f"{_damaged(known)}; what {it} changed is known from the checkpoint after commit"
                f" {self._checkpoint.seq}"
            )
        if gone:
            told.append(f"{_damaged(gone)} and left out")
        if unfit := [seq for seq in self._unfit if seq > self._known_again]:
            told.append(f"left out, too, because it would not fit without that: {_numbers(unfit)}")
        return "; ".join(told) or "all of them are good"

    def _begin(self, journal: Journal) -> None:
        """Let the history begin as it did; or, if that is damaged, with the checkpoint."""
        beginning = self._damaged.beginning
        if not beginning.seq:
            return
        with suppress(errors.Refused):
            journal.begin_with(beginning, self._damaged.snapshot())
            return
        if self._checkpoint is None:
            raise errors.Refused(
                "the snapshot that the history begins with is damaged, and there is no checkpoint to go on"
                " from; restore a backup (semmap restore), or start a new map with --fresh (this one is kept)"
            )
        row = salvage.row_of(self._damaged, self._checkpoint.seq)
        chain = b"" if row is None else row.digest
        journal.begin_with(
            structs.replace(beginning, seq=self._checkpoint.seq, chain=chain, stamp_ns=self._stamp_ns),
            self._checkpoint,
        )

    def _mended(self, semantic_map: SemanticMap, seq: int, commit: Commit | None, tbox: bytes | None) -> bool:
        """Commit `seq` as far as it can be had; is the map exactly as it was after it?"""
        if commit is None:
            return self._known(semantic_map, seq) or self._passed_over(semantic_map, seq, "is damaged")
        try:
            semantic_map.restate(fitted(semantic_map, commit), tbox)
        except NotWritten:
            raise
        except (DoesNotFit, errors.SemmapError):
            self._unfit.append(seq)
            self._passed_over(semantic_map, seq, f"({commit.reason}) builds on one that is damaged")
        return False

    def _known(self, semantic_map: SemanticMap, seq: int) -> bool:
        """Make a damaged commit anew from the map as it was after it, if a checkpoint tells."""
        checkpoint = self._checkpoint
        if checkpoint is None or seq != max((n for n in self._lost if n <= checkpoint.seq), default=0):
            return False
        abox = salvage.after(self._damaged, seq, checkpoint)
        if abox is None:
            return False
        tbox = self._damaged.tbox(seq)
        is_new = frozenset(rdf.parse(tbox, "the TBox")) != semantic_map.tbox
        now = frozenset(semantic_map.abox())
        commit = structs.replace(
            self._stand_in(
                seq, f"commit {seq} was damaged; the checkpoint after {checkpoint.seq} has its effect"
            ),
            tbox=is_new,
            retracted=tuple(sorted(now - abox)),
            inserted=tuple(sorted(abox - now)),
        )
        semantic_map.restate(commit, tbox if is_new else None)
        self._known_again = seq
        return True

    def _passed_over(self, semantic_map: SemanticMap, seq: int, why: str) -> bool:
        semantic_map.restate(self._stand_in(seq, f"commit {seq} {why}; it is left out"))
        return False

    def _stand_in(self, seq: int, reason: str) -> Commit:
        """A commit that changes nothing, in the place of another one."""
        id_ = f"repair-{seq}-{uuid.uuid4().hex}"
        return Commit(
            seq=seq, stamp_ns=self._stamp_ns, id=id_, source="file", agent="semmap repair", reason=reason
        )

    def _sound_checkpoint(self) -> Checkpoint | None:
        try:
            return self._damaged.sound_checkpoint()
        except errors.Refused:
            return None


def _damaged(seqs: list[int]) -> str:
    return f"{_numbers(seqs)} {'is' if len(seqs) == 1 else 'are'} damaged"


def _numbers(seqs: list[int]) -> str:
    """`commits 3, 5 to 9 and 12`."""
    runs: list[list[int]] = []
    for seq in seqs:
        if runs and seq == runs[-1][-1] + 1:
            runs[-1] = [runs[-1][0], seq]
        else:
            runs.append([seq])
    told = [str(run[0]) if len(run) == 1 else f"{run[0]} to {run[-1]}" for run in runs]
    some = " and ".join(filter(None, (", ".join(told[:-1]), told[-1])))
    return f"commit{'s' if len(seqs) > 1 else ''} {some}"
