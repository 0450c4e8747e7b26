"""Repair of a damaged journal: intact commits are kept, also after a damaged one, and losses are reported.

The effect of a damaged commit is computed from a later checkpoint, if there is one. Otherwise the commit is
left out, with the later commits that depend on it. Numbers stay the same: a commit that is left out is
replaced by an empty one with a note.
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
from semmap.nodes.kb_node.storage import body_shapes, seed
from semmap.nodes.kb_node.storage.journal import FILENAME, Checkpoint, Journal, write_ahead
from semmap.nodes.kb_node.storage.journal.sqlite_file import InUse, NotWritten
from semmap.nodes.kb_node.storage.journal.verification import verify
from semmap.nodes.kb_node.storage.repair import salvage
from semmap.nodes.kb_node.storage.repair.commit_adaptation import DoesNotFit, adapt_commit
from semmap.schemas import errors
from semmap.schemas.commits import Commit

_REPORT_INTERVAL_S = 2.0
_MAGIC = b"SQLite format 3\0"
_HEADER = struct.Struct(">16sH10xI")
"""The header of an SQLite file: magic string, page size [bytes], and number of pages."""


def repair(data: Path, tell: Callable[[str], None] = lambda text: None, *, tbox: Path | None = None) -> str:
    """Repair the journal of folder `data` up to its last intact commit, and return a summary.

    `tell` is called with the progress of long work. The initial TBox is read from the file `tbox` if the
    one in the journal cannot be read. The damaged journal is moved to `data/kept/<time>/`. Raises BadFile
    if there is none, Refused if it is in use or nothing can be recovered.
    """
    path = data / FILENAME
    if not path.exists():
        raise errors.BadFile(f"there is no map in {data}")
    new = path.with_name(f"new-{FILENAME}")
    damaged, recovered = _open(path)
    try:
        if _is_sound(damaged, _count_progress("checked", tell)):
            found = (
                "the write-ahead log with the last commits was damaged and has been recovered"
                if recovered
                else "nothing is damaged"
            )
            return f"{found} in {data}: the map continues from commit {damaged.last}"
        salvage_run = _Salvage(damaged, new, _read_first_tbox(damaged, tbox), tell)
        last = salvage_run.write()
    finally:
        damaged.close()
    kept = seed.install_journal(new, path)
    if kept is not None:
        body_shapes.copy(kept, data)
    return (
        f"the map continues from commit {last} ({salvage_run.describe()}); the damaged file is kept in {kept}"
    )


def _open(path: Path) -> tuple[Journal, bool]:
    """Open the journal, also if its end is missing or its log is damaged.

    Returns whether the log was recovered.
    """
    try:
        return Journal(path, to_salvage=True), False
    except InUse:
        raise
    except errors.Refused as error:
        if write_ahead.has_damaged_copy(path):
            write_ahead.recover(path)
            write_ahead.delete_damaged_copy(path)
            return _open(path)[0], True
        if _pad_truncated_file(path):
            return _open(path)
        raise errors.Refused(
            f"{_get_reason(error)}; start a new map with --fresh (this one is kept)"
        ) from None


def _pad_truncated_file(path: Path) -> bool:
    """Pad a truncated file with zeros, because SQLite cannot read it otherwise. Returns whether it was."""
    with path.open("rb") as file:
        magic, page_size, pages = _HEADER.unpack(file.read(_HEADER.size).ljust(_HEADER.size))
    length = page_size * pages
    if magic != _MAGIC or path.stat().st_size >= length:
        return False
    os.truncate(path, length)
    return True


def _count_progress(done: str, tell: Callable[[str], None]) -> Callable[[], None]:
    """Return a function that counts commits and reports their number from time to time."""
    numbers, due_s = count(1), time.monotonic() + _REPORT_INTERVAL_S

    def progress() -> None:
        nonlocal due_s
        number = next(numbers)
        if time.monotonic() >= due_s:
            due_s = time.monotonic() + _REPORT_INTERVAL_S
            tell(f"{number:,} commits {done}")

    return progress


def _is_sound(journal: Journal, progress: Callable[[], None]) -> bool:
    try:
        journal.require_format()
        verify(journal, progress)
    except errors.Refused:
        return False
    return True


def _read_first_tbox(damaged: Journal, instead: Path | None) -> bytes:
    """Return the initial TBox (N-Triples), or its replacement."""
    try:
        return damaged.tbox(damaged.beginning.seq)
    except errors.Refused as error:
        if instead is None:
            raise errors.Refused(
                f"{_get_reason(error)}: the TBox that the map started with cannot be read; provide it with"
                f" --tbox FILE, or start a new map with --fresh (the damaged file is kept)"
            ) from None
    triples = ontology_files.gather([instead], {}).triples
    tbox_validation.compile_tbox(triples, str(instead))
    return rdf.serialise(triples, "ntriples")


def _get_reason(error: errors.Refused) -> str:
    """Return the problem of an error without the next step."""
    return error.text.partition("; ")[0]


class _Salvage:
    """The new journal with the intact commits of a damaged one."""

    def __init__(self, damaged: Journal, new: Path, tbox: bytes, tell: Callable[[str], None]) -> None:
        """`tbox` (N-Triples) is the one at the start of the history."""
        self._damaged = damaged
        self._new = new
        self._tbox = tbox
        self._tell = tell
        self._lost = [seq for seq, commit, _ in salvage.read_commits(damaged) if commit is None]
        self._unfit: list[int] = []
        self._checkpoint = self._load_checkpoint()
        self._restored_until = 0
        """The last damaged commit whose effect was restored from the checkpoint."""
        self._stamp_ns = damaged.beginning.stamp_ns

    def write(self) -> int:
        """Write the journal and return the number of its last commit. Raises NotWritten, Refused."""
        seed.delete_journal(self._new)
        journal = Journal.create(self._new, self._tbox)
        try:
            self._begin(journal)
            with journal.batch():
                self._copy_commits(journal, _count_progress("saved", self._tell))
            self._tell(f"the map is rebuilt from {journal.last:,} commits")
            SemanticMap(journal).checkpoint()
            return journal.last
        finally:
            journal.close()

    def _copy_commits(self, journal: Journal, progress: Callable[[], None]) -> None:
        """Copy intact commits, and restore those after a damaged one until the map is certain again."""
        uncertain: SemanticMap | None = None
        for seq, commit, tbox in salvage.read_commits(self._damaged):
            if seq < journal.first:
                continue
            if commit is not None and uncertain is None:
                journal.append(commit, tbox)
            else:
                uncertain = uncertain or SemanticMap(journal)
                if self._restore_commit(uncertain, seq, commit, tbox):
                    uncertain = None
            if commit is not None:
                self._stamp_ns = commit.stamp_ns
            progress()

    def describe(self) -> str:
        """Return what was damaged, and what was done about it."""
        known = [seq for seq in self._lost if seq <= self._restored_until]
        gone = [seq for seq in self._lost if seq > self._restored_until]
        parts = []
        if known and self._checkpoint is not None:
            its = "its" if len(known) == 1 else "their"
            parts.append(
                f"{_format_damaged(known)}; {its} changes were restored from the checkpoint after commit"
                f" {self._checkpoint.seq}"
            )
        if gone:
            parts.append(f"{_format_damaged(gone)} and left out")
        if unfit := [seq for seq in self._unfit if seq > self._restored_until]:
            parts.append(f"also left out because of missing changes: {_format_numbers(unfit)}")
        return "; ".join(parts) or "all commits are intact"

    def _begin(self, journal: Journal) -> None:
        """Start the history as before or, if its start is damaged, with the checkpoint."""
        beginning = self._damaged.beginning
        if not beginning.seq:
            return
        with suppress(errors.Refused):
            journal.start_from(beginning, self._damaged.snapshot())
            return
        if self._checkpoint is None:
            raise errors.Refused(
                "the snapshot at the start of the history is damaged, and there is no checkpoint to"
                " continue from; restore a backup (semmap restore), or start a new map with --fresh"
                " (this one is kept)"
            )
        row = salvage.read_row(self._damaged, self._checkpoint.seq)
        chain = b"" if row is None else row.digest
        journal.start_from(
            structs.replace(beginning, seq=self._checkpoint.seq, chain=chain, stamp_ns=self._stamp_ns),
            self._checkpoint,
        )

    def _restore_commit(
        self, semantic_map: SemanticMap, seq: int, commit: Commit | None, tbox: bytes | None
    ) -> bool:
        """Apply commit `seq` as far as possible. Returns whether the map is exactly as it was after it."""
        if commit is None:
            return self._restore_from_checkpoint(semantic_map, seq) or self._leave_out(
                semantic_map, seq, "is damaged"
            )
        try:
            semantic_map.restate(adapt_commit(semantic_map, commit), tbox)
        except NotWritten:
            raise
        except (DoesNotFit, errors.SemmapError):
            self._unfit.append(seq)
            self._leave_out(semantic_map, seq, f"({commit.reason}) builds on one that is damaged")
        return False

    def _restore_from_checkpoint(self, semantic_map: SemanticMap, seq: int) -> bool:
        """Recreate a damaged commit from the map after it, if a checkpoint allows it."""
        checkpoint = self._checkpoint
        if checkpoint is None or seq != max((n for n in self._lost if n <= checkpoint.seq), default=0):
            return False
        abox = salvage.compute_abox_after(self._damaged, seq, checkpoint)
        if abox is None:
            return False
        tbox = self._damaged.tbox(seq)
        is_new = frozenset(rdf.parse(tbox, "the TBox")) != semantic_map.tbox
        now = frozenset(semantic_map.abox())
        commit = structs.replace(
            self._make_placeholder(
                seq, f"commit {seq} was damaged; the checkpoint after {checkpoint.seq} has its effect"
            ),
            tbox=is_new,
            retracted=tuple(sorted(now - abox)),
            inserted=tuple(sorted(abox - now)),
        )
        semantic_map.restate(commit, tbox if is_new else None)
        self._restored_until = seq
        return True

    def _leave_out(self, semantic_map: SemanticMap, seq: int, why: str) -> bool:
        semantic_map.restate(self._make_placeholder(seq, f"commit {seq} {why}; it is left out"))
        return False

    def _make_placeholder(self, seq: int, reason: str) -> Commit:
        """Return a commit without changes that replaces another one."""
        id_ = f"repair-{seq}-{uuid.uuid4().hex}"
        return Commit(
            seq=seq, stamp_ns=self._stamp_ns, id=id_, source="file", agent="semmap repair", reason=reason
        )

    def _load_checkpoint(self) -> Checkpoint | None:
        try:
            return self._damaged.newest_checkpoint()
        except errors.Refused:
            return None


def _format_damaged(seqs: list[int]) -> str:
    return f"{_format_numbers(seqs)} {'is' if len(seqs) == 1 else 'are'} damaged"


def _format_numbers(seqs: list[int]) -> str:
    """Return a text such as `commits 3, 5 to 9 and 12`."""
    runs: list[list[int]] = []
    for seq in seqs:
        if runs and seq == runs[-1][-1] + 1:
            runs[-1] = [runs[-1][0], seq]
        else:
            runs.append([seq])
    ranges = [str(run[0]) if len(run) == 1 else f"{run[0]} to {run[-1]}" for run in runs]
    some = " and ".join(filter(None, (", ".join(ranges[:-1]), ranges[-1])))
    return f"commit{'s' if len(seqs) > 1 else ''} {some}"
